"""Verdicts on equations of motion, one by one and as a set."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

import sympy as sp

from derive.formulas.budget import is_expandable
from derive.formulas.numeric import independent, solved
from derive.formulas.syntax import ExpressionError
from derive.verification.judging.constrained_motions import equations
from derive.verification.judging.engine import joined
from derive.verification.judging.other_solutions import has_other_solutions, without_outer_function
from derive.verification.judging.reference_system import ReferenceSystem, depends_on
from derive.verification.judging.terms import difference
from derive.verification.judging.verdict import Verdict

#: Largest ratio of factors that counts as zero.
TINY = sp.Float("1e-30")

NOT_LINEAR = "is not linear in the accelerations"


def judge_equation(model: ReferenceSystem, label: str, text: str) -> Verdict:
    """Judge an equation that must hold along every motion, and determine accelerations."""
    if text.count("=") > 1:
        raise ExpressionError(f"an equation has one equals sign, not {text.count('=')}")
    value = difference(text, model.context.namespace)
    inner = without_outer_function(model, value)
    if inner is not None:
        result = _judged(model, label, text, inner)
        if result.verdict in ("verified", "equivalent"):
            reason = "it is a function of an equation of motion, and vanishes with it alone"
            return replace(result, verdict="equivalent", note=joined(reason, result.note))
    return _judged(model, label, text, value)


def _judged(model: ReferenceSystem, label: str, text: str, value: sp.Expr) -> Verdict:
    """The verdict on an equation by its left side minus its right side."""
    system, verdict = model.derivation.system, partial(Verdict, label, printed=text)
    unknown = (*system.qddot, *system.multipliers)
    if not depends_on(value.xreplace(model.momenta), unknown):
        if system.conditions and (note := model.agreement(value)) is not None:
            return verdict(verdict="verified", note=joined("it follows from the constraints", note))
        if depends_on(value, system.p) and (note := model.context.agreement(value)) is not None:
            return verdict(verdict="definition", note=joined("it defines a momentum", note))
        if system.conditions:
            witness = model.motions.witness(value, sp.S.Zero)
            note = "it does not follow from the constraints"
            return verdict(verdict="wrong", witness=witness, note=note)
        return verdict(verdict="wrong", note="it contains no acceleration")
    coefficients = [value.diff(a) for a in unknown]
    is_linear = all(model.context.is_zero(c.diff(a)) for c in coefficients for a in unknown)
    if not model.motions.is_small(value):
        witness = model.motions.witness(value, sp.S.Zero)
        if is_linear and is_expandable(value, waves=2):
            return verdict(verdict="wrong", witness=witness)
        reason = "has too many terms to compare them" if is_linear else NOT_LINEAR
        return verdict(verdict="wrong", witness=witness, note=f"it {reason}")
    if model.motions.is_small_somewhere(*coefficients):
        if is_linear:
            note = "it holds along every motion, but determines no acceleration"
            return verdict(verdict="wrong", note=note)
        if _is_product(model, value):
            note = "it is a product of equations of motion, and holds where one of them does"
            return verdict(verdict="wrong", note=note)
        note = f"it holds along every motion, but {NOT_LINEAR}, and may not determine them"
        return verdict(verdict="context", note=note)
    others = False if is_linear else has_other_solutions(model, value)
    if others:
        return verdict(verdict="wrong", note=f"it {NOT_LINEAR}, and has other solutions")
    if others is None:
        note = f"it holds along every motion, but {NOT_LINEAR}, and may have other solutions"
        return verdict(verdict="context", note=note)
    note = _agreement(model, value, coefficients)
    if note is None:
        return verdict(verdict="wrong", note="it holds at single states only")
    if not is_linear:
        reason = "it is an equation of motion times a factor that contains accelerations"
        return verdict(verdict="equivalent", note=joined(reason, note))
    if momenta := sorted(symbol.name for symbol in value.free_symbols & {*system.p}):
        reason = f"it holds for the momenta of the motion: {', '.join(momenta)}"
        return verdict(verdict="equivalent", note=joined(reason, note))
    return verdict(verdict="verified", note=note)


def _is_product(model: ReferenceSystem, value: sp.Expr) -> bool:
    """Whether several factors of an equation are equations of motion."""
    factors = (one for one in value.args if depends_on(one, model.derivation.system.qddot))
    return value.is_Mul and sum(model.motions.is_small(one) for one in factors) > 1


def fits(
    model: ReferenceSystem,
    printed: str,
    changed: str,
    closest: sp.Expr | None,
    others: Sequence[str],
) -> bool:
    """Whether an equation in place of a wrong one is linear in accelerations, and fits its set.

    It must be the equation of the same coordinate, independent of the correct ones among `others`,
    and contain no momentum, multiplier or acceleration that the source does not contain, but for
    the accelerations in the derived equation that is closest to the wrong one.
    """
    values = [*_values(model, [printed, changed])]
    if len(values) < 2:
        return False
    old, new = values
    try:
        return _fits(model, old, new, closest, others)
    except ExpressionError:  # the change divides by what is zero at a state
        return False


def _fits(
    model: ReferenceSystem,
    old: sp.Expr,
    new: sp.Expr,
    closest: sp.Expr | None,
    others: Sequence[str],
) -> bool:
    """Whether `new` fits in place of `old`, as in `fits`."""
    system, motions, context = model.derivation.system, model.motions, model.context
    unknown = (*system.qddot, *system.multipliers)
    if not any(depends_on(value.xreplace(model.momenta), unknown) for value in (old, new)):
        return True  # it states a constraint or a momentum
    own = [new.diff(a) for a in unknown]
    if not context.is_small(*(c.diff(a) for c in own for a in unknown)):
        return False
    beside = [*_values(model, others)]
    known = set().union(old.free_symbols, *(value.free_symbols for value in beside))
    if closest is not None:
        known |= closest.free_symbols & {*system.qddot}
    elif not depends_on(old, unknown):  # the mistake is that its accelerations are missing
        known |= {*system.qddot}
    if new.free_symbols & {*unknown, *system.p} - known or motions.is_small(*own):
        return False
    row = _factors(model, own)
    if closest is not None and not context.are_multiples(new, closest, system.qddot):
        before = [old.diff(a) for a in unknown]
        is_unknown = motions.is_small(*before)
        if is_unknown or _combined(row) != _combined(_factors(model, before)):
            return False
    rows = [
        _factors(model, [value.diff(a) for a in unknown])
        for value in beside
        if depends_on(value.xreplace(model.momenta), unknown) and motions.is_small(value)
    ]
    n, size = len(system.q), len(unknown)
    has_multipliers = any(depends_on(value, system.multipliers) for value in (new, *beside))
    rows = [*sp.eye(size).tolist()[n:], *rows]  # constraints, differentiated, first
    before_it = len(independent(rows)) if rows else 0
    is_complete = before_it >= (size if has_multipliers else n)
    return is_complete or len(independent([*rows, row])) > before_it


def _values(model: ReferenceSystem, texts: Sequence[str]) -> Iterator[sp.Expr]:
    for text in texts:
        with suppress(ExpressionError):
            yield difference(text, model.context.namespace)


def judge_set(model: ReferenceSystem, judged: Sequence[Verdict]) -> list[Verdict]:
    """Add to correct equations a verdict on all of them if they depend on each other.

    If they are independent but fewer than the coordinates, a note on the last one states so.
    """
    if any(one.verdict in ("wrong", "unreadable") for one in judged):
        return [*judged]
    system, numbered = model.derivation.system, enumerate(judged, 1)
    rows = {number: row for number, one in numbered if (row := _row(model, one.printed))}
    n, size = len(system.q), len(system.q) + len(system.conditions)
    units = sp.eye(size).tolist()
    # the constraints hold, whether or not the source states them again
    kept = [k - (size - n) for k in independent([*units[n:], *rows.values(), *units[:n]])]
    missing = [k - len(rows) for k in kept if k >= len(rows)]
    if not any(
        depends_on(difference(one.printed, model.context.namespace), system.multipliers)
        for one in judged
    ):
        missing = missing[size - n :]  # equations without multipliers do not determine these
    if not missing:
        return [*judged]
    names = ", ".join(system.q[k].name for k in missing)
    lacking = f"the set is incomplete: independent equations are missing, such as for {names}"
    if dependent := [number for k, number in enumerate(rows) if k not in kept]:
        follows = f"equation {dependent[0]} follows from the equations before it"
        correction = "; ".join(f"{model.derivation.euler_lagrange[k]} = 0" for k in missing)
        printed, note = f"{len(judged)} equations", joined(follows, lacking)
        return [*judged, Verdict("euler_lagrange", "wrong", printed, correction, note=note)]
    if all(_is_conserved(model, k, judged) for k in missing):
        return [*judged]
    return [*judged[:-1], replace(judged[-1], note=joined(judged[-1].note, lacking))]


def _is_conserved(model: ReferenceSystem, k: int, judged: Sequence[Verdict]) -> bool:
    """Whether equations contain the constant momentum of a cyclic coordinate, as Routh's do."""
    system = model.derivation.system
    if system.q[k] not in model.derivation.cyclic_coordinates:
        return False
    values = (difference(one.printed, model.context.namespace) for one in judged)
    return any(depends_on(value, (system.p[k],)) for value in values)


