"""One step of any Runge–Kutta method, explicit or implicit.

States between steps are those of a shorter step from the same start: they have the method's own
order and need no further coefficients.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solvers.io.suggestion import shortened
from solvers.runge_kutta.parallel_stages import NoFixedPointError, ParallelStages, Polynomial
from solvers.runge_kutta.tableau import Tableau

Array = NDArray[np.float64]
Rhs = Callable[[float, Array], Array]

#: Newton's iteration ends at a relative change below the tolerance, or after so many iterations.
TOLERANCE, MAX_ITERATIONS = 1e-14, 100
#: Numbers that are not much larger have fewer digits than others.
TINY = 1e-290


class NotFiniteError(ArithmeticError):
    """A stage was not finite."""


class NoConvergenceError(ArithmeticError):
    """The stage equations of an implicit method were not solved."""


class Step(NamedTuple):
    """A step: the state at its end, and what its stages tell.

    Estimates of the local error are of shape (estimates, state): one row of zeros for a method
    without any. The derivative at the end is known if the last stage is the first of the next step.
    """

    y: Array
    error: Array
    derivative: Array | None = None
    polynomial: Polynomial | None = None  # of a method with parallel stages
    contraction: float = 0.0  # of its iteration


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

    Newton's method needs ``jacobian(t, y)``, state × state; a fixed-point iteration ends at the
    tolerances of the step, by default at rounding errors.
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
        self._parallel_stages = None
        if tableau.is_parallel:
            self._parallel_stages = ParallelStages(tableau, rtol, atol)
        self.nfev = self.njev = 0

    def derivative(self, t: float, y: Array) -> Array:
        """The right-hand side, counted and checked to be finite."""
        self.nfev += 1
        if not np.isfinite(y).all():
            raise NotFiniteError(f"the state at t = {t} is {y}")
        try:
            value = evaluated("right-hand side", self._rhs, t, y, y.shape)
        except ArithmeticError as error:
            raise NotFiniteError(f"the right-hand side at t = {t}, y = {y}: {error}") from error
        if not np.isfinite(value).all():
            raise NotFiniteError(f"the right-hand side at t = {t}, y = {y} is {value}")
        return value

    def step(
        self, t: float, y: Array, h: float, first: Array, last: Polynomial | None = None
    ) -> Step:
        """The step of size `h` from the state `y`.

        `first` is the derivative at the start, `last` the polynomial of the last step if there was
        one, or of a longer step from the same start. An explicit stage raises `NotFiniteError`,
        implicit ones `NoConvergenceError`.
        """
        if self._parallel_stages:
            return self._parallel(self._parallel_stages, t, y, h, first, last)
        stages = self._explicit if self._tableau.is_explicit else self._implicit
        k = stages(t, y, h, first)
        end = y + h * (self._b @ k)
        error = h * (self._error_weights @ k) if self._tableau.b_hat else np.zeros((1, len(y)))
        return Step(end, error, k[-1] if self._tableau.is_fsal else None)

    def _parallel(
        self,
        stages: ParallelStages,
        t: float,
        y: Array,
        h: float,
        first: Array,
        last: Polynomial | None,
    ) -> Step:
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
        estimate = np.array([coefficients[-1], np.sqrt((coefficients[:3] ** 2).sum(axis=0))])
        return Step(end, estimate, None, Polynomial(h, coefficients), solved.contraction)

    def _explicit(self, t: float, y: Array, h: float, first: Array) -> Array:
        k = np.empty((len(self._b), len(y)))
        k[0] = first
        for i in range(1, len(self._b)):
            k[i] = self.derivative(t + self._c[i] * h, y + h * (self._A[i, :i] @ k[:i]))
        return k

    def _implicit(self, t: float, y: Array, h: float, first: Array) -> Array:
        """Simplified Newton iteration on all stages at once, from the derivative at the start."""
        assert self._jacobian is not None
        stages, n = len(self._b), len(y)
        self.njev += 1
        J = evaluated("Jacobian", self._jacobian, t, y, (n, n))
        matrix = np.eye(stages * n) - h * np.kron(self._A, J)
        k = np.tile(first, (stages, 1))
        times = [t + c * h for c in self._c]
        # rounding errors, multiplied by a large Jacobian, may prevent closer agreement
        rounding = TOLERANCE * (100 + np.abs(h * J).max())
        previous = np.inf
        for _ in range(MAX_ITERATIONS):
            states = y + h * (self._A @ k)
            try:
                derivatives = np.array(list(map(self.derivative, times, states)))
                change = np.linalg.solve(matrix, (derivatives - k).ravel()).reshape(stages, n)
            except (NotFiniteError, np.linalg.LinAlgError) as error:
                raise NoConvergenceError(f"stages at t = {t}, h = {h}: {error}") from error
            k = k + change
            scale = np.abs(y).max() + np.abs(h * k).max() + TINY
            size = float(np.abs(h * change).max() / scale)
            if size <= TOLERANCE or (size < rounding and size >= previous / 2):
                return k
            previous = size
        raise NoConvergenceError(f"stages at t = {t}, h = {h} still change by {size:.1e}")
