"""Reactions, such as tensions, that Newton's laws of a document contain beside a known system.

The equations of bodies are linear in the letters of reactions: A λ = r along any motion of the
system. Some of them determine λ, with which all others must agree.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from derive.formulas.expression import parse
from derive.formulas.numeric import Evaluator
from derive.verification.documents.letters.stated_equations import is_reaction
from derive.verification.documents.rules.consequences import WithVerdict
from derive.verification.documents.rules.evidence.slips import is_change
from derive.verification.documents.rules.evidence.stated_loads import CLOSE, FAILURES
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.roles import Roles
from derive.verification.documents.rules.side_comparison import SideComparison
from derive.verification.documents.rules.side_verdict import SideVerdict, plain
from derive.verification.documents.rules.small_motions import SmallMotions
from derive.verification.documents.statements import WORD, DocumentFormula
from derive.verification.judging.reference_system import time_derivative

#: The most states at which equations are compared.
STATES = 5

Array = NDArray[np.float64]


@dataclass(frozen=True)
class _BodyEquation:
    """An equation a·λ + b·q̈ + c = 0 by its number among the formulas, with values at each state."""

    number: int
    letters: frozenset[str]
    difference: sp.Expr
    reactions: Array  # a
    whole: Array  # a, b and c
    values: Array  # -(b·q̈ + c) along motions


def with_reactions(
    namespace: DocumentNamespace, linear: SmallMotions, verdicts: Sequence[WithVerdict]
) -> list[WithVerdict]:
    """The verdicts, with those on equations with letters of reactions that others determine.

    Equations that hold together for the motions of the system are verified, if they determine more
    than their reactions. If all but one hold together, and a slip in a term explains this one, it
    is wrong, unless slips explain several such equations.
    """
    result = [*verdicts]
    letters = _letters(namespace, verdicts)
    if not letters:
        return result
    equations, constraints = _equations(namespace, letters, verdicts)
    for group in _groups(equations):
        held = group if _agree(group) else []
        if not held:
            contrary = []
            for wrong in group:
                rest = [one for one in group if one is not wrong]
                if _agree(rest) and _checked(rest, constraints):
                    formula, _ = verdicts[wrong.number]
                    own = _verdict(namespace, linear, formula, letters, rest)
                    if own is not None:
                        contrary.append((wrong.number, own, rest))
            if len(contrary) != 1:
                continue
            ((number, own, held),) = contrary
            result[number] = verdicts[number][0], own
        for one in _checked(held, constraints) if held else ():
            formula = verdicts[one.number][0]
            kind = "reactions" if len(one.letters) > 1 else "a reaction"
            note = f"with {', '.join(sorted(one.letters))} as {kind}"
            result[one.number] = formula, plain("verified", formula, note)
    return result


def _letters(namespace: DocumentNamespace, verdicts: Sequence[WithVerdict]) -> dict[str, sp.Symbol]:
    """Letters of reactions without a meaning, in equations that have no others without one."""
    result: dict[str, sp.Symbol] = {}
    for formula, one in verdicts:
        unknown = {
            word
            for side in formula.sides
            for word in WORD.findall(side.text)
            if word not in namespace.all_names
        }
        if not one.is_understood and unknown and all(map(is_reaction, unknown)):
            result |= {name: sp.Symbol(name, real=True) for name in sorted(unknown)}
    return result


def _equations(
    namespace: DocumentNamespace, letters: dict[str, sp.Symbol], verdicts: Sequence[WithVerdict]
) -> tuple[list[_BodyEquation], Array]:
    """The equations with reactions, and those that constraints are for accelerations."""
    system, model = namespace.derivation.system, namespace.model
    names, symbols = {**namespace.all_names, **letters}, [*letters.values()]
    unknown = [*symbols, *system.qddot]
    absent = dict.fromkeys(unknown, sp.S.Zero)
    conditions = [time_derivative(system, one.formula) for one in system.conditions]
    conditions = [
        one if one.has(*system.qddot) else time_derivative(system, one) for one in conditions
    ]
    result, rows = list[_BodyEquation](), np.zeros((STATES, 0, len(unknown) + 1))
    with suppress(*FAILURES):
        states = [*model.motions.evaluators[:STATES]]
        rows = np.array([[_row(at, one, unknown, absent) for one in conditions] for at in states])
        rows = rows.reshape(len(states), len(conditions), len(unknown) + 1)
        for number, (formula, one) in enumerate(verdicts):
            if one.is_understood or len(formula.sides) != 2 or formula.relations != ("=",):
                continue
            with suppress(*FAILURES):
                left, right = (parse(side.text, names) for side in formula.sides)
                difference = sp.sympify(left - right).xreplace(dict(model.momenta))
                own = difference.free_symbols & {*symbols}
                slopes = sp.Tuple(*(difference.diff(one) for one in unknown))
                if not own or slopes.free_symbols & {*unknown}:
                    continue
                whole = np.array([_row(at, difference, unknown, absent) for at in states])
                moving = difference.xreplace(dict.fromkeys(symbols, sp.S.Zero))
                values = np.array([-_number(at, moving) for at in states])
                found = frozenset(symbol.name for symbol in own)
                reactions = whole[:, : len(symbols)]
                result.append(_BodyEquation(number, found, difference, reactions, whole, values))
    return result, rows


def _row(
    at: Evaluator,
    difference: sp.Expr,
    unknown: Sequence[sp.Symbol],
    absent: dict[sp.Symbol, sp.Expr],
) -> list[float]:
    """The factors of reactions and accelerations at a state, and the rest."""
    terms = [difference.diff(one) for one in unknown] + [difference.xreplace(absent)]
    return [_number(at, one) for one in terms]


def _number(evaluator: Evaluator, expression: sp.Expr) -> float:
    return float(evaluator(sp.sympify(expression)).number.real)


def _groups(equations: Sequence[_BodyEquation]) -> Iterator[list[_BodyEquation]]:
    """Equations that have letters of reactions in common."""
    groups = defaultdict[frozenset[str], list[_BodyEquation]](list)
    for one in equations:
        own = [letters for letters in groups if letters & one.letters]
        joined = [equation for letters in own for equation in groups.pop(letters)]
        groups[one.letters.union(*own)] = [*joined, one]
    for group in groups.values():
        yield sorted(group, key=lambda one: one.number)


def _agree(equations: Sequence[_BodyEquation]) -> bool:
    """Whether there are reactions with which all equations hold along motions."""
    reactions = np.array([one.reactions for one in equations])
    values = np.array([one.values for one in equations])
    return all(_is_combination(values[:, k], reactions[:, k].T) for k in range(values.shape[1]))


def _checked(equations: Sequence[_BodyEquation], constraints: Array) -> list[_BodyEquation]:
    """The equations that combinations without reactions contain which restrict accelerations.

    Other combinations vanish for any accelerations: an equation is a consequence of others there.
    """
    reactions = np.array([one.reactions for one in equations])
    whole = np.array([one.whole for one in equations])
    result = np.ones(len(equations), dtype=bool)
    for k in range(reactions.shape[1]):
        sizes = np.abs(whole[:, k]).max(axis=1, keepdims=True)
        free = _null_space((reactions[:, k] / sizes).T)
        own = free.T @ (whole[:, k] / sizes)
        own = own @ _null_space(constraints[k])  # but for what constraints imply
        directions, values, _ = np.linalg.svd(own, full_matrices=False)
        restricting = free @ directions[:, values > CLOSE]
        result &= np.abs(restricting).max(axis=1, initial=0) > CLOSE
    return [one for one, is_checked in zip(equations, result, strict=True) if is_checked]


def _null_space(rows: Array) -> Array:
    """Orthonormal columns x with rows·x = 0."""
    _, values, directions = np.linalg.svd(rows)
    return directions[np.count_nonzero(values > CLOSE) :].T


def _is_combination(row: Array, rows: Array) -> bool:
    """Whether a row is a sum of others with any factors."""
    size, sizes = np.abs(row).max(), np.abs(rows).max(axis=1, keepdims=True)
    rows = rows / np.where(sizes == 0, 1, sizes)
    factors = np.linalg.lstsq(rows.T, row, rcond=None)[0]
    return bool(np.abs(factors @ rows - row).max() <= CLOSE * size)


def _verdict(
    namespace: DocumentNamespace,
    linear: SmallMotions,
    formula: DocumentFormula,
    letters: dict[str, sp.Symbol],
    equations: Sequence[_BodyEquation],
) -> SideVerdict | None:
    """The verdict by the reactions of other equations, if one term of an equation is wrong."""
    own = [symbol for name, symbol in letters.items() if any(name in e.letters for e in equations)]
    with suppress(*FAILURES):
        (reactions,) = sp.solve(_independent(equations), own, dict=True)
        named = copy(namespace)
        named.correct({symbol.name: value for symbol, value in reactions.items()})
        comparison = SideComparison(named, linear, Roles(named, linear))
        first, last = formula.sides
        values = named.value(first.text), named.value(last.text)
        result = comparison.compared(formula, first, last, *values)
        is_wrong = result.verdict.verdict == "wrong" and is_change(result.verdict.corrections)
        if is_wrong and not _holds_at_a_place(named, formula, values[0] - values[1]):
            return result
    return None


def _holds_at_a_place(
    namespace: DocumentNamespace, formula: DocumentFormula, difference: sp.Expr
) -> bool:
    """Whether an equation without coordinates or rates holds at a right angle, or at rest."""
    model, system = namespace.model, namespace.derivation.system
    if not model.has_inverse:
        return False
    moving = dict(zip(system.qddot, namespace.derivation.accelerations, strict=True))
    value = difference.xreplace(moving)
    used = {namespace.names.get(word) for word in formula.words}
    angles = () if used & {*system.q} else (0, sp.pi / 2, sp.pi, 3 * sp.pi / 2)
    at_rest = {} if used & {*system.qdot} else dict.fromkeys(system.qdot, sp.S.Zero)
    for place in ({}, *(dict.fromkeys(system.q, one) for one in angles)):
        for rest in ({}, at_rest):
            with suppress(*FAILURES):
                if (place or rest) and model.context.is_small(value.subs({**place, **rest})):
                    return True
    return False


def _independent(equations: Sequence[_BodyEquation]) -> list[sp.Expr]:
    """The differences of equations that determine their reactions."""
    chosen: list[_BodyEquation] = []
    for one in equations:
        rows = np.array([other.reactions[0] for other in chosen])
        if not chosen or not _is_combination(one.reactions[0], rows):
            chosen.append(one)
    return [one.difference for one in chosen]
