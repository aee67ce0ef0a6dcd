"""The verdict on one equation, and tables of verdicts as plain text."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from shutil import get_terminal_size
from textwrap import TextWrapper, shorten
from typing import Literal, Self, TypeAlias

#: Columns of the verdict, and of the widest table.
VERDICT_WIDTH, MAX_WIDTH = 13, 120

VerdictName: TypeAlias = Literal[
    "verified",  # it holds
    "equivalent",  # it differs from the derived formula, but gives the same equations of motion
    "misprint",  # it does not hold, but its correction is proved
    "wrong",  # it does not hold
    "definition",  # it defines a quantity
    "context",  # it concerns another subject
    "unreadable",  # it cannot be parsed
]


@dataclass(frozen=True)
class Correction:
    """A wrong term as written, and the correct one.

    The wrong one is empty if a term is missing, the correct one if it is not known.
    """

    wrong: str
    correct: str
    span: tuple[int, int] = (0, 0)  # of the wrong term with its sign, in the judged formula

    def applied(self, text: str) -> str:
        """The judged formula with the correct term."""
        start, end = self.span
        return text[:start] + self.correct + text[end:]

    def widened(self, text: str, span: tuple[int, int]) -> Self:
        """The same correction of a longer part of the judged formula."""
        start, end = span
        inner = replace(self, span=(self.span[0] - start, self.span[1] - start))
        return replace(
            self, wrong=text[start:end], correct=inner.applied(text[start:end]), span=span
        )


@dataclass(frozen=True)
class Verdict:
    """The verdict on one equation, as ``holonomic verify --json`` prints it."""

    id: str  # such as eq33 or accelerations.theta1
    verdict: VerdictName
    printed: str
    correction: str = ""
    residual: str = ""  # printed minus corrected form, where they first differ
    corrections: tuple[Correction, ...] = ()  # of terms; all together give a correct equation
    difference: str = ""  # printed minus correct form, where no corrections of terms are known
    witness: str = ""  # numbers at a generic state that show the error
    state: str = ""  # that state
    note: str = ""


def table_width() -> int:
    """Return the width of the terminal, limited to `MAX_WIDTH`."""
    return min(get_terminal_size((100, 24)).columns, MAX_WIDTH)


def verdict_rows(verdicts: Sequence[Verdict], width: int) -> Iterator[str]:
    """Yield the lines of a table of verdicts; only correct equations are abbreviated."""
    id_width = max((len(one.id) for one in verdicts), default=0) + 2
    for one in verdicts:
        details = [*_corrections(one)]
        details += [
            ("correct form", one.correction),
            ("residual", one.residual and f"{one.residual} = {one.witness}"),
            ("difference", one.difference),
            ("value", "" if one.residual else one.witness),
            ("state", one.state),
            ("note", one.note),
        ]
        lines = [f"{title}: {text}" for title, text in details if text]
        whole = one.verdict in ("misprint", "wrong", "unreadable")
        yield from table_row((one.id, one.verdict, one.printed, *lines), width, id_width, whole)


def _corrections(verdict: Verdict) -> Iterator[tuple[str, str]]:
    for one in verdict.corrections:
        yield "wrong term", one.wrong
        yield "correct term" if one.wrong else "missing term", one.correct


def table_row(
    cells: Sequence[str], width: int, id_width: int = 7, whole: bool = False
) -> Iterator[str]:
    """Yield the lines of one row: id, verdict and text, with wrapped details below the text."""
    label, verdict, text, *details = cells
    margin = id_width + VERDICT_WIDTH
    head = f"{label:<{id_width}}{verdict:<{VERDICT_WIDTH}}"
    if whole:
        yield head + wrapped(text, width, margin).lstrip()
    else:
        yield head + shorten(text, width - margin, placeholder=" ...")
    yield from (wrapped(detail, width, margin) for detail in details)


def wrapped(text: str, width: int, margin: int) -> str:
    """Wrap `text` with a left margin, and indent all lines but the first."""
    wrapper = TextWrapper(width, break_long_words=False, break_on_hyphens=False)
    wrapper.initial_indent, wrapper.subsequent_indent = " " * margin, " " * (margin + 2)
    return wrapper.fill(text)
