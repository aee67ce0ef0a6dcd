"""Stiff scenes: a fast mode that is at rest forces short steps on explicit methods."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.equations.normal_modes import Modes
from solvers.integration.timing import TimedRun, timed_run
from solvers.runge_kutta.catalogue import load

Array = NDArray[np.float64]

#: How many times as fast as the slow mode the fast one is, about.
RATIOS = (3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0)
EXPLICIT, IMPLICIT = ("rk4", "dp54", "verner87"), ("gauss2", "gauss3", "radau2", "radau3")
#: With control, tolerances from loose to tight; else numbers of steps from few to many.
TOLERANCES, STEPS = 10.0 ** -np.arange(1, 9, 0.5), np.ceil(10 * 2 ** np.arange(0, 18, 0.5))
#: Error of the slow coordinate at the end that is asked for, in rad, and duration in s.
WANTED, DURATION = 1e-3, 6.0
#: A scene of one family: parameters and start.
Stiff = tuple[tuple[float, ...], tuple[float, ...]]


@dataclass(frozen=True)
class Cost:
    """The cheapest run of a method that is accurate enough.

    Attributes
    ----------
    family, method : str
        Which scenes, and which method.
    ratio : float
        Frequency of the fast mode over that of the slow one, about rest.
    steps : int
        How many it takes.
    work_rhs : int
        Right-hand sides.
    work_seconds : float
        The time it takes, compiled.
    global_error : float
        In rad.
    """

    family: str
    method: str
    ratio: float
    steps: int
    work_rhs: int
    work_seconds: float
    global_error: float


def short_second_rod(ratio: float) -> Stiff:
    """Double pendulum, l2 = 2 l1/ratio²; at first the short rod hangs as if from a fixed place."""
    return (1.0, 1.0, 1.0, 2.0 / ratio**2, 9.81), (1.0, 1.0, 0.0, 0.0)


def light_first_mass(ratio: float) -> Stiff:
    """Double pendulum, m1 = 2 m2/ratio²: both rods are a string, and m1 a bead on it."""
    return (2.0 / ratio**2, 1.0, 1.0, 1.0, 9.81), (1.0, 1.0, 0.0, 0.0)


def light_second_mass(ratio: float) -> Stiff:
    """Double pendulum, m2 = m1/ratio²: no mode becomes fast."""
    return (1.0, 1.0 / ratio**2, 1.0, 1.0, 9.81), (1.0, 1.0, 0.0, 0.0)


def stiff_spring(ratio: float) -> Stiff:
    """Elastic pendulum, k = ratio² m g/l, stretched by its weight."""
    stiffness = 9.81 * ratio**2
    return (1.0, stiffness, 1.0, 9.81), (1.0 + 9.81 * np.cos(1.0) / stiffness, 1.0, 0.0, 0.0)


def families(double: GeneratedModule, elastic: GeneratedModule) -> dict[str, tuple[
    GeneratedModule, Callable[[float], Stiff], int
]]:  # fmt: skip
    """For each family its module, its scenes and which coordinate is the slow one."""
    return {
        "short second rod": (double, short_second_rod, 0),
        "light first mass": (double, light_first_mass, 0),
        "light second mass": (double, light_second_mass, 0),
        "stiff spring": (elastic, stiff_spring, 1),
    }


def study(
    double: GeneratedModule, elastic: GeneratedModule, ratios: Sequence[float] = RATIOS,
    methods: Sequence[str] = (*EXPLICIT, *IMPLICIT),
) -> list[Cost]:  # fmt: skip
    """The cheapest accurate run of each method on each scene."""
    found = []
    for family, (module, scene, slow) in families(double, elastic).items():
        for ratio in ratios:
            params, start = scene(ratio)
            frequencies = Modes.at_rest(module, params).frequencies
            truth = reference(module, params, start, slow)
            for method in methods:
                cheapest = _cheapest(module, params, start, slow, truth, method)
                if cheapest:
                    run, error = cheapest
                    found.append(Cost(
                        family, method, float(frequencies[-1] / frequencies[0]),
                        run.steps, run.work_rhs, run.work_seconds, error,
                    ))  # fmt: skip
    return found


def reference(
    module: GeneratedModule, params: Sequence[float], start: Sequence[float], slow: int
) -> float:  # fmt: skip
    """The slow coordinate at the end, by an explicit and by an implicit method.

    Parameters
    ----------
    module : module
        A generated module.
    params, start : sequence of float
        In the order of ``module.PARAMETERS`` and ``module.STATE``.
    slow : int
        Which coordinate is the slow one.

    Returns
    -------
    float
        In rad, after `DURATION`.

    Raises
    ------
    AssertionError
        When they differ by more than a hundredth of the error that is asked for, or one of
        them does not reach the end.
    """
    ends = [
        run.end[slow]
        for method, setting in (("verner98", {"rtol": 1e-9}), ("gauss3", {"h": DURATION / 3000}))
        if (run := _run(module, params, start, method, **setting))
    ]
    assert len(ends) == 2
    assert abs(ends[0] - ends[1]) < WANTED / 100, ends
    return float(ends[0])


def crossover(costs: Sequence[Cost], family: str, work: str) -> float:
    """The ratio from which on the best implicit method costs less; NaN if there is none."""
    ratios = sorted({cost.ratio for cost in costs if cost.family == family})
    gains = []
    for ratio in ratios:
        best = {
            kind: min(
                (getattr(cost, work) for cost in costs
                 if (cost.family, cost.ratio) == (family, ratio) and cost.method in kind),
                default=np.inf,
            )
            for kind in (EXPLICIT, IMPLICIT)
        }  # fmt: skip
        gains.append(np.log(best[EXPLICIT] / best[IMPLICIT]))
    k = next((k for k in range(len(gains)) if min(gains[k:]) > 0), 0)
    if k == 0:
        return float("nan")
    return float(np.exp(np.interp(0.0, gains[k - 1 : k + 1], np.log(ratios[k - 1 : k + 1]))))


def _run(
    module: GeneratedModule, params: Sequence[float], start: Sequence[float], method: str,
    **setting: float,
) -> TimedRun | None:  # fmt: skip
    return timed_run(
        module, params, start, DURATION, method=method, form="lagrangian", backend="compiled",
        **setting,
    )  # fmt: skip


def _cheapest(
    module: GeneratedModule, params: Sequence[float], start: Sequence[float], slow: int,
    truth: float, method: str,
) -> tuple[TimedRun, float] | None:  # fmt: skip
    """The first run that is accurate enough, from cheap to dear, and its error."""
    settings = (
        [{"rtol": tol} for tol in TOLERANCES]
        if load(method).b_hat
        else [{"h": DURATION / n} for n in STEPS]
    )
    for setting in settings:
        run = _run(module, params, start, method, **setting)
        if run and abs(run.end[slow] - truth) < WANTED:
            return run, float(abs(run.end[slow] - truth))
    return None
