"""The scanner of documents: delimiters of formulas, and parts of the text that are skipped.

A format is a list of tokens. The opening of a token is looked for only outside of formulas and of
skipped parts, and its end is looked for only once if there is none, so that the time is linear in
the length of the text.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TypeAlias

Closing: TypeAlias = str | Callable[[re.Match[str]], str]

#: A line without text ends a paragraph, and with it an inline formula.
BLANK_LINE = r"\n[ \t]*+\n"


@dataclass(frozen=True)
class Delimiter:
    """A delimiter of formulas, or the start of a part that is skipped.

    `closing` is a regular expression: its group ``end`` is the closing delimiter, its group
    ``stop`` shows that the opening is no delimiter, and other alternatives are passed over. A
    token without `closing` is skipped as it stands, one without `delimiter` up to its end. If
    `inner` is given, the formula is its first group.
    """

    opening: str
    closing: Closing = ""
    delimiter: str = ""
    is_inline: bool = False
    is_environment: bool = False
    inner: str = ""
    applies: Callable[[re.Match[str]], bool] = lambda _: True


@dataclass(frozen=True)
class Excerpt:
    """The part of a text between two delimiters; `extent` is the part with both of them."""

    start: int
    end: int
    extent: tuple[int, int]
    delimiter: str
    is_inline: bool = False


@dataclass(frozen=True)
class UnreadDisplay:
    """A display that is not read, and why."""

    start: int
    reason: str


def scanned(
    text: str, tokens: Sequence[Delimiter], start: int = 0, end: int | None = None
) -> Iterator[Excerpt | UnreadDisplay]:
    """Formulas in the order of the text, and displays without an end."""
    openings = _expression("|".join(f"(?P<t{i}>{one.opening})" for i, one in enumerate(tokens)))
    end = len(text) if end is None else end
    without_end: set[str] = set()
    while start < end and (opening := openings.search(text, start, end)):
        start = max(opening.end(), start + 1)
        token = tokens[int(str(opening.lastgroup)[1:])]
        if not token.closing or not token.applies(opening):
            continue
        pattern = token.closing if isinstance(token.closing, str) else token.closing(opening)
        if pattern in without_end:
            continue
        marks = _expression(pattern).finditer(text, opening.end(), end)
        mark = next((one for one in marks if one.lastgroup), None)
        if mark and mark.lastgroup == "end":
            start = max(mark.end(), start)
            if token.delimiter:
                yield _excerpt(text, token, opening, mark)
            continue
        if not mark:
            without_end.add(pattern)
        if token.delimiter and not token.is_inline:
            delimiter = opening.group() if token.is_environment else token.delimiter
            yield UnreadDisplay(opening.start(), f"{delimiter} is not closed")


def _excerpt(
    text: str, token: Delimiter, opening: re.Match[str], mark: re.Match[str]
) -> Excerpt | UnreadDisplay:
    start, end, delimiter = opening.end(), mark.start(), token.delimiter
    if token.is_environment:
        start, end, delimiter = opening.start(), mark.end(), environment(opening)
    if token.inner:
        inner = _expression(token.inner).search(text, start, end)
        if inner is None:
            return UnreadDisplay(opening.start(), f"<{delimiter}> contains no LaTeX")
        start, end = inner.span(1)
    return Excerpt(start, end, (opening.start(), mark.end()), delimiter, token.is_inline)


def environment(opening: re.Match[str]) -> str:
    r"""The name in ``\begin{name}``."""
    return opening.group().partition("{")[2].partition("}")[0]


@cache
def _expression(pattern: str) -> re.Pattern[str]:
    return re.compile(pattern, re.M | re.S)
