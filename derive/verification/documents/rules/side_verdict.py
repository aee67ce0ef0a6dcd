"""The verdict on a formula of a document, with the places of its sides."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from derive.verification.documents.formula_translation import FormulaText
from derive.verification.documents.statements import DocumentFormula
from derive.verification.judging.verdict import Verdict

#: Verdicts on formulas that are correct.
CORRECT = ("verified", "equivalent", "definition")
#: Verdicts on formulas that hold.
HOLDING = ("verified", "equivalent")


@dataclass(frozen=True)
class SideVerdict:
    """The verdict on a side of a formula, with the place of each of its characters."""

    verdict: Verdict
    parts: tuple[
        tuple[int, FormulaText], ...
    ]  # the sides within the judged text, and where they start
    kind: str
    is_understood: bool = True  # all its letters have a meaning
    source: int = 0  # the line of a wrong formula from which it follows; 0 without one


def plain(
    verdict: str, formula: DocumentFormula, note: str, witness: str = "", state: str = ""
) -> SideVerdict:
    """A verdict without corrections."""
    one = Verdict("", verdict, formula.text, note=note, witness=witness, state=state)  # type: ignore[arg-type]
    return SideVerdict(one, (), "")


def not_understood(formula: DocumentFormula, unknown: Sequence[str]) -> SideVerdict:
    """The verdict on a formula with letters that have no meaning."""
    note = f"no meaning was found for {', '.join(unknown)}"
    return replace(plain("context", formula, note), is_understood=False)
