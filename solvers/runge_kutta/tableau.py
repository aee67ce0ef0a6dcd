"""Butcher tableaus: the coefficients of a method, and the properties that follow from them."""

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import cached_property
from itertools import accumulate, pairwise
from operator import sub
from typing import NamedTuple

import numpy as np

from solvers.runge_kutta.collocation import is_collocation, quadrature_order
from solvers.runge_kutta.order_conditions import (
    WORKING_DIGITS,
    Matrix,
    Number,
    nystrom_order,
    order,
)

#: A decimal with more digits is a rounded one, a shorter one is exact.
LONG = 20
#: Coefficients of R(z) below this are rounding errors of decimals, and count as 0.
ROUNDING = 1e-25


class StateWeights(NamedTuple):
    """Weights of a part of the state, and stage matrices of the nodes of trees in turn.

    `linear` is that of `solvers.runge_kutta.order_conditions.alternating_trees`; None for all
    trees.
    """

    b: tuple[Number, ...]
    matrices: tuple[Matrix, ...]
    linear: int | None


@dataclass(frozen=True)
class Tableau:
    """Coefficients A, b and, for methods that estimate their error, b_hat.

    Coefficients are not checked; `order` and the other properties follow from them.

    They are exact (`fractions.Fraction`, `solvers.runge_kutta.surd.Surd`) or, where a method is
    published in decimals only, `decimal.Decimal` with all their digits. The nodes c are the row
    sums of A.

    Examples
    --------
    >>> heun = Tableau.explicit("Heun", rows="1", b="1/2 1/2")
    >>> heun.order, heun.stages
    (2, 2)
    """

    title: str  # usual name of the method
    A: tuple[tuple[Number, ...], ...]
    b: tuple[Number, ...]
    b_hat: tuple[Number, ...] = ()  # weights of an embedded solution
    b_low: tuple[Number, ...] = ()  # of another one, of lower order, for a combined error estimate
    #: how implicit stages are solved: "newton", or "fixed-point" for equations that are not stiff
    iteration: str = "newton"
    #: methods of lower order, in decreasing order, to which controlled steps may change
    lower: tuple["Tableau", ...] = ()

    @classmethod
    def explicit(
        cls, title: str, rows: str, b: str = "", b_hat: str = "", b_low: str = ""
    ) -> "Tableau":
        """A tableau from text: numbers between spaces, rows between semicolons.

        The rows are those of A from the second stage on, each left of its diagonal. Numbers are
        fractions such as ``1/6`` or decimals, and are exact; if a decimal of A or b has more than
        `LONG` characters, all become `decimal.Decimal`. Without `b`, weights are the last row, so
        that the last stage is the first of the next step.
        """
        b = b or f"{rows.rpartition(';')[2]} 0"
        lines = [[], *(row.split() for row in rows.split(";") if row.strip())]
        numbers = f"{rows} {b}".replace(";", " ").split()
        rounded = any(len(number) > LONG and "/" not in number for number in numbers)
        read = _decimal if rounded else Fraction
        A = [[read(n) for n in line] + [read("0")] * (len(lines) - len(line)) for line in lines]
        weights, hat, low = (tuple(map(read, text.split())) for text in (b, b_hat, b_low))
        return cls(title, tuple(map(tuple, A)), weights, hat, low)

    @property
    def stages(self) -> int:
        """Number of stages."""
        return len(self.b)

    @cached_property
    def c(self) -> tuple[Number, ...]:
        """Nodes: the row sums of A."""
        with localcontext(prec=WORKING_DIGITS):
            return tuple(sum(row[1:], row[0]) for row in self.A)

    @cached_property
    def order(self) -> int:
        """Order of the solution, by its order conditions."""
        if self.is_collocation:
            return quadrature_order(self.b, self.c)
        return order(self.A, self.b)

    @cached_property
    def embedded_order(self) -> int:
        """Order of the embedded solution; 0 without one."""
        if self.is_radau:  # it uses the derivative at the start, too
            return self.stages
        return order(self.A, self.b_hat) if self.b_hat else 0

    @cached_property
    def error_order(self) -> int:
        """Order of the error estimate, 0 without one; of two combined, see `Controller.norm`."""
        if self.is_parallel:
            return self.order
        if self.b_low:
            return 2 * self.embedded_order - order(self.A, self.b_low)
        return min(self.order, self.embedded_order)

    @cached_property
    def error_weights(self) -> tuple[tuple[Number, ...], ...]:
        """The weights b - b_hat of the error estimate, and b - b_low of a second one."""
        embedded = [weights for weights in (self.b_hat, self.b_low) if weights]
        with localcontext(prec=WORKING_DIGITS):
            return tuple(tuple(map(sub, self.b, weights)) for weights in embedded)

    @property
    def state_weights(self) -> tuple[StateWeights, ...]:
        """Weights of the whole state, or of its halves if they differ."""
        return (StateWeights(self.b, (self.A,), None),)

    @property
    def is_splitting(self) -> bool:
        """Whether it is of kicks and drifts, for accelerations of positions alone."""
        return False

    @property
    def takes_any_form(self) -> bool:
        """Whether it integrates every form of the equations, not Lagrange's only."""
        return not self.needs_jacobian

    @property
    def is_explicit(self) -> bool:
        """Whether each stage needs earlier ones only."""
        return all(a == 0 for i, row in enumerate(self.A) for a in row[i:])

    @cached_property
    def is_collocation(self) -> bool:
        """Whether this is a collocation method, with nodes in decimals."""
        decimals = isinstance(self.b[0], Decimal)
        return decimals and not self.is_explicit and is_collocation(self.A, self.c)

    @cached_property
    def is_radau(self) -> bool:
        """Whether this is a Radau IIA method with a real eigenvalue of A, which estimates errors.

        It is a collocation method of order 2s - 1 with an odd number of stages s from 3 on, whose
        last stage is the end of the step.
        """
        s = self.stages
        if self.is_explicit or s < 3 or s % 2 == 0 or self.order != 2 * s - 1:
            return False
        A, c, k = np.array(self.A, float), np.array(self.c, float), np.arange(1, s + 1)
        integrals = c[:, np.newaxis] ** k / k
        exact = np.allclose(A @ c[:, np.newaxis] ** (k - 1), integrals, rtol=0, atol=1e-13)
        return exact and c[-1] == 1

    @property
    def is_parallel(self) -> bool:
        """Whether all stages are evaluated at once, by a fixed-point iteration."""
        return self.iteration == "fixed-point"

    @property
    def needs_jacobian(self) -> bool:
        """Whether the stages are solved by Newton's method."""
        return not self.is_explicit and not self.is_parallel

    @property
    def members(self) -> tuple["Tableau", ...]:
        """The methods of controlled steps: this one, and those of lower order."""
        return (self, *self.lower)

    @property
    def estimates_error(self) -> bool:
        """Whether steps can be controlled."""
        return bool(self.b_hat) or self.is_parallel or self.is_radau

    @property
    def is_fsal(self) -> bool:
        """Whether the last stage is the first of the next step: its row is b, and b ends in 0."""
        return self.is_explicit and self.stages > 1 and self.A[-1] == self.b

    @cached_property
    def stability_function(self) -> tuple[tuple[Number, ...], tuple[Number, ...]]:
        """R(z) as coefficients of z⁰, z¹, … of its numerator and of its denominator.

        A step of y' = λy multiplies y by R(hλ) = det(I - z (A - 1bᵀ)) / det(I - z A)
        with z = hλ (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II,
        proposition IV.3.2).
        """
        with localcontext(prec=WORKING_DIGITS):
            shifted = [[*map(sub, row, self.b)] for row in self.A]
            numerator, denominator = map(_determinant_of_identity_minus, (shifted, self.A))
        # a stage with zero weight adds no power of z
        degree = max((k for k, x in enumerate(numerator) if abs(float(x)) > ROUNDING), default=0)
        return numerator[: degree + 1], denominator


