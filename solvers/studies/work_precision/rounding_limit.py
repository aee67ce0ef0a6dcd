"""The step below which rounding makes shorter steps worse."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan

import numpy as np

from solvers.integration.timing import least_pair
from solvers.runge_kutta.catalogue import load
from solvers.studies.work_precision.curve import Curve, select
from solvers.studies.work_precision.measurement import REPORT_METHODS

#: Largest difference between an observed order and the method's order.
CLOSE = 0.5


@dataclass(frozen=True)
class RoundingLimit:
    """The step at which the error of a method is least.

    Attributes
    ----------
    method : str
        Name of the method.
    h, global_error : float
        A step in s and its error: of the two neighbouring steps whose larger error is least,
        the shorter one, so that a single lucky run does not count.
    finest, finest_error : float
        The shortest step with a result, in s, and its error.
    order : float
        Observed order for longer steps; NaN where errors do not yet fall as the order predicts.
    """

    method: str
    h: float
    global_error: float
    finest: float
    finest_error: float
    order: float

    def __str__(self) -> str:
        if not isfinite(self.order):
            return f"{self.method}: no observed order, least error {self.global_error:.1e}"
        text = f"{self.method}: error falls as h^{self.order:.2f} to {self.global_error:.1e}"
        if self.finest_error < 2 * self.global_error:
            return f"{text} at the shortest step, {self.finest:.1e} s"
        rounding = f"{self.finest_error:.1e} at {self.finest:.1e} s"
        return f"{text} at h = {self.h:.1e} s; by rounding it is {rounding}"


def rounding_limits(curves: Sequence[Curve]) -> list[RoundingLimit]:
    """Limits of the report's methods, compiled, in Lagrange's form.

    Parameters
    ----------
    curves : sequence of Curve
        Curves of one scene; those of other combinations are left out.

    Returns
    -------
    list of RoundingLimit
        For each method that has a curve, from RK1 to RK4.
    """
    combinations = ((method, "lagrangian", "compiled") for method in REPORT_METHODS.values())
    return [_rounding_limit(curve) for curve in select(curves, *combinations)]


def _rounding_limit(curve: Curve) -> RoundingLimit:
    steps = np.array([p.setting["h"] for p in curve.points])
    errors = np.array([p.global_error for p in curve.points])
    best = least_pair(errors.tolist()) if len(errors) else 0
    # errors that are small and above rounding
    straight = (errors < 1e-2) & (errors > 100 * errors[best])
    order = nan
    if straight.sum() >= 3:
        order = float(np.polyfit(np.log(steps[straight]), np.log(errors[straight]), 1)[0])
    if abs(order - load(curve.method).order) > CLOSE:
        order = nan
    h, least, finest, last = (float(x[k]) for k in (best, -1) for x in (steps, errors))
    return RoundingLimit(curve.method, h, least, finest, last, order)