def _row(model: ReferenceSystem, text: str) -> tuple[sp.Expr, ...]:
    """The factors of the derived equations in a correct one; none in other definitions.

    The definition of a conserved momentum implies that its rate is zero.
    """
    system, L = model.derivation.system, model.lagrangian
    value = difference(text, model.context.namespace)
    unknown = (*system.qddot, *system.multipliers)
    if depends_on(value.xreplace(model.momenta), unknown):
        return _factors(model, [value.diff(a) for a in unknown])
    if system.conditions:
        return ()
    rates = [L.diff(q) + f for q, f in zip(system.q, system.applied, strict=True)]
    momenta = zip(system.p, rates, strict=True)
    if all(model.context.is_zero(rate) for p, rate in momenta if p in value.free_symbols):
        return _factors(model, [value.diff(qdot) for qdot in system.qdot])
    return ()


def _factors(model: ReferenceSystem, coefficients: Sequence[sp.Expr]) -> tuple[sp.Expr, ...]:
    """Solve Mᵀ x = c: an equation with coefficients c is Σ x_i times the derived equation i.

    Those of constraints, differentiated, are the last.
    """
    derivation, column = model.derivation, sp.Matrix(coefficients)
    constrained = bool(derivation.system.conditions)
    matrix = equations(derivation).T if constrained else derivation.mass_matrix
    return solved(matrix, column, model.motions.evaluators[0])


def _combined(factors: Sequence[sp.Expr]) -> list[int]:
    """The indices of the derived equations that are combined with these factors."""
    smallest = TINY * max(map(abs, factors))
    return [i for i, factor in enumerate(factors) if abs(factor) > smallest]


def _agreement(
    model: ReferenceSystem, value: sp.Expr, coefficients: Sequence[sp.Expr]
) -> str | None:
    """How an equation that holds at states is known to hold along all motions."""
    combined = _combined(_factors(model, coefficients))
    if len(combined) > 1:
        reason = "it is a combination of the equations of motion"
        note = model.motions.agreement(value)
        return note if note is None else joined(reason, note)
    # a multiple of one equation of motion: no accelerations need to be solved for
    i, M = combined[0], model.derivation.mass_matrix
    if i >= M.rows or not M[i, i]:
        return model.motions.agreement(value)
    equation = model.derivation.euler_lagrange[i]
    note = model.context.agreement(value * M[i, i] - coefficients[i] * equation)
    return model.motions.agreement(value) if note is None else note
