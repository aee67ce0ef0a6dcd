"""Work-precision curves, cost against global error, and the cheapest combinations."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf, isfinite

import numpy as np

from solvers.io.figures import columns

#: Names of a method, a form and a backend.
Combination = tuple[str, str, str]
#: Requested global errors.
ERRORS = tuple(10.0**-k for k in range(1, 14))


@dataclass(frozen=True)
class MeasuredRun:
    """One run."""

    setting: dict[str, float]  # `rtol` for controlled steps, else `h`
    work_seconds: float  # without preparation
    work_rhs: int | None  # evaluations of the right-hand side, where they are known
    global_error: float  # largest component of the final state's error, in rad and rad/s
    energy_error: float  # of the final state, in the unit of `measurement.unit_of_energy`


@dataclass(frozen=True)
class CostCurve:
    """Runs of one combination on one scene, by rising cost."""

    scene: str
    method: str
    form: str
    backend: str
    points: list[MeasuredRun]

    @property
    def combination(self) -> Combination:
        """Method, form and backend."""
        return self.method, self.form, self.backend

    def costs(self, work: str) -> list[list[float]]:
        """Work and global errors of the runs whose work is known."""
        known = [p for p in self.points if getattr(p, work) is not None]
        return columns(known, work, "global_error")

    def at(self, error: float, work: str = "work_seconds") -> float:
        """Work for this global error; NaN beyond the curve."""
        works, errors = self.costs(work)
        return work_at(error, errors, works)


def select(curves: Iterable[CostCurve], *combinations: Combination) -> Iterator[CostCurve]:
    """The curves of these combinations, in the order of the combinations."""
    by_combination = {curve.combination: curve for curve in curves}
    return (by_combination[one] for one in combinations if one in by_combination)


@dataclass(frozen=True)
class FrontierPoint:
    """The cheapest combination for an error.

    `cost_ratios` has an entry for ``"method"``, ``"form"`` and ``"backend"``, and in it for each
    other value: the cost of the best combination with that value relative to this one.
    """

    scene: str
    global_error: float  # the requested error
    work: str  # the cost that is minimised, "work_seconds" or "work_rhs"
    method: str
    form: str
    backend: str
    work_seconds: float  # interpolated between runs
    work_rhs: float
    cost_ratios: dict[str, dict[str, float]]


def frontier(curves: Sequence[CostCurve], work: str = "work_seconds") -> list[FrontierPoint]:
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
        if costs:
            _, best = min(costs, key=lambda pair: pair[0])
            ratios = {name: _ratios(costs, name, best) for name in ("method", "form", "backend")}
            row = error, work, *best.combination, best.at(error), best.at(error, "work_rhs")
            results.append(FrontierPoint(best.scene, *row, ratios))
    return results


def _ratios(
    costs: Sequence[tuple[float, CostCurve]], name: str, best: CostCurve
) -> dict[str, float]:
    """Cost of the best combination with each other value of an attribute, over the least cost."""
    cheapest: dict[str, float] = {}
    for cost, curve in costs:
        value = getattr(curve, name)
        cheapest[value] = min(cheapest.get(value, inf), cost)
    least = min(cheapest.values())
    ordered = sorted(cheapest.items(), key=lambda pair: pair[1])
    return {value: cost / least for value, cost in ordered if value != getattr(best, name)}


def work_at(error: float, errors: Sequence[float], works: Sequence[float]) -> float:
    """The work for an error, interpolated on logarithmic scales; NaN outside of the runs.

    Runs are in the order of increasing work. Each counts with the largest error of it and of all
    runs with more work: a smaller error at less work is a coincidence. Where rounding makes errors
    grow again, the curve ends: with the pair of neighbours whose larger error is least.
    """
    if not errors:
        return float("nan")
    last = least_pair(errors) + 1
    monotonic = np.maximum.accumulate(list(errors[:last])[::-1])
    if not monotonic[0] <= error <= monotonic[-1]:
        return float("nan")
    logarithm = np.interp(np.log(error), np.log(monotonic), np.log(list(works[:last])[::-1]))
    return float(np.exp(logarithm))


def least_pair(errors: Sequence[float]) -> int:
    """The later run of the pair of neighbours whose larger error is least."""
    larger = [max(pair) for pair in pairwise(errors)]
    return len(larger) - int(np.argmin(larger[::-1])) if larger else 0
