"""Verdicts on the formulas of a document, with the places where they stand."""

from dataclasses import dataclass

from derive.reading.document import Kind
from derive.reading.latex.tree import Span
from derive.verification.verdict import VerdictName

#: Characters of the longest formula that is shown whole.
MAX_LATEX = 2000


@dataclass(frozen=True)
class JudgedFormula:
    """The verdict on one formula.

    Attributes
    ----------
    line, column
        Of the first character, counted from 1; in a notebook, within the cell.
    display
        Number of the display, counted from 1; 0 for an inline formula.
    latex
        The formula as written.
    wrong_term
        LaTeX of the first wrong term; empty if there is none, or if a term is missing.
    correction
        LaTeX of the correct formula.
    witness
        Numbers at a generic state that show the error.
    note
        Further information, such as the reason of `unreadable`.
    span
        Of the formula in the text of the document.
    wrong_spans
        Of the wrong terms in the text of the document; empty for programs.
    cell
        Number of a notebook's cell, counted from 1; 0 in other documents.
    """

    line: int
    column: int
    display: int
    latex: str
    verdict: VerdictName
    wrong_term: str = ""
    correction: str = ""
    witness: str = ""
    note: str = ""
    span: Span = (0, 0)
    cell: int = 0
    wrong_spans: tuple[Span, ...] = ()


@dataclass(frozen=True)
class JudgedDocument:
    """The verdicts on the formulas of a document, in the order of the document."""

    file: str
    kind: Kind
    system: str  # the system that the formulas describe, "" if none was found
    formulas: tuple[JudgedFormula, ...]
    notes: tuple[str, ...] = ()


def one_line(latex: str) -> str:
    """LaTeX in one line; a formula that no reader would read to its end is cut."""
    line = " ".join(latex.split())
    return line if len(line) <= MAX_LATEX else f"{line[:MAX_LATEX]} ..."
