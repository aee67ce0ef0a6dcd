"""Names as mathematics writes them: Greek letters, dots for rates, and indices, in MathML."""

from __future__ import annotations

import re
from html import escape

GREEK = {
    **dict(zip(
        "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi "
        "chi psi omega".split(), "αβγδεζηθκλμνξπρστφχψω", strict=True,
    )),
    **dict(zip("Gamma Delta Theta Lambda Pi Sigma Phi Psi Omega".split(), "ΓΔΘΛΠΣΦΨΩ",
               strict=True)),
}  # fmt: skip
DOTS = {"_dot": ".", "_ddot": ".."}


def named(name: str) -> str:
    """A name with its index."""
    markup, index = letters(name)
    return f"<msub>{markup}{index}</msub>" if index else markup


def letters(name: str) -> tuple[str, str]:
    """A name's letter and its index, as mathematics writes them.

    Parameters
    ----------
    name : str
        Such as ``theta1_dot``, ``p_theta1``, ``w_next`` or ``g_vector``.

    Returns
    -------
    letter, index : str
        MathML, for ``theta1_dot`` a θ with a dot, and 1; the index may be empty.
    """
    stem = re.sub("_d?dot$", "", name)
    dots = DOTS.get(name[len(stem) :], "")
    letter, _, below = stem.partition("_")
    if letter.endswith("dot"):
        letter, dots = letter.removesuffix("dot"), "."
    found = re.fullmatch(r"([A-Za-z]+?)(\d+|[xyz]{2})", letter)
    letter, index = found.groups() if found else (letter, "")
    word = GREEK.get(letter, escape(letter))
    markup = f"<mi>{word}</mi>"
    if below == "vector":
        markup, below = f'<mover accent="true">{markup}<mo>→</mo></mover>', ""
    if dots:
        # no accent: many fonts would draw the dots into the letter; and no reason for a
        # superscript to stand higher
        dotted = f"<mover>{markup}<mo>{dots}</mo></mover>"
        markup = f'<mpadded height="0.75em">{dotted}</mpadded>'
    indices = _index(index) + _index(below)
    return markup, f"<mrow>{indices}</mrow>" if indices else ""


def _index(below: str) -> str:
    if below == "next":
        return "<mi>i</mi><mo>+</mo><mn>1</mn>"
    if below.isdigit():
        return f"<mn>{below}</mn>"
    return named(below) if below else ""
