"""Formulas in our syntax that remember which LaTeX each of their parts comes from."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from derive.reading.latex.tree import Span

#: Binding strengths: a part that binds less than its place requires is put into brackets.
SUM, PRODUCT, POWER, ATOM = range(4)


@dataclass(frozen=True)
class FormulaText:
    """A formula in our syntax, and the spans of its parts: start and end here, and in LaTeX."""

    text: str
    binding: int = ATOM
    parts: tuple[tuple[int, int, Span], ...] = ()
    entries: tuple["FormulaText", ...] = ()  # of a column or matrix that is written out, row by row

    def shifted(self, offset: int) -> Iterator[tuple[int, int, Span]]:
        """The parts, `offset` characters later."""
        return ((start + offset, end + offset, span) for start, end, span in self.parts)

    def part(self, start: int, end: int) -> "FormulaText":
        """The characters from `start` to `end`."""
        inner = tuple(
            (a - start, b - start, span) for a, b, span in self.parts if start <= a and b <= end
        )
        return FormulaText(self.text[start:end], SUM, inner)

    def source(self, start: int, end: int) -> Span | None:
        """The LaTeX of the characters from `start` to `end`: of all parts within them."""
        spans = [span for a, b, span in self.parts if start <= a and b <= end]
        return (min(s for s, _ in spans), max(e for _, e in spans)) if spans else None


def joined_text(binding: int, *pieces: FormulaText | str) -> FormulaText:
    """A formula from pieces, with the places of their parts."""
    text, parts = "", list[tuple[int, int, Span]]()
    for piece in pieces:
        if isinstance(piece, FormulaText):
            parts += piece.shifted(len(text))
            text += piece.text
        else:
            text += piece
    return FormulaText(text, binding, tuple(parts))


#: Endings of the names of a quantity and of its rates.
RATES = ("", "_dot", "_ddot", "_dddot")


def stem(name: str) -> str:
    """The name of a quantity without the ending of its rate."""
    return re.sub(r"_d{1,3}ot\Z", "", name)


def order(name: str) -> int:
    """The order of a rate: 0 for a quantity, 1 for its rate."""
    return RATES.index(name.removeprefix(stem(name)))
