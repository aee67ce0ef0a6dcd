"""Documents that contain the report's displays, judged with the details of its equations."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

from derive.reading.document import Display, Document
from derive.reading.latex.display_reader import macros_of
from derive.reading.latex.tree import Span, Statement, Unreadable
from derive.system.files.system_catalogue import load
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts, FormulaVerdict
from derive.verification.judging.verdict import Verdict, VerdictName
from derive.verification.report.alignment import aligned
from derive.verification.report.differences import first_difference
from derive.verification.report.equation import ReportEquation
from derive.verification.report.report_judgement import EQUATIONS, OrderOf, verdict_on
from derive.verification.report.report_latex import statements, text

NOTE = "recognised by its displays as the report Comparing Method in Double Pendulum"
OTHER = "not one of the report's equations"


@dataclass(frozen=True)
class WrittenStatement:
    """A statement of a document."""

    display: Display
    tree: Statement | Unreadable

    @cached_property
    def latex(self) -> str:
        """Its LaTeX."""
        return self.display.latex[slice(*self.tree.span)].strip()

    @cached_property
    def text(self) -> str:
        """Its formula, or its LaTeX if it is unreadable."""
        return _text(self.latex, self.tree)


@dataclass(frozen=True)
class Stored:
    """A statement of an equation of the report."""

    id: str
    text: str
    latex: str
    correct: Statement | Unreadable


def judge_report(document: Document, order_of: OrderOf) -> DocumentVerdicts | None:
    """Judge a document that has at least half of the report's statements; else return None.

    Parameters
    ----------
    document : Document
        A document of any kind.
    order_of : callable
        As for `derive.verification.report.report_judgement.verdict`.
    """
    if 2 * sum(not one.is_inline for one in document.displays) < len(EQUATIONS):
        return None
    macros = macros_of("\n".join(document.definitions))
    written = [
        WrittenStatement(display, tree)
        for display in document.displays
        if not display.is_inline
        for tree in statements(display.latex, macros)
    ]
    stored = _stored()
    pairs = aligned(*([(one.text, one.latex) for one in side] for side in (written, stored)))
    if 2 * sum(written[w].text == stored[s].text for s, w in pairs.items()) < len(stored):
        return None
    groups: dict[tuple[str, Display], list[tuple[Stored, WrittenStatement]]] = defaultdict(list)
    for place, number in sorted(pairs.items()):
        groups[stored[place].id, written[number].display].append((stored[place], written[number]))
    judged = [_judged(document, EQUATIONS[key], g, order_of) for (key, _), g in groups.items()]
    others = [one for number, one in enumerate(written) if number not in pairs.values()]
    inline = [
        WrittenStatement(display, tree)
        for display in document.displays
        if display.is_inline
        for tree in statements(display.latex, macros)
        if isinstance(tree, Statement) and tree.relations
    ]
    judged += [_other(document, one) for one in (*others, *inline)]
    judged.sort(key=lambda one: one.span)
    title = load("double_pendulum").title
    notes = (NOTE, *document.notes)
    return DocumentVerdicts(document.file, document.kind, title, tuple(judged), notes)


@cache
def _stored() -> tuple[Stored, ...]:
    """The statements of the report, with the correct ones."""
    return tuple(
        Stored(equation.id, _text(latex, printed), latex, correct)
        for equation in EQUATIONS.values()
        for printed, correct in zip(
            statements(equation.latex), statements(equation.corrected_latex), strict=True
        )
        for latex in [equation.latex[slice(*printed.span)]]
    )


def _text(latex: str, tree: Statement | Unreadable) -> str:
    if isinstance(tree, Statement):
        return text(tree)
    return "".join(latex.split())


def _judged(
    document: Document,
    equation: ReportEquation,
    group: Sequence[tuple[Stored, WrittenStatement]],
    order_of: OrderOf,
) -> FormulaVerdict:
    """The verdict on those statements of an equation that stand in one display."""
    display = group[0][1].display
    span = min(w.tree.span[0] for _, w in group), max(w.tree.span[1] for _, w in group)
    unread = [w.tree.reason for _, w in group if isinstance(w.tree, Unreadable)]
    if unread and not equation.exempt:
        return _formula(document, display, span, "unreadable", note=unread[0])
    formula = equation.formula("; ".join(w.text for _, w in group))
    try:
        result = verdict_on(equation, formula, order_of)
    except (ValueError, TypeError, NotImplementedError) as error:
        note = f"it differs from ({equation.number}): {error}"
        result = Verdict(equation.id, "wrong", formula, equation.printed, note=note)
    if result.verdict not in ("misprint", "wrong"):
        return _formula(document, display, span, result.verdict, note=result.note)
    start, end = _wrong_term(group) or (0, 0)
    return _formula(
        document, display, span, result.verdict,
        wrong_term=display.latex[start:end].strip(),
        wrong_spans=((display.start + start, display.start + end),) * (start < end),
        correction=equation.equation.format(equation.corrected_latex),
        witness=" = ".join(filter(None, (result.residual, result.witness))),
        note=result.note,
    )  # fmt: skip


def _wrong_term(group: Sequence[tuple[Stored, WrittenStatement]]) -> Span | None:
    """The first part of a display that differs from the correct equation."""
    for one, written in group:
        match written.tree, one.correct:
            case Statement() as tree, Statement() as correct if text(tree) != text(correct):
                return first_difference(tree, correct)
    return None


def _other(document: Document, written: WrittenStatement) -> FormulaVerdict:
    tree, display = written.tree, written.display
    if isinstance(tree, Unreadable):
        return _formula(document, display, tree.span, "unreadable", note=tree.reason)
    return _formula(document, display, tree.span, "context", note=OTHER)


def _formula(
    document: Document, display: Display, span: Span, verdict: VerdictName, **fields: Any
) -> FormulaVerdict:
    start, end = display.start + span[0], display.start + span[1]
    place = document.place(start)
    latex = display.latex[slice(*span)].strip()
    return FormulaVerdict(
        place.line, place.column, display.number, latex, verdict,
        span=(start, end), cell=place.cell, **fields,
    )  # fmt: skip
