r"""Upright text in formulas, such as ``\text{kin}`` and ``\text{and hence}``."""

import re

from derive.reading.latex.symbols import CONNECTIVES
from derive.reading.latex.tokens import Token
from derive.reading.latex.tree import Span


def words_of(text: str, span: Span, is_upright: bool, is_operand: bool) -> list[Token] | None:
    r"""The tokens of upright text: a word is a letter, several words are prose.

    Several words where an expression must come are a letter, too.

    Parameters
    ----------
    text
        The argument of the command.
    span
        The place of the command with its argument.
    is_upright
        Whether the command is one of formulas, such as ``\mathrm``.
    is_operand
        Whether an expression must come here, such as behind +.

    Returns
    -------
    list or None
        None for a formula in upright letters, such as ``\mathrm{x + 1}``.
    """
    words = re.sub(r"[~\s]+|\\[ ,;:]|\\q?quad", " ", text).strip(" ,.;:")
    is_differential = is_upright and re.fullmatch(r"d[a-z]", words)  # \mathrm{dt}
    is_word = re.fullmatch(r"[A-Za-z][A-Za-z0-9_'-]*", words)
    if not words:
        sign = text.strip()
        is_wide = bool(text.strip(" ")) and not is_upright
        kind = sign if sign in tuple(",.;:") else "gap" if is_wide else "space"
        return [Token(kind, kind, span)]
    if re.fullmatch(r"[A-Za-z]", words) or is_differential:
        return [Token("letter", letter, span) for letter in words]
    if (is_word and words.lower() not in CONNECTIVES) or (is_operand and not is_upright):
        return [Token("word", re.sub(r"\W+", "_", words), span)]
    return None if is_upright else [Token("prose", words, span)]
