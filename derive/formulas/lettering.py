"""MathML for names: Greek letters, dots for time derivatives, and indices."""

import re
from html import escape

NAMES = (
    "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi "
    "chi psi omega Gamma Delta Theta Lambda Pi Sigma Phi Psi Omega"
)
GREEK = dict(zip(NAMES.split(), "αβγδεζηθκλμνξπρστφχψωΓΔΘΛΠΣΦΨΩ", strict=True))
DOTS = {"_dot": ".", "_ddot": ".."}


def name_markup(name: str) -> str:
    """Return the MathML of a name with its index."""
    letter, index = letter_and_index(name)
    return f"<msub>{letter}{index}</msub>" if index else letter


def letter_and_index(name: str) -> tuple[str, str]:
    """Return MathML for the letter and the index of a name: θ with a dot and 1 of theta1_dot."""
    stem = re.sub("_d?dot$", "", name)
    dots = DOTS.get(name[len(stem) :], "")
    letter, _, subscript = stem.partition("_")
    if letter.endswith("dot"):
        letter, dots = letter.removesuffix("dot"), "."
    match = re.fullmatch(r"([A-Za-z]+?)(\d+|[xyz]{2})", letter)
    letter, index = match.groups() if match else (letter, "")
    markup = f"<mi>{GREEK.get(letter, escape(letter))}</mi>"
    if subscript == "vector":
        markup, subscript = f'<mover accent="true">{markup}<mo>→</mo></mover>', ""
    if dots:
        # without accent="true", because many fonts draw accent dots into the letter; the
        # fixed height keeps superscripts at their usual height
        dotted = f"<mover>{markup}<mo>{dots}</mo></mover>"
        markup = f'<mpadded height="0.75em">{dotted}</mpadded>'
    indices = _index_markup(index) + _index_markup(subscript)
    return markup, f"<mrow>{indices}</mrow>" if indices else ""


def _index_markup(index: str) -> str:
    if index == "next":
        return "<mi>i</mi><mo>+</mo><mn>1</mn>"
    if index.isdigit():
        return f"<mn>{index}</mn>"
    return name_markup(index) if index else ""
