"""Explicit Runge–Kutta methods with a fixed step, plain to read."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from solvers.tableau import Tableau

Rhs = Callable[[float, list[float]], Sequence[float]]


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
        An explicit method.
    """
    rows = [[float(a) for a in row[:i]] for i, row in enumerate(method.A)]
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
