"""MathML for letters of documents, with their index, dots and primes."""

from html import escape

from derive.formulas.typeset.lettering import GREEK, dotted
from derive.reading.latex.tree import Letter

SYMBOLS = GREEK | {
    "phi": "ϕ",
    "epsilon": "ϵ",
    "varphi": "φ",
    "varepsilon": "ε",
    "vartheta": "ϑ",
    "varrho": "ϱ",
    "iota": "ι",
    "upsilon": "υ",
    "Xi": "Ξ",
    "Upsilon": "Υ",
    "ell": "ℓ",
    "hbar": "ℏ",
    "nabla": "∇",
    "partial": "∂",
    "infty": "∞",
    "dots": "…",
}

#: Endings of names, for marks over a letter.
MARKS = {"bar": "¯", "hat": "^", "tilde": "~", "check": "ˇ", "breve": "˘", "ring": "˚"}


def symbol(letter: Letter) -> str:
    """The markup of a letter as it is written."""
    markup, index = letter_and_index(letter)
    primes = f"<mo>{'′' * letter.primes}</mo>" if letter.primes else ""
    if index and primes:
        return f"<msubsup>{markup}{index}{primes}</msubsup>"
    return f"<msub>{markup}{index}</msub>" if index else raised(markup, primes)


def letter_and_index(letter: Letter) -> tuple[str, str]:
    """The markup of a letter with its dots, and of its index."""
    mark = next((m for m in MARKS if letter.name.endswith(m) and letter.name != m), "")
    name = letter.name.removesuffix(mark)
    style = ' class="bold"' if letter.is_bold else ""
    markup = f"<mi{style}>{escape(SYMBOLS.get(name, name))}</mi>"
    if mark:
        markup = f'<mover accent="true">{markup}<mo>{MARKS[mark]}</mo></mover>'
    return dotted(markup, letter.dots), _index(letter.index)


def _index(index: str) -> str:
    """The markup of an index, which may have an index itself."""
    first, _, rest = index.partition("_")
    if not first:
        return ""
    name = SYMBOLS.get(first, first)
    markup = f"<mn>{name}</mn>" if name.isdecimal() else f"<mi>{escape(name)}</mi>"
    return f"<msub>{markup}{_index(rest)}</msub>" if rest else markup


def raised(markup: str, exponent: str) -> str:
    """The markup with an exponent, if there is one."""
    return f"<msup>{markup}{exponent}</msup>" if exponent else markup
