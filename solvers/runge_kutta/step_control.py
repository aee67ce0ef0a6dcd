"""Step size control, proportional-integral or predictive, and the choice of the order.

A method of higher order has more stages, and its iteration converges in shorter steps only. Where
the iteration contracts fast, steps of a higher order are worth their stages; where it contracts
slowly or not at all, a lower order takes longer steps (E. Hairer, G. Wanner, Journal of
Computational and Applied Mathematics 111 (1999) 93-111). Other than there, the first step has the
highest order: smooth solutions would take many short steps before it is reached.
"""

from dataclasses import dataclass
from math import hypot

import numpy as np

from solvers.runge_kutta.parallel_stages import SMALLEST, rough_exp2, rough_log2
from solvers.runge_kutta.stepper import Array, Rhs
from solvers.runge_kutta.tableau import Tableau

#: A contraction up to which the order rises, and from which on it falls.
FAST, SLOW = 0.002, 0.8
#: The order rises where the factor of the step size is between these.
STEADY = 0.8, 1.2


@dataclass
class OrderChoice:
    """The choice of one of `count` methods, of decreasing order, for each step."""

    count: int
    index: int = 0  # of the next step's method
    last: int = 0  # of the last step's method
    _contraction: float = 0.0

    def lower(self) -> None:
        """Choose a lower order, as after a step that failed."""
        self.index = min(self.index + 1, self.count - 1)

    def advance(self, contraction: float, factor: float) -> None:
        """Choose the order after a step of this contraction; `factor` changes the step size.

        In each following step a contraction counts by half: after a slow one the order does not
        rise for nine steps.
        """
        self.last = self.index
        self._contraction = max(contraction, self._contraction / 2)
        if self._contraction >= SLOW:
            self.lower()
        elif self._contraction <= FAST and STEADY[0] < factor < STEADY[1]:
            self.index = max(self.index - 1, 0)


#: Fraction of the ideal step that is attempted, and limits to its change (E. Hairer,
#: S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, section II.4).
SAFETY, SHRINK, GROW = 0.9, 0.2, 5.0
#: The same for parallel stages, whose error decreases with a high power of the step size; and the
#: slowest contraction of their iteration that is efficient.
SAFETY_PARALLEL, GROW_PARALLEL, CONTRACTION = 0.82, 2.0, 0.4
TINY = np.finfo(float).tiny
#: The same for Radau methods: a step size that would grow by less stays, and errors below this part
#: of the tolerance do not make the prediction more optimistic.
LEAST_GROWTH, LEAST_ERROR = 1.2, 1e-2
#: The tolerance of their error estimate is this, times the power of the tolerance.
ESTIMATE_SHARE = 0.01


def tolerance_power(stages: int) -> float:
    """The power of the tolerance by which that of the error estimate of a Radau method is larger.

    The estimate decreases with the power s + 1 of h, the error with 2s (E. Hairer, G. Wanner,
    Journal of Computational and Applied Mathematics 111 (1999) 93-111, section 6).
    """
    return (stages + 1) / (2 * stages) - 1


@dataclass
class Controller:
    """Step sizes from error norms; the error of a component may be atol + rtol * abs(y)."""

    order: int  # of the error estimate
    rtol: float
    atol: float | Array
    _previous: float = 1.0

    @classmethod
    def of(cls, tableau: Tableau, rtol: float, atol: float | Array) -> "Controller":
        """The controller of a method."""
        if tableau.is_parallel:
            return ParallelController(tableau.order, rtol, atol)
        if tableau.is_radau:
            return RadauController(tableau.stages, rtol, atol)
        return cls(tableau.error_order, rtol, atol)

    def norm(self, error: Array, y: Array, end: Array) -> float:
        """Root mean square of the error relative to the tolerances; at most 1 is accepted.

        Two estimates a and b combine to a²/√(a² + b²/100) (E. Hairer, S. P. Nørsett, G. Wanner,
        Solving Ordinary Differential Equations I, section II.10).
        """
        allowed = self.atol + self.rtol * np.maximum(np.abs(y), np.abs(end))
        a, *others = (_rms(estimate, allowed) for estimate in np.atleast_2d(error))
        return a * a / hypot(a, others[0] / 10) if others and a else a

    def factor(self, norm: float, h: float = 0.0, contraction: float = 0.0) -> float:
        """The factor of the step size after a step with this error norm, from `SHRINK` to `GROW`.

        PI control (K. Gustafsson, ACM Transactions on Mathematical Software 17 (1991) 533-554)
        after an accepted step, the plain rule after a rejected one.
        """
        k = self.order + 1
        if norm > 1:
            return max(SHRINK, SAFETY * norm ** (-1 / k))
        floor = hypot(norm, 1e-10)
        factor = SAFETY * floor ** (-0.7 / k) * self._previous ** (0.4 / k)
        self._previous = floor
        return min(GROW, max(SHRINK, factor))

    def forget(self) -> None:
        """Forget the last step, since another method made it."""
        self._previous = 1.0

    def initial_step(
        self, rhs: Rhs, t: float, y: Array, derivative: Array, duration: float
    ) -> float:
        """The first step size, positive, from the change of the derivative over a very short step.

        As in the book above, section II.4.
        """
        allowed = self.atol + self.rtol * np.abs(y)
        d0, d1 = _rms(y, allowed), _rms(derivative, allowed)
        h0 = 0.01 * d0 / d1 if d0 > 1e-5 and 1e-5 < d1 < np.inf else 1e-6
        h0 = min(h0, abs(duration))
        signed = float(np.copysign(h0, duration))
        try:
            change = rhs(t + signed, y + signed * derivative) - derivative
        except ArithmeticError:
            return h0
        d2 = max(d1, _rms(change, allowed) / h0)
        h1 = (0.01 / max(d2, 1e-15)) ** (1 / (self.order + 1))
        return min(100 * h0, h1, abs(duration))


