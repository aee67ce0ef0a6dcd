"""Advice on wrong formulas: terms to replace, the right formula, and a numeric witness.

Corrections are checked before they are given: in place of the terms that they name, they make
the formula correct. Where none do, the advice is the difference from the right formula.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import islice

import sympy as sp

from derive.formulas.budget import is_expandable
from derive.formulas.expression import parse
from derive.mechanics.energies.reduction import reduced
from derive.verification.corrections.goals import Goal, goals
from derive.verification.corrections.mistake_search import Search
from derive.verification.corrections.replacement import (
    applied,
    correction,
    extended,
    is_unique,
    replaced,
)
from derive.verification.corrections.source_names import SourceNames
from derive.verification.judging.derived import printed_formula
from derive.verification.judging.motion_verdicts import fits
from derive.verification.judging.reference_system import ReferenceSystem, variables
from derive.verification.judging.terms import (
    Term,
    closest_factor,
    coefficients,
    corrected_terms,
    difference,
)
from derive.verification.judging.verdict import Correction, Verdict

#: The number of changes of a formula that are fitted into a set of equations of motion, those
#: that are compared in numbers, and those that are checked.
MAX_FITTED, MAX_CHANGES, MAX_CHECKED = 40, 10, 3
#: The number of characters of a formula that is searched, which takes seconds.
MAX_LENGTH = 5000
#: The number of operations in a formula whose terms are compared, or that is simplified.
MAX_OPERATIONS = 500
#: The same for formulas with fractions by sums, which take much longer to cancel.
MAX_OF_FRACTIONS = 100


def advised(
    verdict: Verdict,
    model: ReferenceSystem,
    kind: str,
    name: str,
    holds: Callable[[str], bool],
    others: Sequence[str] = (),
) -> Verdict:
    """Add corrections to the verdict on a wrong formula, or the difference from the correct form.

    Parameters
    ----------
    verdict : Verdict
        Without a note if the correct form can be derived.
    model : Model
        The derivation, and the names of the formula.
    kind, name : str
        The quantity, or ``euler_lagrange``, and its coordinate.
    holds : callable
        ``holds(text)``, whether a formula in place of the printed one is correct.
    others : sequence of str
        The other equations of motion of the source.
    """
    text, names = verdict.printed, SourceNames(verdict.printed, model.context.namespace)
    value = difference(text, model.context.namespace)
    aims = [*goals(model, kind, name, value)]
    correct = None if verdict.note else _correct_form(model, kind, name, value)
    corrections: tuple[Correction, ...] = ()
    with suppress(NotImplementedError):
        searchable = aims if len(text) <= MAX_LENGTH else []
        searches = [Search(text, names, model, goal, correct) for goal in searchable]
        proposals = _mending(text, names, model, searches, value, correct, others)
        corrections = next((one for one, mended in proposals if holds(mended)), ())
    state = _state(model, names, value, aims[0], correct) if verdict.witness else ""
    result = replace(verdict, corrections=corrections, state=state)
    if correct is None and not verdict.note:
        size = f"{len(model.derivation.system.q)} × {len(model.derivation.system.q)}"
        note = f"the correct formula is not derived: it requires the inverse of M, {size}"
        return replace(result, note=note)
    if correct is None:
        return result
    equation = " = 0" if aims[0].is_equation else ""
    result = replace(result, correction=sp.sstr(names.write(shortest(correct))) + equation)
    if corrections:
        return result
    return replace(result, difference=sp.sstr(names.write(shortest(value - correct))))


def shortest(expression: sp.Expr) -> sp.Expr:
    """The shortest of several equal forms; long expressions stay as they are."""
    if expression.count_ops() > MAX_OPERATIONS or not is_expandable(expression):
        return expression
    roots = [p for p in expression.atoms(sp.Pow) if not p.exp.is_Integer]
    shorter = expression.xreplace({p: reduced(p.base) ** p.exp for p in roots})
    forms = [expression, shorter, reduced(shorter), sp.factor_terms(shorter)]
    forms.append(sp.factor_terms(forms[2]))
    return min(forms, key=lambda form: int(form.count_ops()))


def _mending(
    text: str,
    names: SourceNames,
    model: ReferenceSystem,
    searches: Sequence[Search],
    value: sp.Expr,
    correct: sp.Expr | None,
    others: Sequence[str],
) -> Iterator[tuple[tuple[Correction, ...], str]]:
    """Yield corrections of one term, and those of all terms, each with the changed formula.

    Those that lead to the correct form of an equation of motion come first.
    """
    changes = [(one, search) for search in searches for one in search.changes()]
    changes.sort(key=lambda pair: pair[0].cost + (pair[1] is not searches[0]))
    candidates = ((*applied(text, change), search) for change, search in changes[:MAX_FITTED])
    if any(search.is_equation for search in searches):
        candidates = (one for one in candidates if fits(model, text, one[1], correct, others))
    proposals = [*islice(candidates, MAX_CHANGES)]
    if any(search.is_equation for search in searches):
        proposals.sort(key=lambda one: not _is_multiple(model, one[1], correct))
    checked = 0
    for corrections, mended, search in proposals:
        if search.is_right(mended):
            yield corrections, mended
            checked += 1
        if checked == MAX_CHECKED:
            break
    if (
        searches
        and correct is not None
        and all(is_expandable(one, waves=2) for one in (value, correct))
    ):
        yield from _all_terms(searches[0], text, names, model, correct)


def _is_multiple(model: ReferenceSystem, text: str, correct: sp.Expr | None) -> bool:
    """Whether an equation is the correct one times a factor."""
    value = difference(text, model.context.namespace)
    accelerations = model.derivation.system.qddot
    return correct is not None and model.context.are_multiples(value, correct, accelerations)


def _all_terms(
    search: Search, text: str, names: SourceNames, model: ReferenceSystem, correct: sp.Expr
) -> Iterator[tuple[tuple[Correction, ...], str]]:
    """Yield corrections of all wrong terms of a sum."""
    pieces, namespace = search.terms, model.context.namespace
    terms = [Term(p.sign * side * parse(p.source, namespace), side) for p, side in pieces]
    if correct.count_ops() > _most_operations(correct):
        return
    corrected, missing = corrected_terms(terms, correct, variables(model.derivation.system))
    wrong = [(pieces[index][0], value) for index, value in corrected.items()]
    if not all(piece.parent and is_unique(text, piece) for piece, _ in wrong):
        return
    corrections: list[Correction] = []
    mended = text
    for piece, value in reversed(wrong):
        corrections.insert(0, correction(text, piece, sp.sstr(names.write(value))))
        mended = replaced(mended, piece, corrections[0].correct)
    if missing:
        corrections.append(Correction("", sp.sstr(names.write(missing))))
        mended = extended(mended, corrections[-1].correct)
    if search.is_right(mended):
        yield tuple(corrections), mended


def _correct_form(model: ReferenceSystem, kind: str, name: str, value: sp.Expr) -> sp.Expr | None:
    """The correct form of a formula; None if it requires a large inverse, or is too long."""
    if kind == "euler_lagrange":
        return _closest_equation(value, model)
    return printed_formula(model, kind, name)


def _state(
    model: ReferenceSystem, names: SourceNames, value: sp.Expr, goal: Goal, correct: sp.Expr | None
) -> str:
    """The state of the witness: all numbers with which both values can be computed again."""
    context = model.motions if goal.along_motions else model.context
    derived = goal.value if correct is None or goal.is_equation else correct
    used = derived.free_symbols | (value.free_symbols if names.has_operators else set())
    numbers = context.state(value, goal.value, names.quantities(used))
    return ", ".join(f"{name} = {number}" for name, number in numbers.items())


def _most_operations(expression: sp.Expr) -> int:
    """The number of operations up to which the terms of an expression are compared."""
    powers = expression.atoms(sp.Pow)
    by_sums = any(one.base.is_Add and one.exp.could_extract_minus_sign() for one in powers)
    return MAX_OF_FRACTIONS if by_sums else MAX_OPERATIONS


def _closest_equation(value: sp.Expr, model: ReferenceSystem) -> sp.Expr | None:
    """The derived equation of motion, times a factor, from which a wrong one differs least.

    Long equations, of which fractions take minutes to cancel, are left out.
    """
    system, every = model.derivation.system, model.derivation.euler_lagrange
    equations = [one for one in every if one.count_ops() <= _most_operations(one)]
    if not equations:
        return None
    state = variables(system)
    printed = coefficients(value, state)
    factors = [closest_factor(printed, coefficients(e, state), system.qddot) for e in equations]
    index = min(range(len(factors)), key=lambda k: factors[k][0])
    return equations[index] * factors[index][1]
