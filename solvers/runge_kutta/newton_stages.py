"""Stages of an implicit method by Newton's iteration.

The derivatives k of the stages of a step of size h from y fulfil k_i = f(t + c_i h, y + h Σ_j a_ij
k_j). A simplified iteration has one Jacobian J for all stages: with A = T M T⁻¹, where M has blocks
of size 1 and 2 for real eigenvalues and pairs of complex ones, its matrix I - h A⊗J falls apart
into matrices I - h M_b⊗J (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II,
section IV.8). The stages contain A itself: T and M decide only how fast the iteration converges.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from solvers.runge_kutta.collocation import lagrange, lagrange_factors
from solvers.runge_kutta.tableau import Tableau

Array = NDArray[np.float64]
#: Eigenvectors with a larger condition number are not used.
LARGEST_CONDITION = 1e8


@dataclass(frozen=True)
class Blocks:
    """A = T M T⁻¹ with a block diagonal matrix M; real eigenvalues come first."""

    T: Array
    inverse: Array
    M: Array
    sizes: tuple[int, ...]

    @classmethod
    def of(cls, A: Array) -> "Blocks":
        """The blocks of A: A itself is the only one if its eigenvectors are (nearly) dependent."""
        values, vectors = np.linalg.eig(A)
        columns, sizes = [], []
        for j in sorted(range(len(A)), key=lambda j: (values[j].imag != 0, values[j].real)):
            if values[j].imag >= 0:  # the other one of a pair is its conjugate
                parts = [vectors[:, j].real, vectors[:, j].imag][: 1 + (values[j].imag > 0)]
                columns += parts
                sizes.append(len(parts))
        T = np.stack(columns, axis=1)
        if not np.linalg.cond(T) < LARGEST_CONDITION:
            return cls(np.eye(len(A)), np.eye(len(A)), A, (len(A),))
        inverse = np.linalg.inv(T)
        return cls(T, inverse, inverse @ A @ T, tuple(sizes))

    def slices(self) -> Iterator[slice]:
        """Rows of each block."""
        ends = accumulate(self.sizes)
        return (slice(end - size, end) for end, size in zip(ends, self.sizes, strict=True))


Solve = Callable[[Array], Array]

#: A Jacobian is kept for the next step while an iteration reduces the error to this part.
KEPT_RATE = 1e-3
#: Error of the stages of a controlled step, relative to the tolerance.
SHARE = 0.01
#: The iteration of fixed steps ends when the relative change is below this.
CLOSE = 1e-14
MAX_FIXED_ITERATIONS, MAX_FULL_ITERATIONS = 50, 12
#: The shortest part of a step by which a solution is continued.
SHORTEST_PART = 2.0**-12
#: Numbers that are not much larger have fewer digits than others.
TINY = 1e-290


class UnsolvedError(ArithmeticError):
    """Stage equations that were not solved."""


def max_iterations(stages: int) -> int:
    """Most iterations of a controlled step."""
    return 7 + 2 * max(stages - 3, 0)


@dataclass(frozen=True)
class NewtonStages:
    """Solved stages of a step of size h, with the point at which the Jacobian was evaluated."""

    h: float
    c: Array  # the nodes
    k: Array  # of shape (stages, state)
    t: float
    y: Array
    rate: float  # part of the error that an iteration leaves
    contraction: float = 0.0  # the mean of the last two rates; 0 if one iteration sufficed

    @classmethod
    def constant(cls, t: float, y: Array, h: float, derivative: Array, c: Array) -> "NewtonStages":
        """Those before the first step."""
        return cls(h, c, np.tile(derivative, (len(c), 1)), t, y, 1.0)


@dataclass(frozen=True)
class Start:
    """Start and size of a step."""

    t: float
    y: Array
    h: float


class Newton:
    """The stages of one method for one right-hand side, both of which raise `ArithmeticError`.

    With tolerances they are solved to a share of these, else to rounding errors. `njev` counts
    evaluations of the Jacobian.
    """

    def __init__(
        self,
        tableau: Tableau,
        derivative: Callable[[float, Array], Array],
        jacobian: Callable[[float, Array], Array],
        rtol: float,
        atol: float | Array,
    ) -> None:
        self.A, self.c = np.array(tableau.A, float), np.array(tableau.c, float)
        self.blocks = Blocks.of(self.A)
        self.is_controlled = bool(rtol or np.any(atol))
        self._derivative, self._jacobian = derivative, jacobian
        self._rtol, self._atol = rtol, atol
        self._has_polynomial = bool(lagrange_factors(self.c).all())
        self.njev = 0

    def solve(self, start: Start, derivative: Array, last: NewtonStages) -> NewtonStages:
        """The stages of a step after the stages of the last one; `derivative` is that at its start.

        Raises `UnsolvedError`.
        """
        guess = np.tile(derivative, (len(self.c), 1))
        if self._has_polynomial:
            guess = self._extrapolated(1.0, start.h / last.h, last.c, last.k)
        points = [(start.t, start.y)]
        if last.rate <= KEPT_RATE:
            points.insert(0, (last.t, last.y))
        for t, y in points:
            self.njev += int(t == start.t)
            try:
                linearised = self._linearised(t, y, start.h)
                k, rates = self._iterate(start, guess, *linearised, last.rate)
            except UnsolvedError:
                if self.is_controlled and t == start.t:
                    raise
            else:
                return NewtonStages(start.h, self.c, k, t, y, *rates)
        k = self._continue(start, derivative)
        return NewtonStages(start.h, self.c, k, start.t, start.y, 1.0)

    def filter(self, stages: NewtonStages) -> Solve:
        """The product with (I - h g J)⁻¹, where g is the real eigenvalue of A."""
        J = self._jacobian(stages.t, stages.y)
        matrix = np.eye(len(J)) - stages.h * self.blocks.M[0, 0] * J
        return lambda error: np.linalg.solve(matrix, error)

    def _linearised(self, t: float, y: Array, h: float) -> tuple[Solve, float]:
        """Changes of k from residuals, by the Jacobian at a point; and its largest element."""
        J = self._jacobian(t, y)
        parts = [
            (rows, np.eye(len(J) * (rows.stop - rows.start)) - h * np.kron(M[rows, rows], J))
            for M in [self.blocks.M]
            for rows in self.blocks.slices()
        ]

        def change(residual: Array) -> Array:
            transformed = self.blocks.inverse @ residual
            for rows, matrix in parts:
                solution = np.linalg.solve(matrix, transformed[rows].ravel())
                transformed[rows] = solution.reshape(-1, len(J))
            return np.asarray(self.blocks.T @ transformed)

        return change, float(np.abs(J).max())

    def _states(self, start: Start, k: Array) -> Array:
        return np.asarray(start.y + start.h * (self.A @ k))

    def _residual(self, start: Start, k: Array) -> Array:
        times = (start.t + self.c * start.h).tolist()
        return np.array(list(map(self._derivative, times, self._states(start, k)))) - k

    def _iterate(
        self, start: Start, k: Array, change: Solve, largest: float, rate: float
    ) -> tuple[Array, tuple[float, float]]:
        """Solved k, the part of the error that the last iteration left, and the contraction."""
        previous, contraction = np.inf, 0.0
        if self.is_controlled:  # less certain than in the last step
            rate = float(np.sqrt(rate))
        limit = max_iterations(len(k)) if self.is_controlled else MAX_FIXED_ITERATIONS
        for iteration in range(limit):
            with _failures_reported():
                step = change(self._residual(start, k))
            k = k + step
            size = self._size(start, k, step)
            last_rate = rate
            if iteration:
                rate = size / previous
                contraction = rate if iteration == 1 else float(np.sqrt(rate * last_rate))
            if self.is_controlled:
                is_solved = size == 0 or (rate < 1 and size * rate < SHARE * (1 - rate))
            else:
                is_solved = _is_rounding(size, previous, abs(start.h) * largest)
            if is_solved:
                # with fixed steps the change is a rounding error, which only limits the rate
                rate = min(rate, 1.0 if self.is_controlled else last_rate)
                return k, (rate, contraction)
            if not np.isfinite(size) or (iteration and rate >= 1):
                break
            previous = size
        raise UnsolvedError(f"stages at t = {start.t}, h = {start.h} still change by {size:.1e}")

    def _size(self, start: Start, k: Array, change: Array) -> float:
        """The change of k relative to the tolerances, or to the state and its increments."""
        if not self.is_controlled:
            return _relative(start, k, change)
        allowed = np.maximum(self._atol + self._rtol * np.abs(start.y), 1e-75)
        return float(np.sqrt(np.mean((start.h * change / allowed) ** 2)))

    def _iterate_fully(self, start: Start, k: Array) -> Array:
        """Solved k, with a Jacobian for each stage."""
        previous = np.inf
        for _ in range(MAX_FULL_ITERATIONS):
            with _failures_reported():
                matrix, steepest = self._full_matrix(start, k)
                right = self._residual(start, k).ravel()
                change = np.linalg.solve(matrix, right)
            k = k + change.reshape(k.shape)
            size = _relative(start, k, change)
            if _is_rounding(size, previous, steepest):
                return k
            if not size < previous:
                break
            previous = size
        raise UnsolvedError(f"stages at t = {start.t}, h = {start.h} still change by {size:.1e}")

    def _full_matrix(self, start: Start, k: Array) -> tuple[Array, float]:
        """Derivatives of all stage equations by k, and the largest element of h J."""
        times, states = (start.t + self.c * start.h).tolist(), self._states(start, k)
        slopes = [start.h * self._jacobian(t, y) for t, y in zip(times, states, strict=True)]
        self.njev += len(slopes)
        rows = [np.kron(a, J) for a, J in zip(self.A[:, np.newaxis], slopes, strict=True)]
        return np.eye(k.size) - np.vstack(rows), float(np.abs(slopes).max())

    def _extrapolated(self, begin: float, ratio: float, c: Array, k: Array) -> Array:
        """Derivatives at the nodes of a step of `ratio` times the size.

        They are those of the polynomial with the derivatives k at the nodes c of another step.
        """
        return np.asarray(lagrange(c, begin + ratio * self.c) @ k)

    def _continue(self, start: Start, derivative: Array) -> Array:
        """Follow the solution from that of a short step to that of the whole step.

        Each part of the step gives the first guess for a longer part.
        """
        k, part, advance = np.tile(derivative, (len(self.c), 1)), 0.0, 0.5
        while advance >= SHORTEST_PART:
            aim = min(part + advance, 1.0)
            guess = k
            if part and self._has_polynomial:
                guess = self._extrapolated(0.0, aim / part, self.c, k)
            try:
                k = self._iterate_fully(Start(start.t, start.y, aim * start.h), guess)
            except UnsolvedError:
                advance /= 2
                continue
            if aim == 1.0:
                return k
            part, advance = aim, 2 * advance
        raise UnsolvedError(
            f"stages at t = {start.t}, h = {start.h}: no solution beyond h = {part * start.h}"
        )


@contextmanager
def _failures_reported() -> Iterator[None]:
    """Turn errors of a right-hand side and singular matrices into `UnsolvedError`."""
    try:
        yield
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        raise UnsolvedError(str(error)) from error


def _relative(start: Start, k: Array, change: NDArray[np.floating]) -> float:
    """Largest change relative to the state and its increments."""
    scale = np.abs(start.y).max() + np.abs(start.h * k).max() + TINY
    return float(np.abs(start.h * change).max() / scale)


def _is_rounding(change: float, previous: float, steepest: float) -> bool:
    """Whether changes no longer decrease since rounding errors times a Jacobian prevent it."""
    return change <= CLOSE or (change < CLOSE * (100 + steepest) and change >= previous / 2)
