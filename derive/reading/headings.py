"""Headings of a text, which separate the subjects of a document."""

import re
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator
from itertools import groupby
from typing import TypeVar

Item = TypeVar("Item")

#: A heading in Markdown, LaTeX, HTML or reStructuredText, or a line that starts an example.
HEADING = re.compile(
    r"^(?:[ \t]*(?P<marks>#{1,6})[ \t]"
    r"|[ \t]*\\(?P<subs>(?:sub)*)section\b"
    r"|.*<h(?P<number>[1-6])\b"
    r"|(?P<line>\S.*)\n(?:={3,}|-{3,}|~{3,}|\^{3,})[ \t]*$"
    r"|[ \t]*[*_]{0,2}(?P<word>example|problem|exercise|case|beispiel|aufgabe|ejemplo|ejercicio"
    r"|exemple|exercice|esempio|esercizio|problema|exemplo)\b)",
    re.IGNORECASE | re.MULTILINE,
)
#: The level of a line that starts an example: below all headings.
DEEPEST = 7


def divided(
    text: str, items: Iterable[Item], place: Callable[[Item], int]
) -> list[tuple[Item, ...]]:
    """Items below the headings of the highest level that divides them, in order.

    There is one group if none does.
    """
    items = tuple(items)
    found = [(_level(one), one.start()) for one in HEADING.finditer(text)]
    for level in sorted({one for one, _ in found}):
        starts = [start for one, start in found if one <= level]
        sections = [bisect_right(starts, place(one)) for one in items]
        groups = groupby(zip(sections, items, strict=True), lambda pair: pair[0])
        result = [tuple(one for _, one in group) for _, group in groups]
        if len(result) > 1:
            return result
    return [items]


def below_each(
    text: str, items: Iterable[Item], place: Callable[[Item], int]
) -> Iterator[tuple[Item, ...]]:
    """Yield the items below each heading that has any, of all levels, in order."""
    starts = [one.start() for one in HEADING.finditer(text)]
    for _, group in groupby(items, lambda one: bisect_right(starts, place(one))):
        yield tuple(group)


def _level(heading: re.Match[str]) -> int:
    if heading["marks"]:
        return len(heading["marks"])
    if heading["subs"] is not None:
        return 1 + heading["subs"].count("sub")
    if heading["number"]:
        return int(heading["number"])
    return 1 if heading["line"] else DEEPEST
