"""Exercises: a document without its formulas, or with a mistake in each, and its key.

A mistake is one changed sign, index, power, function or factor, so that it looks like a slip of the
pen. Numbers at generic states prove that the changed formula differs from the right one.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from random import Random
from typing import Literal, TypeAlias

import sympy as sp

from derive.formulas.generic_values import STATES, sample
from derive.formulas.numeric import Evaluator, NoValueError
from derive.formulas.typeset.lettering import lettering
from derive.handout.document_model import (
    Block,
    Code,
    HandoutDocument,
    HandoutSection,
    NumberedEquation,
    Paragraph,
    in_text,
)

Kind: TypeAlias = Literal["sign", "index", "power", "function", "factor"]

#: Operations by which a formula may become longer or shorter: a larger change is conspicuous.
OPERATIONS = 2


@dataclass(frozen=True)
class Mistake:
    """A part of a formula, its replacement, and the formula with the replacement."""

    kind: Kind
    right: sp.Expr
    wrong: sp.Expr
    equation: NumberedEquation


@dataclass(frozen=True)
class _Change:
    kind: Kind
    right: sp.Expr
    wrong: sp.Expr
    whole: Callable[[sp.Expr], sp.Expr]  # puts a part into the whole expression
    entry: int  # of a matrix


def planted(equation: NumberedEquation, seed: str) -> Mistake | None:
    """One mistake in the derived side of a formula; None where there is none, as in 0.

    Parameters
    ----------
    equation : Equation
        A formula with a derived side. If it states that this side is zero, a multiple of the side
        is no mistake. Where it depends on the state of the system, so does its change: another
        zero of the potential energy is no mistake.
    seed : str
        Equal seeds give equal mistakes.
    """
    value, random = equation.value, Random(seed)
    entries = list(value) if isinstance(value, sp.MatrixBase) else [value]
    changes = sorted(
        (change for k, entry in enumerate(entries) for change in _changes(entry, k, equation)),
        key=lambda change: change.kind,
    )
    kinds = [list(group) for _, group in groupby(changes, key=lambda change: change.kind)]
    random.shuffle(kinds)
    for group in kinds:
        random.shuffle(group)
        for change in group:
            right = entries[change.entry]
            wrong = change.whole(change.wrong)
            if _is_similar(right, wrong) and _is_wrong(right, wrong, equation):
                entries[change.entry] = wrong
                whole = wrong
                if isinstance(value, sp.MatrixBase):
                    whole = sp.ImmutableDenseMatrix(*value.shape, entries)
                changed = replace(equation, value=whole)
                return Mistake(change.kind, change.right, change.wrong, changed)
    return None


def _changes(entry: sp.Expr, k: int, equation: NumberedEquation) -> Iterator[_Change]:
    """All replacements of one part of an expression."""
    symbols = [*equation.order.kinds]

    def parts(
        part: sp.Expr, parent: sp.Expr | None, whole: Callable[[sp.Expr], sp.Expr]
    ) -> Iterator[_Change]:
        for kind, wrong in _replacements(part, parent, symbols):
            yield _Change(kind, part, wrong, whole, k)
        for i, arg in enumerate(part.args):
            if part.is_Pow and i == 1:
                continue

            def around(changed: sp.Expr, i: int = i) -> sp.Expr:
                return whole(part.func(*part.args[:i], changed, *part.args[i + 1 :]))

            yield from parts(arg, part, around)

    return parts(entry, None, lambda changed: changed)


def _replacements(
    part: sp.Expr, parent: sp.Expr | None, symbols: list[sp.Symbol]
) -> Iterator[tuple[Kind, sp.Expr]]:
    """The replacements of a part as a whole."""
    is_term, is_factor = parent is None or parent.is_Add, parent is None or parent.is_Mul
    if is_term and not part.is_Add and not part.is_zero:
        yield "sign", -part
    if part.is_Mul and is_term:
        coefficient, rest = part.as_coeff_Mul()
        yield "factor", 2 * part if abs(coefficient) == 1 else rest * sp.sign(coefficient)
    elif part.is_Pow and part.exp.is_Integer and part.exp > 1:
        yield "power", part.base ** (part.exp + 1)
        yield "power", part.base ** (part.exp - 1)
    elif isinstance(part, sp.sin | sp.cos):
        yield "function", (sp.cos if isinstance(part, sp.sin) else sp.sin)(part.args[0])
    elif part.is_Symbol:
        yield from (("index", other) for other in symbols if _differ_in_index(part, other))
        if is_factor:
            yield "power", part**2


def _differ_in_index(a: sp.Symbol, b: sp.Symbol) -> bool:
    first, second = lettering(a.name), lettering(b.name)
    return first != second and replace(first, indices=()) == replace(second, indices=())


def _is_similar(right: sp.Expr, wrong: sp.Expr) -> bool:
    """Whether the change is inconspicuous: nothing cancels."""
    return abs(wrong.count_ops() - right.count_ops()) <= OPERATIONS


def _is_wrong(right: sp.Expr, wrong: sp.Expr, equation: NumberedEquation) -> bool:
    """Whether the values differ at a generic state, and not by a factor or constant that may be."""
    kinds, difference = equation.order.kinds, wrong - right
    variables = {s for s, kind in kinds.items() if kind in ("coordinate", "rate", "acceleration")}
    if right.free_symbols & variables and not difference.free_symbols & variables:
        return False
    states = [Evaluator(sample([*kinds], index)) for index in range(STATES)]
    if "0" not in equation.after:
        return any(not _is_zero(difference, state) for state in states)
    ratio = wrong / right
    first = next((state(ratio).rounded() for state in states if not _is_zero(right, state)), None)
    return first is not None and any(not _is_zero(ratio - first, state) for state in states)


def _is_zero(expression: sp.Expr, state: Evaluator) -> bool:
    """Whether a value is zero; also if there is none, which proves nothing."""
    try:
        return state(expression).is_zero
    except (NoValueError, NotImplementedError):
        return True


Exercise: TypeAlias = Literal["blank", "mistakes"]


def with_exercises(
    document: HandoutDocument, kind: Exercise, seed: int
) -> tuple[HandoutDocument, HandoutDocument]:
    """A document with exercises and its key, both without generated code, which has the solution.

    Parameters
    ----------
    document : Document
        The document of a derivation.
    kind : {"blank", "mistakes"}
        Leave derived formulas blank, or plant one mistake in each.
    seed : int
        The mistakes follow from it.

    Returns
    -------
    exercises, key : Document
        Formulas have the same numbers in both.
    """
    if kind == "blank":
        blanks = {e.number: replace(e, is_blank=True) for e in document.equations if _is_derived(e)}
        task = "Complete the formulas that are left blank."
        solutions = [e for e in document.equations if e.number in blanks]
        return _replaced(document, blanks, task), _key(document, solutions)
    mistakes = {
        equation.number: mistake
        for equation in document.equations
        if _is_derived(equation) and (mistake := planted(equation, f"{seed} {equation.number}"))
    }
    right = [f"({e.number})" for e in document.equations if e.number not in mistakes]
    task = "Each formula has one mistake: a sign, an index, a power, a function or a factor."
    if right:
        task = f"{task} Only these are right: {', '.join(right)}."
    changed = {number: mistake.equation for number, mistake in mistakes.items()}
    answers = [
        block
        for equation in document.equations
        if equation.number in mistakes
        for block in _answer(equation, mistakes[equation.number])
    ]
    return _replaced(document, changed, task), _key(document, answers)


def _is_derived(equation: NumberedEquation) -> bool:
    return equation.value is not None and not equation.is_given


def _answer(equation: NumberedEquation, mistake: Mistake) -> Iterator[Block]:
    wrong, right = (in_text(equation.order.tree(e)) for e in (mistake.wrong, mistake.right))
    yield Paragraph(f"({equation.number}) A wrong {mistake.kind}: {wrong} instead of {right}.")
    yield equation


def _replaced(
    document: HandoutDocument, changed: dict[int, NumberedEquation], task: str
) -> HandoutDocument:
    """The document with other formulas, and the task before its first section."""

    def block(one: Block) -> Block:
        return changed.get(one.number, one) if isinstance(one, NumberedEquation) else one

    sections = [
        replace(section, blocks=tuple(map(block, section.blocks)))
        for section in document.sections
        if not any(isinstance(one, Code) for one in section.blocks)
    ]
    return HandoutDocument(
        document.title, (HandoutSection("Exercise", (Paragraph(task),)), *sections)
    )


def _key(document: HandoutDocument, answers: Sequence[Block]) -> HandoutDocument:
    return HandoutDocument(f"Key: {document.title}", (HandoutSection("Solutions", tuple(answers)),))
