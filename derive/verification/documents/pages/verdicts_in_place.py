"""Verdicts on the formulas of a document, with the places where they stand."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from derive.reading.document import Display, Kind
from derive.reading.latex.tree import Span
from derive.verification.judging.verdict import VerdictName

#: Characters of the longest formula that is shown whole.
MAX_LATEX = 2000
#: What stands in the place of a formula for a remark on a method of integration.
METHOD = "method of integration"
#: Verdicts on formulas that are judged, and all that are counted.
JUDGED: tuple[VerdictName, ...] = ("verified", "equivalent", "misprint", "wrong")
COUNTED: tuple[VerdictName, ...] = (*JUDGED, "definition")
#: Verdicts on formulas that stand out.
REFUTED: tuple[VerdictName, ...] = ("wrong", "misprint", "unreadable")
#: Most reasons of a summary.
MAX_REASONS = 2
#: What helps if nothing is judged.
HELP = (
    "Formulas are judged by positions of masses, by T and V, L or H, or by equations of motion in "
    "the document; the options --system and --names state the system and the meanings of letters."
)
#: The remark below meanings of letters that are possible as well.
WAY_OUT = "The options --system and --names state the system and the meanings of letters."


@dataclass(frozen=True)
class FormulaVerdict:
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
    state
        The numbers of the letters with which the witness can be computed again.
    basis
        Of a verdict: the document's own positions, energies or equations, or the options; or a
        known system that fits its formulas. Empty if the report was the basis, or nothing.
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
    state: str = ""
    basis: Literal["document", "known system", ""] = ""

    def is_in(self, display: Display) -> bool:
        """Whether the formula stands in a display."""
        start, end = display.extent
        return start <= self.span[0] < end


@dataclass(frozen=True)
class VerdictDifference:
    """A formula with another verdict or another correction if letters have another meaning.

    `instead_of` is its verdict in the document: `context` if the meanings oppose each other.
    """

    line: int
    display: int
    latex: str
    verdict: VerdictName
    instead_of: VerdictName
    correction: str
    cell: int = 0

    @property
    def text(self) -> str:
        """The difference in words."""
        place = f"cell {self.cell}, " * bool(self.cell) + f"line {self.line}"
        place += f" (display {self.display})" * bool(self.display)
        if self.verdict == self.instead_of:
            return f"{place} has another correction"
        return f"{place} is {self.verdict} instead of {self.instead_of}"


@dataclass(frozen=True)
class Alternative:
    """Another meaning of the letters of a document with which as many formulas hold.

    Attributes
    ----------
    system, name
        The title of the system, and its name as the option ``--system`` takes it.
    names
        The letters in the names of the system, as files of the option ``--names`` have them.
    convention
        The meanings that differ from those that are taken, in words; empty for another system.
    differences
        Formulas with another verdict or another correction.
    """

    system: str
    name: str
    names: Mapping[str, str]
    convention: str
    differences: tuple[VerdictDifference, ...]

    @property
    def text(self) -> str:
        """The alternative in words."""
        meaning = self.convention or self.system
        return f"with {meaning}: {'; '.join(one.text for one in self.differences)}"


@dataclass(frozen=True)
class DocumentVerdicts:
    """The verdicts on the formulas of a document, in the order of the document."""

    file: str
    kind: Kind
    system: str  # the system that the formulas describe, "" if none was found
    formulas: tuple[FormulaVerdict, ...]
    notes: tuple[str, ...] = ()
    #: Unusual meanings of letters, in words, and other meanings that are possible.
    convention: str = ""
    alternatives: tuple[Alternative, ...] = ()

    @property
    def is_judged(self) -> bool:
        """Whether a formula holds or is wrong: none is only context, a definition or unreadable."""
        return any(one.verdict in JUDGED for one in self._equations)

    @property
    def summary(self) -> str:
        """How many formulas have each verdict, why others have none, and what would help."""
        counts = Counter(one.verdict for one in self._equations)
        numbers = [f"{counts[name]} {name}" for name in COUNTED if counts[name]]
        left = [one for one in self._equations if one.verdict in ("context", "unreadable")]
        reasons = Counter(one.note or "no statement about the system" for one in left)
        if left:
            words = "; ".join(reason for reason, _ in reasons.most_common(MAX_REASONS))
            numbers.append(f"{len(left)} not judged because: {words}")
        total = f"{len(self._equations)} formula{'s' * (len(self._equations) != 1)}"
        text = ": ".join(filter(None, (total, ", ".join(numbers))))
        return text if self.is_judged else f"Nothing was judged. {text}. {HELP}"

    @property
    def _equations(self) -> list[FormulaVerdict]:
        """The formulas without the remarks on methods of integration."""
        return [one for one in self.formulas if one.latex != METHOD]

    @property
    def remarks(self) -> tuple[str, ...]:
        """The notes, the meanings of letters that are not the usual ones, and alternatives."""
        convention = (f"Letters: {self.convention}",) if self.convention else ()
        others = tuple(f"Ambiguous: {one.text}" for one in self.alternatives)
        return (*self.notes, *convention, *others, *(WAY_OUT,) * bool(self.alternatives))


def one_line(latex: str) -> str:
    """LaTeX in one line; a formula that no reader would read to its end is cut."""
    line = " ".join(latex.split())
    return line if len(line) <= MAX_LATEX else f"{line[:MAX_LATEX]} ..."
