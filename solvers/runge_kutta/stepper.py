"""One step of any Runge–Kutta method, explicit or implicit.

States between steps are those of a shorter step from the same start: they have the method's own
order and need no further coefficients.
"""

from collections.abc import Callable
from functools import cached_property
from math import isfinite
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solvers.io.suggestion import shortened
from solvers.runge_kutta.collocation import lagrange
from solvers.runge_kutta.continuous_extension import ContinuousExtension
from solvers.runge_kutta.newton_stages import Newton, NewtonStages, Start, UnsolvedError
from solvers.runge_kutta.parallel_stages import NoFixedPointError, ParallelStages, Polynomial
from solvers.runge_kutta.tableau import Splitting, Tableau

Array = NDArray[np.float64]
Rhs = Callable[[float, Array], Array]


class NotFiniteError(ArithmeticError):
    """A stage was not finite."""


class NoConvergenceError(ArithmeticError):
    """The stage equations of an implicit method were not solved."""


class StepResult(NamedTuple):
    """A step: the state at its end, and what its stages tell.

    Estimates of the local error are of shape (estimates, state): one row of zeros for a method
    without any; of parallel stages the norm itself, relative to the tolerances. The derivative at
    the end is known if the last stage is the first of the next step.
    """

    y: Array
    error: Array
    derivative: Array | None = None
    polynomial: Polynomial | None = None  # of a method with parallel stages
    contraction: float = 0.0  # of its iteration
    stages: NewtonStages | None = None  # of a method that solves them by Newton's iteration
    k: Array | None = None  # derivatives at the stages of another method

    @property
    def last(self) -> Polynomial | NewtonStages | None:
        """The part that the next step starts from."""
        return self.polynomial or self.stages


def evaluated(what: str, function: Rhs, t: float, y: Array, shape: tuple[int, ...]) -> Array:
    """The value of a function of time and state, which must be real numbers of this shape."""
    value = function(t, y)
    try:
        array = np.asarray(value)
    except ValueError:  # parts of different lengths
        array = np.empty(0)
    if array.shape != shape or array.dtype.kind not in "biuf":
        raise ValueError(
            f"the {what} at t = {t}, y = {y} is {shortened(value)}: it must return real numbers of "
            f"shape {shape}"
        )
    return array.astype(float)