@dataclass
class ParallelController(Controller):
    """Step sizes of methods with parallel stages, whose error shows in their polynomial."""

    _last_h: float = 0.0
    _previous_error: float = 0.0
    _after_rejection: bool = False

    def norm(self, error: Array, y: Array, end: Array) -> float:
        """The norm, which is known since it decides whether stages are iterated to the end."""
        return float(error[0, 0])

    def factor(self, norm: float, h: float = 0.0, contraction: float = 0.0) -> float:
        """The factor of the step size h, from `SHRINK` to `GROW_PARALLEL`.

        Predictive control (K. Gustafsson, ACM Transactions on Mathematical Software 20 (1994)
        496-517) after accepted steps, the plain rule after a rejected one, and no growth after the
        next. The iteration should contract by `CONTRACTION`, too.
        """
        share, error = 1 / (self.order + 1), rough_log2(norm**2 + SMALLEST) / 2
        is_accepted, after_rejection = norm <= 1, self._after_rejection
        exponent = -share * error
        if is_accepted:
            trend = rough_log2(h / (self._last_h or h)) + share * (self._previous_error - error)
            exponent += 0.0 if after_rejection else min(trend, 0.0)
            self._previous_error, self._last_h = error, h
        self._after_rejection = not is_accepted
        slow = rough_exp2(-rough_log2(contraction**2 + SMALLEST) / 2)
        factor = min(SAFETY_PARALLEL * rough_exp2(exponent), CONTRACTION * slow)
        return max(SHRINK, min(factor, 1.0 if is_accepted and after_rejection else GROW_PARALLEL))


@dataclass
class RadauController(Controller):
    """Step sizes of Radau methods, by an error estimate whose order is the number of stages."""

    _last_h: float = 0.0

    def norm(self, error: Array, y: Array, end: Array) -> float:
        """Root mean square of the error relative to relaxed tolerances, see `tolerance_power`."""
        largest = self.rtol if self.rtol > 0 else min(float(np.min(self.atol)), 1.0)
        allowed = np.maximum(self.atol + self.rtol * np.maximum(np.abs(y), np.abs(end)), 1e-75)
        return _rms(error[0], ESTIMATE_SHARE * largest ** tolerance_power(self.order) * allowed)

    def forget(self) -> None:
        """Forget the last step, since another method made it."""
        self._previous, self._last_h = 1.0, 0.0

    def factor(self, norm: float, h: float = 0.0, contraction: float = 0.0) -> float:
        """The factor of the step size, from `SHRINK` to `GROW`, 1 instead of a small growth.

        Predictive control (K. Gustafsson, ACM Transactions on Mathematical Software 20 (1994)
        496-517) after an accepted step, the plain rule after a rejected one.
        """
        k, floor = self.order + 1, max(norm, 1e-37)
        factor = floor ** (-1 / k)
        if norm <= 1:
            if self._last_h:
                factor *= min(h / self._last_h * (self._previous / floor) ** (1 / k), 1.0)
            self._previous, self._last_h = max(norm, LEAST_ERROR), h
        factor = min(GROW, max(SHRINK, SAFETY * factor))
        return 1.0 if norm <= 1 < factor < LEAST_GROWTH else factor


def _rms(values: Array, allowed: Array) -> float:
    """Root mean square of values / allowed; a value of 0 counts as 0 whatever is allowed."""
    with np.errstate(over="ignore"):  # infinity means that it is too large
        ratios = np.divide(values, allowed, out=np.zeros_like(values), where=values != 0)
        return float(np.sqrt(np.mean(ratios**2)))
