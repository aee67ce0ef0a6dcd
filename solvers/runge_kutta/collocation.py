"""Collocation methods: their coefficients follow from the nodes.

Over a step, a collocation polynomial fulfils the differential equation at the nodes c. The method
has the order of the quadrature formula with these nodes (E. Hairer, S. P. Nørsett, G. Wanner,
Solving Ordinary Differential Equations I, theorem II.7.9). It is a sum of Lagrange polynomials.
"""

from collections.abc import Sequence
from decimal import Decimal, localcontext
from functools import cache
from itertools import count
from math import comb

import numpy as np
from numpy.typing import NDArray

from solvers.runge_kutta.order_conditions import WORKING_DIGITS, Number

Decimals = tuple[Decimal, ...]
#: Residuals of conditions below this are rounding errors of the working digits.
ROUNDING = Decimal(10) ** (30 - WORKING_DIGITS)


@cache
def gauss_nodes(stages: int) -> Decimals:
    """The zeros of the Legendre polynomial on [0, 1], in ascending order."""
    return _zeros(_legendre(stages))


@cache
def radau_nodes(stages: int) -> Decimals:
    """The zeros of P_s - P_{s-1} on [0, 1], in ascending order; the last one is 1."""
    lower = [*_legendre(stages - 1), 0]
    return _zeros([a - b for a, b in zip(_legendre(stages), lower, strict=True)])


def collocation(c: Sequence[Decimal]) -> tuple[tuple[Decimals, ...], Decimals]:
    """Stage matrix A and weights b: integrals of the Lagrange polynomials of the nodes."""
    with localcontext(prec=WORKING_DIGITS):
        basis = [_lagrange(c, j) for j in range(len(c))]
        *A, b = (tuple(_integral(p, x) for p in basis) for x in (*c, Decimal(1)))
        return tuple(A), b


def is_collocation(A: Sequence[Sequence[Number]], c: Sequence[Number]) -> bool:
    """Whether A integrates polynomials of degree below the number of stages exactly, up to c."""
    with localcontext(prec=WORKING_DIGITS):
        return len(set(c)) == len(c) and all(
            _vanishes(sum(a * x ** (k - 1) for a, x in zip(row, c, strict=True)) - end**k / k)
            for row, end in zip(A, c, strict=True)
            for k in range(1, len(c) + 1)
        )


def quadrature_order(b: Sequence[Decimal], c: Sequence[Decimal]) -> int:
    """One more than the degree up to which polynomials on [0, 1] are integrated exactly."""
    with localcontext(prec=WORKING_DIGITS):
        for k in count(1):
            moment = sum(w * x ** (k - 1) for w, x in zip(b, c, strict=True))
            if not _vanishes(moment - 1 / Decimal(k)):
                return k - 1
    raise AssertionError("no formula is exact for every degree")


def _vanishes(residual: Decimal) -> bool:
    return abs(residual) < ROUNDING


def _legendre(n: int) -> list[int]:
    """Coefficients of the Legendre polynomial on [0, 1], from the constant on."""
    return [(-1) ** (n - k) * comb(n, k) * comb(n + k, k) for k in range(n + 1)]


def _zeros(polynomial: Sequence[int]) -> Decimals:
    """Simple zeros by Newton's iteration from those in floating-point numbers."""
    derivative = [k * a for k, a in enumerate(polynomial)][1:]
    with localcontext(prec=WORKING_DIGITS):
        zeros = [Decimal(float(x)) for x in sorted(np.roots(polynomial[::-1]).real)]
        for _ in range(7):  # the number of digits doubles
            zeros = [x - _value(polynomial, x) / _value(derivative, x) for x in zeros]
        return tuple(zeros)


def _value(polynomial: Sequence[int | Decimal], x: Decimal) -> Decimal:
    value = Decimal(0)
    for a in reversed(polynomial):
        value = value * x + a
    return value


def _integral(polynomial: Sequence[Decimal], x: Decimal) -> Decimal:
    """From 0 to x."""
    return x * _value([a / k for k, a in enumerate(polynomial, 1)], x)


def _lagrange(c: Sequence[Decimal], j: int) -> list[Decimal]:
    """Coefficients of the polynomial that is 1 at node j and 0 at the others."""
    polynomial = [Decimal(1)]
    for m, x in enumerate(c):
        if m != j:
            shifted, scaled = [Decimal(0), *polynomial], [*(-x * a for a in polynomial), Decimal(0)]
            polynomial = [(a + b) / (c[j] - x) for a, b in zip(shifted, scaled, strict=True)]
    return polynomial


Array = NDArray[np.float64]


def lagrange_factors(c: Array) -> Array:
    """Reciprocal denominators of the Lagrange polynomials; 0 if nodes coincide."""
    differences = c[:, np.newaxis] - c + np.eye(len(c))
    if not differences.all():
        return np.zeros(len(c))
    return np.asarray(1 / differences.prod(axis=1))


def lagrange(c: Array, x: Array) -> Array:
    """Values of the Lagrange polynomials of the nodes c at each of `x`, in rows."""
    differences = np.tile(x[:, np.newaxis, np.newaxis] - c, (1, len(c), 1))
    differences[:, range(len(c)), range(len(c))] = 1
    return np.asarray(lagrange_factors(c) * differences.prod(axis=2))
