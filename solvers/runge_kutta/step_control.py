"""How long the next step is: proportional and integral control of the local error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rhs = Callable[[float, Array], Array]

#: Part of the ideal step that is tried, and limits to its change (E. Hairer, S. P. Nørsett,
#: G. Wanner, Solving Ordinary Differential Equations I, section II.4).
SAFETY, SHRINK, GROW = 0.9, 0.2, 5.0


@dataclass
class Controller:
    """Step sizes from error norms; 1 is what the tolerances allow.

    Parameters
    ----------
    order : int
        Order of the error estimate.
    rtol, atol : float or ndarray
        The error of a component may be atol + rtol |y|.
    """

    order: int
    rtol: float
    atol: float | Array
    _previous: float = 1.0

    def norm(self, error: Array, y: Array, end: Array) -> float:
        """Root mean square of the error in parts of what is allowed.

        Of two estimates the first a and the second b combine to a²/√(a² + b²/100) (E. Hairer,
        S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, section II.10).

        Parameters
        ----------
        error : ndarray of shape (state,) or (estimates, state)
            Of the step, in the units of the state.
        y, end : ndarray of shape (state,)
            The state before and after it.

        Returns
        -------
        float
            A step with more than 1 is not kept.
        """
        allowed = self.atol + self.rtol * np.maximum(np.abs(y), np.abs(end))
        a, *others = (_rms(estimate, allowed) for estimate in np.atleast_2d(error))
        return a * a / hypot(a, others[0] / 10) if others and a else a

    def factor(self, norm: float) -> float:
        """By what the step changes, after one whose error has this norm.

        PI control (K. Gustafsson, ACM Transactions on Mathematical Software 17
        (1991) 533-554) after a step that is kept, the plain rule after one that is not.

        Parameters
        ----------
        norm : float
            As `norm` gives it.

        Returns
        -------
        float
            From `SHRINK` to `GROW`, and below 1 after a step that is not kept.
        """
        k = self.order + 1
        if norm > 1:
            return max(SHRINK, SAFETY * norm ** (-1 / k))
        floor = hypot(norm, 1e-10)
        factor = SAFETY * floor ** (-0.7 / k) * self._previous ** (0.4 / k)
        self._previous = floor
        return min(GROW, max(SHRINK, factor))

    def first_step(self, rhs: Rhs, t: float, y: Array, slope: Array, duration: float) -> float:
        """A step to begin with, from how the slope changes over a very short one.

        E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I,
        section II.4.

        Parameters
        ----------
        rhs : callable
            ``rhs(t, y)``.
        t, y, slope : float and ndarray
            Time in s, state and slope at the beginning.
        duration : float
            Of the whole run in s, negative backwards.

        Returns
        -------
        float
            In s, positive in both directions.
        """
        allowed = self.atol + self.rtol * np.abs(y)
        size, speed = _rms(y, allowed), _rms(slope, allowed)
        h = 0.01 * size / speed if size > 1e-5 and 1e-5 < speed < np.inf else 1e-6
        h = min(h, abs(duration))
        ahead = float(np.copysign(h, duration))
        try:
            change = rhs(t + ahead, y + ahead * slope) - slope
        except ArithmeticError:
            return h
        bend = max(speed, _rms(change, allowed) / h)
        longer = (0.01 / max(bend, 1e-15)) ** (1 / (self.order + 1))
        return min(100 * h, longer, abs(duration))


def _rms(values: Array, allowed: Array) -> float:
    """Root mean square of values in parts of what is allowed; a value of 0 always is."""
    with np.errstate(over="ignore"):  # infinity tells that it is too large
        parts = np.divide(values, allowed, out=np.zeros_like(values), where=values != 0)
        return float(np.sqrt(np.mean(parts**2)))
