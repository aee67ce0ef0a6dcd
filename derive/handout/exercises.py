"""Exercises: a document without its formulas, or with a mistake in each, and its key."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal, TypeAlias

from derive.handout.document_model import (
    Block,
    Code,
    HandoutDocument,
    HandoutSection,
    NumberedEquation,
    Paragraph,
    in_text,
)
from derive.handout.mistakes import Mistake, planted

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
