"""What the curves say of claims: that shorter steps are better, and that energy is a measure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solvers.catalogue import load
from solvers.chart.curve import Curve, Point
from solvers.chart.measurement import REPORT

#: A trajectory with a larger error, in rad and rad/s, is not right in any digit.
WRONG = 0.1
#: An observed order is one if it is so close.
CLOSE = 0.5


@dataclass(frozen=True)
class Turning:
    """Where shorter steps stop to be better.

    Attributes
    ----------
    method : str
        Which.
    h, global_error : float
        The step with the least error, in s, and that error.
    finest, finest_error : float
        The shortest step that was tried, and its error.
    order : float
        By what power of the step errors fall before, observed; NaN where they do not yet
        fall as the method's order says.
    """

    method: str
    h: float
    global_error: float
    finest: float
    finest_error: float
    order: float


def turnings(curves: Sequence[Curve]) -> list[Turning]:
    """For the report's rules, compiled, in Lagrange's form."""
    found = []
    for method in REPORT.values():
        curve = next((c for c in curves if (c.method, c.form, c.backend)
                      == (method, "lagrangian", "compiled")), None)  # fmt: skip
        if curve is None:
            continue
        steps = np.array([p.setting["h"] for p in curve.points])
        errors = np.array([p.global_error for p in curve.points])
        best = int(np.argmin(errors))
        # where the error is small, and not yet rounding
        straight = (errors < 1e-2) & (errors > 100 * errors[best])
        order = np.nan
        if straight.sum() >= 3:
            order = np.polyfit(np.log(steps[straight]), np.log(errors[straight]), 1)[0]
        if abs(order - load(method).order) > CLOSE:
            order = np.nan
        found.append(Turning(method, float(steps[best]), float(errors[best]), float(steps[-1]),
                             float(errors[-1]), float(order)))  # fmt: skip
    return found


@dataclass(frozen=True)
class Misled:
    """The run whose energy promises most, though its trajectory is wrong.

    Attributes
    ----------
    method, form, backend : str
        Which.
    point : Point
        Its figures.
    """

    method: str
    form: str
    backend: str
    point: Point


def misled(curves: Sequence[Curve]) -> Misled | None:
    """Of all runs with a wrong trajectory, the one with the least energy error."""
    wrong = [
        (point.energy_error, n, Misled(curve.method, curve.form, curve.backend, point))
        for n, curve in enumerate(curves)
        for point in curve.points
        if point.global_error > WRONG
    ]
    return min(wrong, key=lambda found: found[:2])[2] if wrong else None
