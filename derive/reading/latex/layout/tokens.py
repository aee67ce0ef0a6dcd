"""Tokens of LaTeX, each with its place in the text."""

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from derive.reading.latex.layout.latex_symbols import CHARACTERS, COMBINING
from derive.reading.latex.tree import Span


class UnreadError(ValueError):
    """A part of a formula cannot be read, for the stated reason."""


@dataclass(frozen=True, slots=True)
class Token:
    r"""A command, a character or a space.

    kind: ``command`` (its name without the backslash), ``letter``, ``digit``, ``space``, ``row``
    (``\\``), or the character itself: ``{ } ^ _ & ' ( + =`` and so on.
    """

    kind: str
    text: str
    span: Span


PATTERN = re.compile(
    r"""(?P<comment>%[^\n]*(?:\n[ \t]*)?)
    |(?P<row>\\\\(?:\*?\[\s*-?[\d.]+\s*[a-z]{2}\s*\])?|\\(?:newline|cr|tabularnewline)(?![A-Za-z]))
    |(?P<command>\\(?:[A-Za-z]+|.))
    |(?P<space>\s+)
    |(?P<letter>[A-Za-z])
    |(?P<digit>[0-9])
    |(?P<other>.)""",
    re.VERBOSE | re.DOTALL,
)
#: Commands of one character that are that character.
ESCAPED = frozenset("_*'^&#%$")


def tokenize(latex: str) -> list[Token]:
    """The tokens of a text; comments are left out, characters of Unicode become commands."""
    return list(_tokens(latex, None))


def _tokens(latex: str, place: Span | None) -> Iterator[Token]:
    for match in PATTERN.finditer(latex):
        kind, text = str(match.lastgroup), match.group()
        span = place or match.span()
        if kind == "comment":
            continue
        elif kind == "command" and text[1] in "_*":  # as Markdown escapes them
            yield Token(text[1], text[1], span)
        elif kind == "command":
            yield Token(kind, text[1:], span)
        elif kind != "other":
            yield Token(kind, text, span)
        elif text.isascii():
            yield Token(text, text, span)
        else:
            for name in _as_latex(text):
                yield from _tokens(name, span) if name != text else [Token(text, text, span)]


@cache
def _as_latex(character: str) -> tuple[str, ...]:
    """LaTeX for a character of Unicode; the character itself if none is known."""
    if character in CHARACTERS:
        return (CHARACTERS[character],)
    if character in COMBINING or script_of(character):
        return (character,)
    simple = unicodedata.normalize("NFKC", character)
    if unicodedata.decomposition(character).startswith("<fraction>"):
        return (r"\frac{{{}}}{{{}}}".format(*simple.split("⁄")),)
    parts = unicodedata.normalize("NFD", simple)
    if parts == character or len(parts) > 3:
        return (character,)
    return tuple(CHARACTERS.get(part, part) for part in parts)


def script_of(character: str) -> str:
    """The sign of a raised or lowered character, ``^`` or ``_``, or nothing."""
    kind = unicodedata.decomposition(character).partition(">")[0]
    return {"<super": "^", "<sub": "_"}.get(kind, "")


def skip_spaces(tokens: list[Token], at: int) -> int:
    """The first token from a place on that is no space."""
    while at < len(tokens) and tokens[at].kind == "space":
        at += 1
    return at


def argument(tokens: list[Token], at: int) -> tuple[tuple[int, int], int] | None:
    """Tokens of the argument at a place, and the token after it; None if there is none."""
    at = skip_spaces(tokens, at)
    if at >= len(tokens):
        return None
    if tokens[at].kind != "{":
        return (at, at + 1), at + 1
    depth = 0
    for end in range(at, len(tokens)):
        depth += {"{": 1, "}": -1}.get(tokens[end].kind, 0)
        if depth == 0:
            return (at + 1, end), end + 1
    return None


def braced(tokens: list[Token]) -> list[Token]:
    """Tokens in braces."""
    start, end = tokens[0].span[0], tokens[-1].span[1]
    return [Token("{", "{", (start, start)), *tokens, Token("}", "}", (end, end))]
