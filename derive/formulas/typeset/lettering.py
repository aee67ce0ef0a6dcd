"""MathML and LaTeX for names: Greek letters, dots for time derivatives, and indices."""

import re
from dataclasses import dataclass
from html import escape

NAMES = (
    "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi "
    "chi psi omega Gamma Delta Theta Lambda Pi Sigma Phi Psi Omega"
)
GREEK = dict(zip(NAMES.split(), "αβγδεζηθκλμνξπρστφχψωΓΔΘΛΠΣΦΨΩ", strict=True))
DOTS = {"_dot": 1, "_ddot": 2}


@dataclass(frozen=True)
class Lettering:
    """The letter of a name, with its dots, its arrow and its indices: θ, one dot, 1."""

    letter: str
    dots: int = 0
    has_arrow: bool = False
    indices: tuple[str, ...] = ()

    @property
    def is_greek(self) -> bool:
        """Whether the letter is the name of a Greek one."""
        return self.letter in GREEK


def lettering(name: str) -> Lettering:
    """Read a name: theta1_dot is θ with one dot and the index 1, p_theta1 has the index θ1."""
    stem = re.sub("_d?dot$", "", name)
    dots = DOTS.get(name[len(stem) :], 0)
    letter, _, subscript = stem.partition("_")
    if letter.endswith("dot") and letter != "dot":
        letter, dots = letter.removesuffix("dot"), 1
    match = re.fullmatch(r"([A-Za-z]+?)(\d+|[xyz]{2})", letter)
    letter, index = match.groups() if match else (letter, "")
    has_arrow = subscript == "vector"
    indices = tuple(filter(None, (index, "" if has_arrow else subscript)))
    return Lettering(letter, dots, has_arrow, indices)


def name_markup(name: str) -> str:
    """Return the MathML of a name with its index."""
    letter, index = letter_and_index(name)
    return f"<msub>{letter}{index}</msub>" if index else letter


def letter_and_index(name: str) -> tuple[str, str]:
    """Return MathML for the letter and the index of a name: θ with a dot and 1 of theta1_dot."""
    read = lettering(name)
    markup = f"<mi>{GREEK.get(read.letter, escape(read.letter))}</mi>"
    if read.has_arrow:
        markup = f'<mover accent="true">{markup}<mo stretchy="false" mathsize="60%">→</mo></mover>'
    markup = dotted(markup, read.dots, "1.05em" if read.has_arrow else "0.75em")
    indices = "".join(map(_index_markup, read.indices))
    return markup, f"<mrow>{indices}</mrow>" if indices else ""


def dotted(markup: str, dots: int, height: str = "0.75em") -> str:
    """Return the MathML of a letter under dots; the height keeps superscripts where they are."""
    # without accent="true", because many fonts draw accent dots into the letter
    over = f"<mover>{markup}<mo>{'.' * dots}</mo></mover>"
    return f'<mpadded height="{height}">{over}</mpadded>' if dots else markup


def denominator(element: str) -> str:
    """Return the element of a denominator, with room for dots below the line of the fraction."""
    has_dots = "</mover></mpadded>" in element
    return f'<mrow><mspace height="1.1em"/>{element}</mrow>' if has_dots else element


def _index_markup(index: str) -> str:
    if index == "next":
        return "<mi>i</mi><mo>+</mo><mn>1</mn>"
    numbers = index.split("_")
    if all(map(str.isdigit, numbers)):
        return "<mo>,</mo>".join(f"<mn>{number}</mn>" for number in numbers)
    return name_markup(index)


def name_latex(name: str) -> str:
    r"""Return the LaTeX of a name with its index: ``\dot{\theta}_1`` of theta1_dot."""
    letter, index = letter_and_index_latex(name)
    return f"{letter}_{index}" if index else letter


def letter_and_index_latex(name: str) -> tuple[str, str]:
    """Return LaTeX for the letter and the index of a name; the index is in braces if it is long."""
    read = lettering(name)
    letter = rf"\{read.letter}" if read.is_greek else read.letter
    if len(read.letter) > 1 and not read.is_greek:
        letter = rf"\mathrm{{{letter}}}"
    if read.has_arrow:
        letter = rf"\vec{{{letter}}}"
    if read.dots:
        letter = rf"\{'d' * read.dots}ot{{{letter}}}"
    index = "".join(map(_index_latex, read.indices))
    return letter, index if len(index) < 2 else f"{{{index}}}"


def _index_latex(index: str) -> str:
    if index == "next":
        return "i+1"
    numbers = index.split("_")
    return ",".join(numbers) if all(map(str.isdigit, numbers)) else name_latex(index)
