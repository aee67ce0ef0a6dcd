"""Text in LaTeX: special characters, and characters beyond those that LaTeX knows."""

import unicodedata
from collections.abc import Iterable

from derive.formulas.typeset.lettering import GREEK

SPECIAL = {
    **{character: rf"\{character}" for character in "#$%&_{}"},
    "\\": r"\textbackslash{}",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    **{character: f"${character}$" for character in "<>|"},
}
#: Characters that LaTeX sets itself.
KNOWN = set("–—‘’“”…")
#: Accents after the letter in decomposed characters, and their commands.
ACCENTS = dict(zip("\u0300\u0301\u0302\u0303\u0308\u030a\u030c\u0327", "`'^~\"rvc", strict=True))
#: Letters with a command of their own.
LETTERS = dict(zip("ßæÆœŒøØłŁ", "ss ae AE oe OE o O l L".split(), strict=True))
MATHEMATICS = {
    **{letter: rf"\{name}" for name, letter in GREEK.items()},
    **{
        character: f"^{{{digit}}}"
        for character, digit in zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-", strict=True)
    },
    **{character: f"_{digit}" for digit, character in enumerate("₀₁₂₃₄₅₆₇₈₉")},
    **dict(zip("·×−°±≤≥", r"\cdot \times - ^\circ \pm \le \ge".split(), strict=True)),
    **dict(zip("≠≈→∞∂′", r"\ne \approx \to \infty \partial '".split(), strict=True)),
    **dict(zip("½Σµᵀ", r"\frac12 \Sigma \mu ^T".split(), strict=True)),
}


def escaped(text: str) -> str:
    """`text` with the characters that have a meaning in LaTeX as commands."""
    return "".join(SPECIAL.get(character, character) for character in text)


def declarations(texts: Iterable[str]) -> list[str]:
    """LaTeX that declares the other characters of texts, in the order of their numbers.

    A character without a command is shown by its number.
    """
    characters = {c for text in texts for c in text if not c.isascii()} - KNOWN
    return [
        rf"\DeclareUnicodeCharacter{{{ord(character):04X}}}{{{_command(character)}}}"
        for character in sorted(characters)
    ]


def _command(character: str) -> str:
    if character in MATHEMATICS:
        return rf"\ensuremath{{{MATHEMATICS[character]}}}"
    if character in LETTERS:
        return rf"\{LETTERS[character]}{{}}"
    decomposed = unicodedata.normalize("NFD", character)
    base, mark = decomposed[0], decomposed[1:]
    if base.isascii() and base.isalpha() and mark in ACCENTS:
        return rf"\{ACCENTS[mark]}{{{base}}}"
    return f"[U+{ord(character):04X}]"
