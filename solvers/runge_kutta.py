"""Explicit Runge–Kutta methods with a fixed step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

Rhs = Callable[[float, list[float]], Sequence[float]]


@dataclass(frozen=True)
class Tableau:
    """Coefficients of an explicit method: stage rows below the diagonal, and weights."""

    A: tuple[tuple[Fraction, ...], ...]
    b: tuple[Fraction, ...]

    @property
    def c(self) -> tuple[Fraction, ...]:
        """Nodes, the row sums of A."""
        return tuple(sum(row, Fraction(0)) for row in self.A)


def _tableau(rows: str, weights: str) -> Tableau:
    return Tableau(
        tuple(tuple(map(Fraction, row.split())) for row in rows.split(";")),
        tuple(map(Fraction, weights.split())),
    )


#: RK1 to RK4: Euler; midpoint; Kutta's third-order rule; the classical rule, which is the
#: report's (20) to (25).
METHODS = {
    "RK1": _tableau("", "1"),
    "RK2": _tableau("; 1/2", "0 1"),
    "RK3": _tableau("; 1/2; -1 2", "1/6 2/3 1/6"),
    "RK4": _tableau("; 1/2; 0 1/2; 0 0 1", "1/6 1/3 1/3 1/6"),
}


def fixed_step(
    rhs: Rhs, y0: Sequence[float], h: float, steps: int, method: Tableau
) -> NDArray[np.float64]:
    """States at t = 0, h, 2h, …, of shape (len(y0), steps + 1).

    Parameters
    ----------
    rhs : callable
        ``rhs(t, y)``, the derivative of a state, as a sequence of floats.
    y0 : sequence of float
        State at t = 0.
    h : float
        Step in s.
    steps : int
        How many steps to take.
    method : Tableau
        The method.
    """
    rows = [[float(a) for a in row] for row in method.A]
    weights, nodes = [float(b) for b in method.b], [float(c) for c in method.c]
    states = np.empty((len(y0), steps + 1))
    states[:, 0] = y = [float(value) for value in y0]
    for n in range(steps):
        slopes: list[Sequence[float]] = []
        for row, node in zip(rows, nodes, strict=True):
            slopes.append(rhs((n + node) * h, _moved(y, h, row, slopes)))
        y = _moved(y, h, weights, slopes)
        states[:, n + 1] = y
    return states


def _moved(
    y: list[float], h: float, weights: Sequence[float], slopes: Sequence[Sequence[float]]
) -> list[float]:
    """Y + h Σ weight slope."""
    return [
        value + h * sum(w * slope[i] for w, slope in zip(weights, slopes, strict=True))
        for i, value in enumerate(y)
    ]
