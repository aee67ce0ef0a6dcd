"""Stages of a Gauss method, evaluated all at once and iterated to a fixed point.

The derivatives at the stages are those of a polynomial of degree s - 1, from which the next step
starts (P. J. van der Houwen, B. P. Sommeijer, Journal of Computational and Applied Mathematics 29
(1990) 111-127). Increments L = h b k take the place of the derivatives k, since the ratios
m = a_ij / b_j can be rounded such that m_ij + m_ji = 1 exactly, as a symplectic method requires
(M. Antoñana, J. Makazaga, A. Murua, arXiv 2511.03655).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from decimal import localcontext
from fractions import Fraction
from math import comb, floor, frexp, ldexp

import numpy as np
from numpy.polynomial.legendre import legint, legval
from numpy.typing import NDArray

from solvers.runge_kutta.order_conditions import WORKING_DIGITS
from solvers.runge_kutta.tableau import Tableau

Array = NDArray[np.float64]
#: The iteration ends when the next change would be below this part of the tolerance; the second is
#: that within a step of more than `FEW` stages, whose end has an error far below the tolerance.
CLOSE, CLOSE_WITHIN, FEW = 0.02, 2e-3, 4
#: The least square of the contraction that the first two changes can show: parts of the error of
#: the prediction decrease much faster than what is left.
LEAST_SQUARE = 3e-4
#: The error of a step is estimated after this many iterations: the top coefficient of the
#: polynomial converges faster than the stages. It is estimated again at the end where the square of
#: the contraction is larger than `SLOW`.
EARLY, SLOW = 3, 0.25
#: Relative rounding errors of numbers, and of derivatives, at which an iteration may stagnate.
#: A number that counts as 0, but whose reciprocal has a square.
SMALLEST = 1e-100
EPSILON, ROUNDING, MAX_ITERATIONS = np.finfo(float).eps, 32 * np.finfo(float).eps, 200
TINY = float(np.finfo(float).tiny)


def symplectic_ratios(tableau: Tableau) -> Array:
    """a_ij / b_j, rounded such that each and its transpose add up to 1 exactly."""
    with localcontext(prec=WORKING_DIGITS):
        ratios = np.array(
            [[float(a / b) for a, b in zip(row, tableau.b, strict=True)] for row in tableau.A]
        )
    for i in range(tableau.stages):
        ratios[i, i] = 0.5
        for j in range(i):
            ratios[j, i] = 1 - ratios[i, j]  # exactly, since the ratio is between 1/2 and 2
            assert Fraction(ratios[i, j]) + Fraction(ratios[j, i]) == 1
    return ratios


def legendre_matrix(tableau: Tableau) -> Array:
    """Increments to the Legendre coefficients on [0, 1] of the polynomial h dy/dt."""
    nodes = 2 * np.array(tableau.c, float) - 1
    degrees = np.arange(tableau.stages)
    return np.asarray((2.0 * degrees[:, np.newaxis] + 1) * legval(nodes, np.eye(tableau.stages)))


def bernstein_matrix(stages: int) -> Array:
    """Legendre coefficients of h dy/dt to Bernstein coefficients of the change of y on [0, 1]."""
    rows = [[Fraction(0)] * stages for _ in range(stages + 1)]
    for m in range(stages):
        legendre = [(-1) ** (m - i) * comb(m, i) * comb(m + i, i) for i in range(m + 1)]
        integral = [Fraction(0), *(Fraction(a, i) for i, a in enumerate(legendre, 1))]
        for k in range(stages + 1):
            terms = enumerate(integral[: k + 1])
            rows[k][m] = sum((comb(k, i) * a / comb(stages, i) for i, a in terms), Fraction(0))
    return np.array(rows, float)


def rough_log2(x: float) -> float:
    """Binary logarithm within 0.09, more than step control needs: linear between powers of two."""
    mantissa, exponent = frexp(x)
    return exponent + 2 * mantissa - 2


def rough_exp2(x: float) -> float:
    """The inverse of this function."""
    return ldexp(1 + x - floor(x), floor(x))


def error_power(stages: int) -> float:
    """The power of a ratio in the error norm, such that it has the order of the local error.

    The top coefficient decreases with the power s of h, its ratio to the lowest ones with s - 1,
    and the local error with 2s + 1.
    """
    return (stages + 1) / (stages - 1)


@dataclass(frozen=True)
class Polynomial:
    """h dy/dt of a step of size `h`, signed, by Legendre coefficients on [0, 1].

    It predicts the stages of a step that starts at `origin`, a part of h: where the step ends, or
    at its start for a shorter step. A step whose error is larger than `largest_error` ends early;
    that is infinite within an accepted step. The iteration ends when the next change would be below
    the part `close` of the tolerance.
    """

    h: float
    coefficients: Array  # of shape (stages, state)
    origin: float = 1.0
    largest_error: float = 1.0
    close: float = CLOSE

    @classmethod
    def constant(cls, h: float, derivative: Array, stages: int) -> "Polynomial":
        """That of a constant derivative."""
        rows = np.zeros((stages, len(derivative)))
        rows[0] = h * derivative
        return cls(h, rows)

    def after_rejection(self) -> "Polynomial":
        """The same polynomial for a shorter step instead of this one."""
        return replace(self, origin=0.0)

    def within(self) -> "Polynomial":
        """The same polynomial for states within this step, which has been accepted."""
        close = CLOSE if len(self.coefficients) <= FEW else CLOSE_WITHIN
        return replace(self, origin=0.0, largest_error=np.inf, close=close)

    def derivatives(self, h: float, c: Array) -> Array:
        """Value of h dy/dt at the nodes of a step of size `h`, in rows."""
        ratio = h / self.h
        x = 2 * (self.origin + ratio * c) - 1
        return ratio * np.asarray(legval(x, self.coefficients), float).T

    def change(self, h: Array) -> Array:
        """The changes of y, in columns, over first parts of the step, of sizes `h`.

        They have a lower order than the step.
        """
        integral = legint(self.coefficients, lbnd=-1, scl=0.5)
        return np.asarray(legval(2 * h / self.h - 1, integral), float)


@dataclass(frozen=True)
class IteratedStages:
    """Stages after an iteration: increments, its contraction, the norm of the step's error.

    The iteration ended early if that is larger than the prediction permits.
    """

    increments: Array
    contraction: float
    error_norm: float


class NoFixedPointError(ArithmeticError):
    """The iteration does not converge."""


class ParallelStages:
    """The iteration of one method to tolerances, or to rounding errors if these are 0."""

    def __init__(self, tableau: Tableau, rtol: float, atol: float | Array) -> None:
        self.ratios, self.legendre = symplectic_ratios(tableau), legendre_matrix(tableau)
        self.c, self.b = np.array(tableau.c, float), np.array(tableau.b, float)
        self._rtol, self._atol = rtol, atol
        self._is_controlled = bool(rtol or np.any(atol))

    def solve(
        self, derivatives: Callable[[Array], Array], y: Array, h: float, last: Polynomial
    ) -> IteratedStages:
        """Solve the stages of a step of size `h` from `y`.

        `derivatives` evaluates all stages, whose states are rows; `last` predicts them.
        `NoFixedPointError` where the iteration does not converge.
        """
        increments = self.b[:, np.newaxis] * last.derivatives(h, self.c)
        limit = last.close**2 if self._is_controlled else 0.0
        previous, square, norm, is_last = np.inf, 0.0, None if limit else 0.0, False
        allowed = self._atol + self._rtol * np.abs(y) + SMALLEST
        # with fixed steps and within accepted ones; other steps are shortened at once
        may_grow = not limit or last.largest_error == np.inf
        for iteration in range(1, MAX_ITERATIONS + 1):
            before = increments
            increments = h * self.b[:, np.newaxis] * derivatives(y + self.ratios @ increments)
            if is_last:
                break
            size = np.abs(y) + np.abs(increments).sum(axis=0) + SMALLEST
            if iteration == 1 and not limit:
                allowed = EPSILON * size
            with np.errstate(over="ignore"):
                change = float(np.sum(((increments - before) / allowed) ** 2))
                least = ROUNDING**2 * len(self.b) * float(np.sum((size / allowed) ** 2))
            if iteration > 1:
                bound = LEAST_SQUARE if iteration == 2 else square / 4
                square = max(change / previous if previous else 0.0, bound)
                is_last = change * (square * square) <= limit
                if change * square <= limit or previous <= change < least:
                    break
            if not change < (np.inf if may_grow else 16 * previous):
                message = f"the stages still change by {np.sqrt(change):.1e} tolerances"
                raise NoFixedPointError(message)
            if iteration == EARLY and limit:
                norm = self.error_norm(y, increments)
                if norm > last.largest_error:
                    break
            previous = change
        else:
            raise NoFixedPointError(f"{MAX_ITERATIONS} iterations do not suffice")
        if norm is None or (square > SLOW and is_last):
            norm = self.error_norm(y, increments)
        return IteratedStages(increments, float(np.sqrt(square)), norm)

    def error_norm(self, y: Array, increments: Array) -> float:
        """Root mean square of the top coefficients, times a power of their ratio to the lowest.

        The power makes it decrease as the local error does, see `error_power`.
        """
        squares = (self.legendre @ increments) ** 2
        size = np.maximum(np.abs(y), np.abs(y + increments.sum(axis=0)))
        allowed = np.maximum(self._atol + self._rtol * size, SMALLEST)
        lowest = squares[:3].sum(axis=0) + SMALLEST
        with np.errstate(over="ignore"):
            quotients = squares[-1] / (allowed**2 * lowest)
            total = float(np.sum(quotients * lowest)) + TINY
            weighted = float(np.sum(quotients * squares[-1])) + TINY
        if not np.isfinite(total):
            return np.inf
        decrease = error_power(len(self.b)) * (rough_log2(weighted) - rough_log2(total))
        return float(np.sqrt(total / len(y) * rough_exp2(decrease)))
