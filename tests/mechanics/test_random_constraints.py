"""Random constraints of velocities: integrals are proved by differentiation, others have none."""

from itertools import combinations

import numpy as np
import pytest
import sympy as sp
from differential_constraints import (
    R,
    c,
    constrained,
    dphi,
    dtheta,
    dx,
    dy,
    dz,
    phi,
    s,
    theta,
    x,
    y,
    z,
)

from derive import TIME

VARIABLES = (x, y, z, theta, phi, TIME)
RATES = (dx, dy, dz, dtheta, dphi, sp.S.One)
POLYNOMIALS = (x, y, z, phi, theta, x * y, x**2, z**2, y * z, R * phi, x * phi, TIME * x)
TERMS = (*POLYNOMIALS, s, c, x * c, y * s)
#: Factors of constraints, of which none is 0 everywhere.
FACTORS = (sp.S.One, sp.S(-3), R, 1 + x**2, c, 2 + s, 1 / (2 + y**2))
WAVES = sp.symbols("sine cosine")


def combination(rng: np.random.Generator, terms: tuple[sp.Expr, ...], count: int) -> sp.Expr:
    """A sum of some of the terms with small integer coefficients."""
    chosen = rng.choice(len(terms), count, replace=False).tolist()
    return sp.Add(*(int(rng.choice([-3, -2, -1, 1, 2, 3])) * terms[k] for k in chosen))


def rate(formula: sp.Expr) -> sp.Expr:
    """The rate of change of a function of the variables."""
    return sp.Add(*(formula.diff(q) * v for q, v in zip(VARIABLES, RATES, strict=True)))


def coefficients(constraint: sp.Expr) -> list[sp.Expr]:
    """Of the differentials of all variables."""
    *velocities, _ = RATES
    slopes = [constraint.diff(v) for v in velocities]
    return [*slopes, constraint.subs(dict.fromkeys(velocities, 0))]


def vanishes(formula: sp.Expr) -> bool:
    """Whether a rational function of variables, sines and cosines is 0."""
    numerator = sp.numer(sp.together(formula)).subs({s: WAVES[0], c: WAVES[1]})
    remainder = sp.reduced(sp.expand(numerator), [WAVES[0] ** 2 + WAVES[1] ** 2 - 1], *WAVES)[1]
    return bool(sp.expand(remainder) == 0)


def is_combination(row: list[sp.Expr], rows: list[list[sp.Expr]]) -> bool:
    """Whether a row depends on other rows, which are independent."""
    size = len(rows) + 1
    matrix = sp.Matrix([*rows, row])
    columns = combinations(range(matrix.cols), size)
    return all(vanishes(matrix[:, list(chosen)].det()) for chosen in columns)


@pytest.mark.long("more cases of the same kind", keep=5, daily=20)
@pytest.mark.parametrize("seed", range(40))
def test_a_constraint_with_an_integral(seed: int) -> None:
    rng = np.random.default_rng(seed)
    integral = combination(rng, TERMS, int(rng.integers(2, 5)))
    constraint = FACTORS[seed % len(FACTORS)] * rate(integral)
    result = constrained(constraint).integrability
    assert (result.integrable, result.nonholonomic) == (1, 0)
    (found,) = result.held.values()
    row = coefficients(constraint)
    assert is_combination([found.diff(q) for q in VARIABLES], [row])
    # where the constraint is regular, so is the integral
    assert not is_combination([(found + x * y * z).diff(q) for q in VARIABLES], [row])


@pytest.mark.long("other tests reach its code", daily=10)
@pytest.mark.parametrize("seed", range(20))
def test_two_constraints_that_are_integrable_together(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first, second = (rate(combination(rng, TERMS, 2) + q) for q in (y, 2 * z))
    factor = combination(rng, (x, y, s, c, sp.S.One), 2)
    constraints = [first + factor * second, second]
    result = constrained(*constraints).integrability
    assert (result.integrable, result.nonholonomic) == (2, 0)
    rows = [*map(coefficients, constraints)]
    for found in result.integrals:
        assert is_combination([found.diff(q) for q in VARIABLES], rows)
    assert set(result.held.values()) <= set(result.integrals)


@pytest.mark.long("more cases of the same kind", keep=16)
@pytest.mark.parametrize("seed", range(40))
def test_a_constraint_without_an_integral(seed: int) -> None:
    rng = np.random.default_rng(seed)
    constraint = sp.Add(*(combination(rng, TERMS, 2) * v for v in (dx, dy, dz, dtheta)))
    form = coefficients(constraint)
    # oracle: the form times its exterior derivative is not 0
    curls = (
        sum(form[a] * (form[d].diff(VARIABLES[b]) - form[b].diff(VARIABLES[d]))
            for a, b, d in ((i, j, k), (j, k, i), (k, i, j)))
        for i, j, k in combinations(range(len(form)), 3)
    )  # fmt: skip
    assert not all(map(vanishes, curls))
    result = constrained(constraint).integrability
    assert (result.integrable, result.nonholonomic, result.held) == (0, 1, {})
    assert not result.note
