"""Documents with formulas: displays, inline formulas, their places, and headings above them."""

import re
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from typing import NamedTuple, TypeAlias, TypeVar

#: The kind of a document: that of a format, or ``program``.
Kind: TypeAlias = str


class Place(NamedTuple):
    """Line and column, both counted from 1; in a notebook they refer to a cell."""

    line: int
    column: int
    cell: int = 0


@dataclass(frozen=True)
class Display:
    r"""A formula between delimiters.

    Attributes
    ----------
    number
        Of displays, counted from 1; 0 for an inline formula.
    line, column
        Of the first character of `latex`, counted from 1; in a notebook, within the cell.
    start
        Of `latex` in the text of the document. Spaces replace characters that do not belong to the
        LaTeX, so that position `i` in `latex` is position ``start + i`` in the text.
    latex
        The LaTeX between the delimiters; with the delimiters if they are an environment.
    extent
        Start and end, with both delimiters, in the text of the document.
    delimiter
        The opening delimiter, such as ``$$``, ``\[``, ``align*``, ````` ```math `````.
    cell
        Number of the notebook's cell, counted from 1; 0 in other documents.
    """

    number: int
    line: int
    column: int
    start: int
    latex: str
    extent: tuple[int, int]
    delimiter: str
    is_inline: bool = False
    cell: int = 0


@dataclass(frozen=True)
class CodeCell:
    """A program in a notebook, which starts at `start` in the text of the document."""

    number: int
    start: int
    language: str
    text: str


@dataclass(frozen=True)
class Document:
    r"""The formulas of a file, in order.

    Attributes
    ----------
    file
        Path of the file.
    text
        The text that positions refer to; of a notebook, the sources of its cells, one below the
        other.
    displays
        Displays and inline formulas.
    definitions
        Definitions of macros in LaTeX, such as ``\newcommand{\q}{\theta_1}``.
    notes
        Remarks on parts that are not read.
    cells
        For each cell of a notebook, where it starts in `text`.
    programs
        The code cells of a notebook.
    """

    file: str
    kind: Kind
    text: str
    displays: tuple[Display, ...]
    definitions: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    cells: tuple[int, ...] = ()
    programs: tuple[CodeCell, ...] = ()

    @cached_property
    def _lines(self) -> list[int]:
        """The position at which each line starts."""
        starts = [0]
        while result := self.text.find("\n", starts[-1]) + 1:
            starts.append(result)
        return starts

    def place(self, position: int) -> Place:
        """The place of a position in the text."""
        line = bisect_right(self._lines, position)
        column = position - self._lines[line - 1] + 1
        cell = bisect_right(self.cells, position)
        before = bisect_right(self._lines, self.cells[cell - 1]) - 1 if cell else 0
        return Place(line - before, column, cell)


Item = TypeVar("Item")

#: A heading in Markdown, LaTeX, HTML or reStructuredText, or a line that starts an example.
HEADING = re.compile(
    r"^(?:[ \t]*(?P<marks>#{1,6})[ \t]"
    r"|[ \t]*\\(?P<subs>(?:sub)*)(?P<unit>section|paragraph)\b"
    r"|.*<h(?P<number>[1-6])\b"
    r"|(?P<line>\S.*)\n(?:={3,}|-{3,}|~{3,}|\^{3,})[ \t]*$"
    r"|[ \t]*(?:[*_]{0,2}|<(?:strong|b)>|\\(?:begin\{)?)"
    r"(?P<word>example|problem|exercise|question|case|beispiel|aufgabe|ejemplo|ejercicio"
    r"|exemple|exercice|esempio|esercizio|problema|exemplo)\b"
    r"|[ \t]*(?::{3,}|`{3,})\{(?P<fence>admonition|(?:prf:)?example|exercise|problem|topic)\b"
    r"|(?P<count>\d{1,2}[.)])(?!\S))",
    re.IGNORECASE | re.MULTILINE,
)
#: The levels of a line or a box that starts an example and of a number: below all headings.
EXAMPLE, NUMBERED = 7, 8


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
        return (1 if heading["unit"] == "section" else 4) + heading["subs"].count("sub")
    if heading["number"]:
        return int(heading["number"])
    if heading["line"]:
        return 1
    return NUMBERED if heading["count"] else EXAMPLE
