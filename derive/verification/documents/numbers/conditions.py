"""The constraints of candidates in numbers, as conditions G q̈ = γ on accelerations."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import sympy as sp

from derive.verification.documents.jets import Array, Jet, Value, evaluated
from derive.verification.documents.letters.candidates import SystemCandidate
from derive.verification.documents.letters.document_system import derivation
from derive.verification.documents.letters.stated_constraints import (
    StatedConstraint,
    expression_of,
    rate_of,
    symbol,
)


@dataclass(frozen=True)
class Conditions:
    """Constraints of candidates at states.

    Arrays have the shape (candidates, states, constraints), `gradients` further that of the
    coordinates of the document.
    """

    residuals: Array  # of constraints of coordinates; 0 for those of velocities
    rates: Array
    forcing: Array
    gradients: Array


@dataclass(frozen=True)
class _Row:
    """A constraint as formulas in names: itself, unless it contains velocities; rate, gradient."""

    value: str
    rate: str
    gradient: Mapping[str, str]


def conditions(
    tried: Sequence[SystemCandidate],
    names: Mapping[str, Value],
    letters: Mapping[str, Value],
    shape: tuple[int, int],
) -> Conditions:
    """The constraints by values of the names of the system, and of letters, without accelerations.

    All candidates have the same system and the same constraints of the document.
    """
    first = tried[0]
    own, stated = _of_system(first), [_of_letters(one) for one in first.constraints]
    signs = np.array([one.signs for one in tried], float)
    table = np.array([
        [_numbers(row.gradient[q.name], names, shape) for q in first.system.q] for row in own
    ]).reshape(len(own), len(first.coordinates), *shape)  # fmt: skip
    gradients = [np.einsum("cjbk,bji->bkci", table, signs)]
    for row in stated:
        column = np.zeros((*shape, 1, len(first.coordinates)))
        for q, text in row.gradient.items():
            places = [one.coordinates.index(q) for one in tried]
            column[np.arange(len(tried)), :, 0, places] = _numbers(text, letters, shape)
        gradients.append(column)
    rows = [*((row, names) for row in own), *((row, letters) for row in stated)]
    rates = [evaluated(row.rate, namespace) for row, namespace in rows]
    return Conditions(
        _stacked([evaluated(row.value, namespace).value for row, namespace in rows], shape),
        _stacked([jet.value for jet in rates], shape),
        -_stacked([_rate(jet) for jet in rates], shape),
        np.concatenate(gradients, axis=2),
    )


def _rate(jet: Jet) -> Array:
    return np.asarray(jet.coefficients[1])


def _stacked(arrays: Sequence[Array], shape: tuple[int, int]) -> Array:
    return np.stack([np.broadcast_to(one, shape) for one in arrays], axis=-1)


def _numbers(text: str, names: Mapping[str, Value], shape: tuple[int, int]) -> Array:
    return np.broadcast_to(evaluated(text, names).value, shape)


def _of_system(candidate: SystemCandidate) -> list[_Row]:
    """The constraints of the system in its own names."""
    system, d = candidate.system, derivation(candidate.system)
    if not system.conditions:
        return []
    rows = []
    for k, one in enumerate(system.conditions):
        is_holonomic = not one.formula.free_symbols & {*system.qdot}
        gradient = {q.name: sp.sstr(d.constraint_jacobian[k, i]) for i, q in enumerate(system.q)}
        value = sp.sstr(one.formula) if is_holonomic else "0"
        rows.append(_Row(value, sp.sstr(d.constraint_rates[k]), gradient))
    return rows


@cache
def _of_letters(one: StatedConstraint) -> _Row:
    """A constraint that a document states."""
    expression = expression_of(one)
    assert expression is not None
    rate = rate_of(expression, one.coordinates)
    gradient = {q: sp.sstr(rate.diff(symbol(f"{q}_dot"))) for q in sorted(one.coordinates)}
    value = "0" if rate is expression else sp.sstr(expression)
    return _Row(value, sp.sstr(rate), gradient)
