"""Corrections in the text of a formula: the terms to name, and the formula with other terms."""

import ast
import re

from derive.formulas.syntax import is_sum, syntax_tree
from derive.verification.corrections.mistake_search import Change
from derive.verification.corrections.pieces import FormulaPart
from derive.verification.judging.verdict import Correction


def applied(text: str, change: Change) -> tuple[tuple[Correction, ...], str]:
    """The corrections that a change amounts to, and the changed formula."""
    piece, new = change.piece, change.replacement
    if change.is_added and piece.parent is None:
        return (Correction("", new),), extended(text, new)
    if change.is_added:
        new = f"{piece.source} - {new[1:]}" if new.startswith("-") else f"{piece.source} + {new}"
    # a term that occurs twice, or that no reader sees as one, is named by a larger one
    while piece.parent and not (piece.is_term and is_unique(text, piece)):
        start, end = piece.parent.span
        new = _inserted(text[start : piece.span[0]], new, text[piece.span[1] : end], piece)
        piece = piece.parent
    if piece.sign < 0:
        new = _negative(new)
    return (correction(text, piece, new),), replaced(text, piece, new)


def replaced(text: str, piece: FormulaPart, new: str) -> str:
    """The formula with `new` in place of a piece and of the sign before it."""
    before = text[: piece.start]
    is_first = before.rstrip()[-1:] in ("", "=", "(", ",")
    return f"{before}{'+' * (piece.sign < 0 and not is_first)}({new}){text[piece.end :]}"


def correction(text: str, piece: FormulaPart, new: str) -> Correction:
    """The correction of a piece, which is shown without space after its sign."""
    span = piece.start, piece.end
    return Correction(re.sub(r"^-\s+", "-", text[slice(*span)]), new, span)


def extended(text: str, missing: str) -> str:
    """The formula with a missing term, of an equation on the left."""
    left, equals, right = text.partition("=")
    return f"{left} + ({missing}) {equals}{right}"


def _inserted(before: str, new: str, after: str, piece: FormulaPart) -> str:
    """Put `new` in place of a piece, in brackets where they are necessary."""
    in_brackets = before[-1:] == "(" and after[:1] == ")"
    sign = before.rstrip()[-1:]
    if piece.is_summand and new[0] == "-" and not _is_sum(new) and sign in ("+", "-"):
        return f"{before.rstrip()[:-1]}{'-' if sign == '+' else '+'} {new[1:]}{after}"
    node = syntax_tree(new)
    bare = piece.is_summand and not is_sum(node) and new[0] != "-"
    if bare or in_brackets or isinstance(node, ast.Name | ast.Constant | ast.Call):
        return before + new + after
    return f"{before}({new}){after}"


def _is_sum(text: str) -> bool:
    return is_sum(syntax_tree(text))


def _negative(text: str) -> str:
    if text == "0":
        return text
    if _is_sum(text):
        return f"-({text})"
    return text[1:] if text[0] == "-" else f"-{text}"


def is_unique(text: str, piece: FormulaPart) -> bool:
    """Whether a reader finds one term that is written like the piece."""
    tokens = re.findall(r"\w+|\*\*|\S", text[piece.start : piece.end])
    pattern = re.compile(r"(?<![\w.])" + r"\s*".join(map(re.escape, tokens)) + r"(?![\w.(])")
    places = [match.span() for match in pattern.finditer(text)]
    if tokens[0] == "-":
        pattern = re.compile(r"\s*".join(map(re.escape, tokens)) + r"(?![\w.(])")
        places = [match.span() for match in pattern.finditer(text)]
    terms = [place for place in places if _is_delimited(text, *place)]
    return (terms or places) == [(piece.start, piece.end)]


def _is_delimited(text: str, start: int, end: int) -> bool:
    """Whether a term begins and ends here."""
    before, after = text[:start].rstrip()[-1:], text[end:].lstrip()[:1]
    return (before in "(+-=," or text[start] == "-") and after in ")+-=,"