@dataclass(frozen=True)
class Splitting(Tableau):
    """Kicks and drifts in turn: a symplectic, explicit method for q' = v, v' = a(t, q).

    A step kicks the velocities, by b h a(t, q), and drifts the positions, by d h v, in turn: `b`
    are the kicks, and `drifts` the drift before each of them, 0 before the first one. Both are
    exact flows of parts of the Hamiltonian, so that a step preserves phase space as the motion does
    (E. Hairer, Ch. Lubich, G. Wanner, Geometric Numerical Integration, sections II.5, VI.3). The
    acceleration at its end is that at the start of the next one.

    A stage is the state before a kick. Its velocities have the stage matrix A, b below the
    diagonal, and its positions `position_matrix`, drifts up to the diagonal: a pair of tableaus
    (the same book, section II.2).

    Examples
    --------
    >>> leapfrog = Splitting.symmetric("Leapfrog", kicks="1/2", drifts="1")
    >>> [str(b) for b in leapfrog.b], [str(d) for d in leapfrog.drifts], leapfrog.order
    (['1/2', '1/2'], ['0', '1'], 2)
    """

    drifts: tuple[Number, ...] = ()

    @classmethod
    def symmetric(cls, title: str, kicks: str, drifts: str) -> "Splitting":
        """A splitting that is the same backwards, by its first half up to the middle.

        Kicks and drifts alternate, first a kick. Numbers are as in `Tableau.explicit`.
        """
        numbers = f"{kicks} {drifts}".split()
        rounded = any(len(number) > LONG and "/" not in number for number in numbers)
        read = _decimal if rounded else Fraction
        return cls._mirrored(title, [*map(read, kicks.split())], [*map(read, drifts.split())])

    @classmethod
    def composition(cls, title: str, factors: str) -> "Splitting":
        """Leapfrog steps of these parts of a step, and backwards but for the last one."""
        with localcontext(prec=WORKING_DIGITS):
            drifts = [*map(_decimal, factors.split())]
            kicks = [drifts[0] / 2, *((x + y) / 2 for x, y in pairwise(drifts))]
        return cls._mirrored(title, kicks, drifts)

    @classmethod
    def _mirrored(
        cls, title: str, kicks: Sequence[Number], drifts: Sequence[Number]
    ) -> "Splitting":
        middle = slice(-2 if len(kicks) > len(drifts) else None, None, -1)
        other = slice(-2 if len(kicks) == len(drifts) else None, None, -1)
        zero = kicks[0] - kicks[0]
        b, d = (*kicks, *kicks[middle]), (zero, *drifts, *drifts[other])
        A = tuple((*b[:i], *[zero] * (len(b) - i)) for i in range(len(b)))
        return cls(title, A, b, drifts=d)

    @property
    def position_matrix(self) -> Matrix:
        """Stage matrix of the positions."""
        d, s = self.drifts, self.stages
        return tuple((*d[: i + 1], *[d[0]] * (s - i - 1)) for i in range(s))

    @cached_property
    def c(self) -> tuple[Number, ...]:
        """Nodes: the sums of the drifts."""
        with localcontext(prec=WORKING_DIGITS):
            return tuple(accumulate(self.drifts))

    @cached_property
    def order(self) -> int:
        """Order for q' = v, v' = a(t, q), by the order conditions of these equations."""
        return nystrom_order(self.A, self.b, self.position_matrix, self.drifts)

    @property
    def state_weights(self) -> tuple[StateWeights, ...]:
        """Weights of the positions, and of the velocities."""
        return (
            StateWeights(self.drifts, (self.A, self.position_matrix), 0),
            StateWeights(self.b, (self.position_matrix, self.A), 1),
        )

    @property
    def is_splitting(self) -> bool:
        """Whether it is of kicks and drifts."""
        return True

    @property
    def takes_any_form(self) -> bool:
        """Whether it integrates every form; a splitting needs states (q, q̇)."""
        return False

    @property
    def is_fsal(self) -> bool:
        """Whether the acceleration at the last stage is the first of the next step."""
        return True

    @cached_property
    def half_trace(self) -> tuple[Number, ...]:
        """Half the trace of a step of q'' = -ω²q, as coefficients of powers of (hω)²."""
        with localcontext(prec=WORKING_DIGITS):
            one = self.b[0] - self.b[0] + 1
            q, v = [(one,), ()], [(), (one,)]  # q and h v, by those at the start
            for kick, drift in zip(self.b, self.drifts, strict=True):
                q = [_sum(x, y, drift) for x, y in zip(q, v, strict=True)]
                v = [_sum(y, (0 * one, *x), -kick) for x, y in zip(q, v, strict=True)]
            trace = _sum(q[0], v[1], one)
            return tuple(x / 2 for x in trace)


def _sum(p: Sequence[Number], q: Sequence[Number], factor: Number) -> tuple[Number, ...]:
    """The polynomial p + factor q."""
    length = max(len(p), len(q))
    p, q = ((*x, *[0 * factor] * (length - len(x))) for x in (p, q))
    return tuple(x + factor * y for x, y in zip(p, q, strict=True))


def _decimal(text: str) -> Decimal:
    numerator, _, denominator = text.partition("/")
    with localcontext(prec=WORKING_DIGITS):
        return Decimal(numerator) / Decimal(denominator or 1)


def _determinant_of_identity_minus(matrix: Sequence[Sequence[Number]]) -> tuple[Number, ...]:
    """Coefficients of det(I - z B) in z, by Faddeev and LeVerrier's recursion."""
    B = np.array(matrix, dtype=object)  # exact numbers stay exact
    power, coefficients = 0 * B, [0 * B[0, 0] + 1]
    for k in range(1, len(B) + 1):
        power = B @ (power + np.diag([coefficients[-1]] * len(B)))
        coefficients.append(-np.trace(power) / k)
    while coefficients[-1] == 0:  # the first one is 1
        coefficients.pop()
    return tuple(coefficients)
