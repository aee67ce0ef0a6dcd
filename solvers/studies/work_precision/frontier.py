"""The cheapest way to each accuracy, and what each choice is worth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite

from solvers.studies.work_precision.curve import Curve

#: Global errors that are asked for.
ERRORS = tuple(10.0**-k for k in range(1, 14))


@dataclass(frozen=True)
class Best:
    """The cheapest combination for an error.

    Attributes
    ----------
    scene : str
        Where.
    global_error : float
        What was asked for.
    work : {"work_seconds", "work_rhs"}
        What is cheap.
    method, form, backend : str
        The combination.
    work_seconds, work_rhs : float
        What it costs, between measured runs.
    worth : dict of dict
        For each choice (method, form, backend) and each other value of it: how many times
        as much the best combination with that value costs.
    """

    scene: str
    global_error: float
    work: str
    method: str
    form: str
    backend: str
    work_seconds: float
    work_rhs: float
    worth: dict[str, dict[str, float]]


def frontier(curves: Sequence[Curve], work: str = "work_seconds") -> list[Best]:
    """The cheapest combination for each error that some combination reaches.

    Parameters
    ----------
    curves : sequence of Curve
        Of one scene.
    work : {"work_seconds", "work_rhs"}
        What is to be cheap: time in s, or calls of the right-hand side.

    Returns
    -------
    list of Best
        One for each of `ERRORS` that is reached, the largest first.
    """
    found = []
    for error in ERRORS:
        costs = [(cost, curve) for curve in curves if isfinite(cost := curve.at(error, work))]
        if not costs:
            continue
        least, best = min(costs, key=lambda pair: pair[0])
        worth = {}
        for choice in ("method", "form", "backend"):
            cheapest: dict[str, float] = {}
            for cost, curve in costs:
                value = getattr(curve, choice)
                cheapest[value] = min(cheapest.get(value, inf), cost)
            worth[choice] = {
                value: cost / least
                for value, cost in sorted(cheapest.items(), key=lambda pair: pair[1])
                if value != getattr(best, choice)
            }
        found.append(Best(
            best.scene, error, work, best.method, best.form, best.backend,
            best.at(error, "work_seconds"), best.at(error, "work_rhs"), worth,
        ))  # fmt: skip
    return found