class Stepper:
    """Steps of one method for one right-hand side; `nfev` and `njev` count the evaluations.

    Newton's method needs ``jacobian(t, y)``, state × state; stages of implicit methods are solved
    to the tolerances of the step, by default to rounding errors.
    """

    def __init__(
        self,
        tableau: Tableau,
        rhs: Rhs,
        jacobian: Rhs | None = None,
        rtol: float = 0.0,
        atol: float | Array = 0.0,
    ) -> None:
        self._A = np.array(tableau.A, dtype=float)
        self._b, self._c = np.array(tableau.b, dtype=float), np.array(tableau.c, dtype=float)
        self._error_weights = np.array(tableau.error_weights, dtype=float)
        self._tableau, self._rhs, self._jacobian = tableau, rhs, jacobian
        self._newton = None
        if tableau.needs_jacobian:
            self._newton = Newton(tableau, self.derivative, self._slopes, rtol, atol)
            self._at_start = lagrange(self._c, np.zeros(1))[0]
        self._drifts = np.empty(0)
        if isinstance(tableau, Splitting):
            self._drifts = np.array(tableau.drifts, dtype=float)
        self._parallel_stages = None
        if tableau.is_parallel:
            self._parallel_stages = ParallelStages(tableau, rtol, atol)
        self.nfev = 0

    @property
    def njev(self) -> int:
        """Evaluations of the Jacobian."""
        return self._newton.njev if self._newton else 0

    @cached_property
    def extension(self) -> ContinuousExtension:
        """The continuous extension of its steps."""
        return ContinuousExtension.of(self._tableau)

    def _slopes(self, t: float, y: Array) -> Array:
        assert self._jacobian is not None
        return evaluated("Jacobian", self._jacobian, t, y, (len(y), len(y)))

    def derivative(self, t: float, y: Array) -> Array:
        """The right-hand side, counted and checked to be finite."""
        self.nfev += 1
        if not all(map(isfinite, y.tolist())):
            raise NotFiniteError(f"the state at t = {t} is {y}")
        try:
            value = evaluated("right-hand side", self._rhs, t, y, y.shape)
        except ArithmeticError as error:
            raise NotFiniteError(f"the right-hand side at t = {t}, y = {y}: {error}") from error
        if not all(map(isfinite, value.tolist())):
            raise NotFiniteError(f"the right-hand side at t = {t}, y = {y} is {value}")
        return value

    def step(
        self,
        t: float,
        y: Array,
        h: float,
        first: Array,
        last: Polynomial | NewtonStages | None = None,
    ) -> StepResult:
        """The step of size `h` from the state `y`.

        `first` is the derivative at the start, `last` the polynomial or the stages of the last step
        if there was one, or the polynomial of a longer step from the same start. An explicit stage
        raises `NotFiniteError`, implicit ones `NoConvergenceError`.
        """
        if self._parallel_stages:
            assert not isinstance(last, NewtonStages)
            return self._parallel(self._parallel_stages, t, y, h, first, last)
        if self._newton:
            assert not isinstance(last, Polynomial)
            return self._implicit(self._newton, Start(t, y, h), first, last)
        if self._tableau.is_splitting:
            return self._kicks_and_drifts(t, y, h, first)
        k = self._explicit(t, y, h, first)
        end = y + h * (self._b @ k)
        error = h * (self._error_weights @ k) if self._tableau.b_hat else np.zeros((1, len(y)))
        return StepResult(end, error, k[-1] if self._tableau.is_fsal else None, k=k)

    def _parallel(
        self,
        stages: ParallelStages,
        t: float,
        y: Array,
        h: float,
        first: Array,
        last: Polynomial | None,
    ) -> StepResult:
        times = (t + stages.c * h).tolist()

        def derivatives(states: Array) -> Array:
            return np.array(list(map(self.derivative, times, states)))

        last = last or Polynomial.constant(h, first, len(stages.c))
        try:
            solved = stages.solve(derivatives, y, h, last)
        except (NotFiniteError, NoFixedPointError) as error:
            raise NoConvergenceError(f"stages at t = {t}, h = {h}: {error}") from error
        coefficients = stages.legendre @ solved.increments
        end = y + coefficients[0]
        norm = np.array([[solved.error_norm]])
        return StepResult(end, norm, None, Polynomial(h, coefficients), solved.contraction)

    def _explicit(self, t: float, y: Array, h: float, first: Array) -> Array:
        k = np.empty((len(self._b), len(y)))
        k[0] = first
        for i in range(1, len(self._b)):
            k[i] = self.derivative(t + self._c[i] * h, y + h * (self._A[i, :i] @ k[:i]))
        return k

    def _kicks_and_drifts(self, t: float, y: Array, h: float, first: Array) -> StepResult:
        """The step of a splitting, of which stages are states before kicks."""
        n, b, d = len(y) // 2, self._b, self._drifts
        k, (q, v) = np.empty((len(b), len(y))), (y[:n], y[n:])
        k[0] = first
        for i in range(1, len(b)):
            velocity = v + h * (b[:i] @ k[:i, n:])
            position = q + h * (d[:i] @ k[:i, :n] + d[i] * velocity)
            k[i] = self.derivative(t + self._c[i] * h, np.concatenate([position, velocity]))
        end = y + h * np.concatenate([d @ k[:, :n], b @ k[:, n:]])
        # positions do not change after the last stage
        return StepResult(end, np.zeros((1, len(y))), np.concatenate([end[n:], k[-1, n:]]), k=k)

    def _implicit(
        self, newton: Newton, start: Start, first: Array, last: NewtonStages | None
    ) -> StepResult:
        last = last or NewtonStages.constant(start.t, start.y, start.h, first, newton.c)
        try:
            stages = newton.solve(start, first, last)
        except UnsolvedError as failure:
            raise NoConvergenceError(str(failure)) from failure
        end = start.y + start.h * (self._b @ stages.k)
        error = np.zeros((1, len(end)))
        if self._tableau.is_radau and newton.is_controlled:
            error[0] = self._defect(newton, start, first, stages)
        return StepResult(end, error, contraction=stages.contraction, stages=stages)

    def _defect(self, newton: Newton, start: Start, first: Array, stages: NewtonStages) -> Array:
        """The error, by the difference of the polynomial's derivative at the start from `first`.

        The embedded solution that uses `first`, too, differs by h g (first - p'(0)), where g is the
        real eigenvalue of A. The filter (I - h g J)⁻¹ keeps it bounded for stiff equations, a
        second one makes it small (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II,
        section IV.8; Journal of Computational and Applied Mathematics 111 (1999) 93-111).
        """
        weight, at_start = start.h * newton.blocks.M[0, 0], self._at_start @ stages.k
        filtered = newton.filter(stages)
        error = filtered(weight * (first - at_start))
        try:
            derivative = self.derivative(start.t, start.y + error)
        except NotFiniteError:
            return error
        return filtered(weight * (derivative - at_start))
