"""Step size control: proportional-integral control of the local error."""

from dataclasses import dataclass
from math import hypot

import numpy as np

from solvers.runge_kutta.stepper import Array, Rhs

#: Fraction of the ideal step that is attempted, and limits to its change (E. Hairer,
#: S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, section II.4).
SAFETY, SHRINK, GROW = 0.9, 0.2, 5.0


@dataclass
class Controller:
    """Step sizes from error norms; the error of a component may be atol + rtol * abs(y)."""

    order: int  # of the error estimate
    rtol: float
    atol: float | Array
    _previous: float = 1.0

    def norm(self, error: Array, y: Array, end: Array) -> float:
        """Root mean square of the error relative to the tolerances; at most 1 is accepted.

        Two estimates a and b combine to a²/√(a² + b²/100) (E. Hairer, S. P. Nørsett, G. Wanner,
        Solving Ordinary Differential Equations I, section II.10).
        """
        allowed = self.atol + self.rtol * np.maximum(np.abs(y), np.abs(end))
        a, *others = (_rms(estimate, allowed) for estimate in np.atleast_2d(error))
        return a * a / hypot(a, others[0] / 10) if others and a else a

    def factor(self, norm: float) -> float:
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


def _rms(values: Array, allowed: Array) -> float:
    """Root mean square of values / allowed; a value of 0 counts as 0 whatever is allowed."""
    with np.errstate(over="ignore"):  # infinity means that it is too large
        ratios = np.divide(values, allowed, out=np.zeros_like(values), where=values != 0)
        return float(np.sqrt(np.mean(ratios**2)))
