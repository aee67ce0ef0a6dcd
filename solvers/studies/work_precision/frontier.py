"""The cheapest combination for each accuracy, and the cost of the alternatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite

from solvers.studies.work_precision.curve import Curve

#: Requested global errors.
ERRORS = tuple(10.0**-k for k in range(1, 14))


@dataclass(frozen=True)
class FrontierPoint:
    """The cheapest combination for an error.

    Attributes
    ----------
    scene : str
        Name of the scene.
    global_error : float
        The requested error.
    work : {"work_seconds", "work_rhs"}
        The cost that is minimised.
    method, form, backend : str
        The combination.
    work_seconds, work_rhs : float
        Its costs, interpolated between runs.
    cost_ratios : dict of dict
        For ``"method"``, ``"form"`` and ``"backend"``, and each other value of it: the cost of the
        best combination with that value relative to this one.
    """

    scene: str
    global_error: float
    work: str
    method: str
    form: str
    backend: str
    work_seconds: float
    work_rhs: float
    cost_ratios: dict[str, dict[str, float]]


def frontier(curves: Sequence[Curve], work: str = "work_seconds") -> list[FrontierPoint]:
    """The cheapest combination for each error that some combination reaches.

    Parameters
    ----------
    curves : sequence of Curve
        Curves of one scene.
    work : {"work_seconds", "work_rhs"}
        The cost to minimise: time in s, or evaluations of the right-hand side.

    Returns
    -------
    list of FrontierPoint
        One for each of `ERRORS` that is reached, the largest first.
    """
    results = []
    for error in ERRORS:
        costs = [(cost, curve) for curve in curves if isfinite(cost := curve.at(error, work))]
        if not costs:
            continue
        _, best = min(costs, key=lambda pair: pair[0])
        ratios = {name: _ratios(costs, name, best) for name in ("method", "form", "backend")}
        works = best.at(error, "work_seconds"), best.at(error, "work_rhs")
        results.append(FrontierPoint(best.scene, error, work, *best.combination, *works, ratios))
    return results


def _ratios(costs: Sequence[tuple[float, Curve]], name: str, best: Curve) -> dict[str, float]:
    """Cost of the best combination with each other value of an attribute, over the least cost."""
    cheapest: dict[str, float] = {}
    for cost, curve in costs:
        value = getattr(curve, name)
        cheapest[value] = min(cheapest.get(value, inf), cost)
    least = min(cheapest.values())
    ordered = sorted(cheapest.items(), key=lambda pair: pair[1])
    return {value: cost / least for value, cost in ordered if value != getattr(best, name)}
