"""Tokens of LaTeX, each with its place in the text."""

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import groupby

from derive.reading.latex.symbols import CHARACTERS, COMBINING
from derive.reading.latex.tree import Span


class Unread(ValueError):  # noqa: N818 - carries the reason of an `Unreadable`
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
    if character in COMBINING or _script_of(character):
        return (character,)
    simple = unicodedata.normalize("NFKC", character)
    if unicodedata.decomposition(character).startswith("<fraction>"):
        return (r"\frac{{{}}}{{{}}}".format(*simple.split("⁄")),)
    parts = unicodedata.normalize("NFD", simple)
    if parts == character or len(parts) > 3:
        return (character,)
    return tuple(CHARACTERS.get(part, part) for part in parts)


def with_unicode_scripts(tokens: list[Token]) -> list[Token]:
    """The tokens with accents before their letters, and raised text as an exponent."""
    result: list[Token] = []
    for kind, group in groupby(tokens, _script):
        marked = list(group)
        if kind == "accent":
            letter = [result.pop()] if result else []
            if not letter or letter[0].kind not in ("letter", "command"):
                raise Unread(f"the accent {marked[0].text!r} has no letter")
            for token in marked:
                start, end = letter[0].span[0], token.span[1]
                accent = Token("command", COMBINING[token.text], (start, end))
                letter = [accent, *_braced(letter)[:-1], Token("}", "}", (end, end))]
            result += letter
        elif kind:
            span = marked[0].span[0], marked[-1].span[1]
            simple = [unicodedata.normalize("NFKC", token.text) for token in marked]
            inner = [t for text in simple for t in _tokens(text, span)]
            result += [Token(kind, kind, span), *_braced(inner)]
        else:
            result += marked
    return result


def _script(token: Token) -> str:
    """Whether a character is an accent, raised or lowered."""
    if token.kind != token.text or token.kind.isascii():
        return ""
    return "accent" if token.text in COMBINING else _script_of(token.text)


def _script_of(character: str) -> str:
    kind = unicodedata.decomposition(character).partition(">")[0]
    return {"<super": "^", "<sub": "_"}.get(kind, "")


def _braced(tokens: list[Token]) -> list[Token]:
    start, end = tokens[0].span[0], tokens[-1].span[1]
    return [Token("{", "{", (start, start)), *tokens, Token("}", "}", (end, end))]
