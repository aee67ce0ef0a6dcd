"""What the curves say of claims: that shorter steps are better, and that energy is a measure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from solvers.equations.energy import energy_error
from solvers.integration.integrate import integrate
from solvers.integration.predictability import ignore_predictability
from solvers.integration.timing import least_pair
from solvers.runge_kutta.catalogue import load
from solvers.scenes.scene import Scene
from solvers.studies.work_precision.curve import Curve
from solvers.studies.work_precision.frontier import Best, frontier
from solvers.studies.work_precision.measurement import REPORT
from solvers.studies.work_precision.reference import Reference

#: A state with a larger error, in parts of the motion or of 1 rad and 1 rad/s, is wrong.
WRONG = 0.1
#: Energy is kept if it is right to this; so many runs are looked at, at so many times.
KEPT, CANDIDATES, LOOKS = 1e-3, 20, 400
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
        The shorter of the two neighbouring steps of which the worse is best, in s, and its
        error: the curve ends there, and a single lucky run does not count.
    finest, finest_error : float
        The shortest step with a result, in s, and its error.
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
    """For the report's rules, compiled, in Lagrange's form.

    Parameters
    ----------
    curves : sequence of Curve
        Of one scene; other curves are left out.

    Returns
    -------
    list of Turning
        For each rule that has a curve, from RK1 to RK4.
    """
    found = []
    for method in REPORT.values():
        curve = next((c for c in curves if (c.method, c.form, c.backend)
                      == (method, "lagrangian", "compiled")), None)  # fmt: skip
        if curve is None:
            continue
        steps = np.array([p.setting["h"] for p in curve.points])
        errors = np.array([p.global_error for p in curve.points])
        best = least_pair(errors.tolist()) if len(errors) else 0
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
    method, form : str
        Which, compiled.
    setting : dict
        Its step or tolerance.
    energy_error : float
        The largest over the whole run, in parts of the energy at the beginning above rest.
    global_error : float
        Of the state at the end.
    """

    method: str
    form: str
    setting: dict[str, float]
    energy_error: float
    global_error: float


@dataclass(frozen=True)
class Charted:
    """All that a chart of a scene says.

    Attributes
    ----------
    scene : Scene
        Which.
    reference : Reference
        Its end.
    curves : list of Curve
        What was measured.
    frontier, frontier_rhs : list of Best
        The cheapest in seconds and in calls of the right-hand side.
    turnings : list of Turning
        Where shorter steps stop to be better.
    misled : Misled or None
        The run whose energy promises most.
    """

    scene: Scene
    reference: Reference
    curves: list[Curve]
    frontier: list[Best]
    frontier_rhs: list[Best]
    turnings: list[Turning]
    misled: Misled | None

    @classmethod
    def of(cls, scene: Scene, truth: Reference, curves: list[Curve]) -> Charted:
        """What curves say."""
        return cls(
            scene, truth, curves, frontier(curves), frontier(curves, "work_rhs"),
            turnings(curves), misled(curves, scene, truth),
        )  # fmt: skip


def misled(
    curves: Sequence[Curve], scene: Scene, truth: Reference
) -> Misled | None:  # fmt: skip
    """Of runs with a wrong trajectory, the one whose energy is kept best; None if none is kept."""
    wrong = wrong_from(scene, truth)
    candidates = sorted(
        ((point.energy_error, n, curve, point)
         for n, curve in enumerate(curves) if curve.backend == "compiled"
         for point in curve.points if point.global_error > wrong),
        key=lambda found: found[:2],
    )[:CANDIDATES]  # fmt: skip
    found = [
        Misled(curve.method, curve.form, point.setting,
               _along(scene, curve, point.setting), point.global_error)
        for _, _, curve, point in candidates
    ]  # fmt: skip
    best = min(found, key=lambda case: case.energy_error, default=None)
    return best if best and best.energy_error < KEPT else None


def wrong_from(scene: Scene, truth: Reference) -> float:
    """The error from which on a state is not right in any digit that matters."""
    size = max(map(abs, (*scene.y0, *truth.end.tolist())))
    return WRONG * min(1.0, size)


def _along(scene: Scene, curve: Curve, setting: dict[str, float]) -> float:
    """The largest energy error over the whole run."""
    module, params = scene.module, scene.params
    options: dict[str, Any] = {"h": setting["h"]} if "h" in setting else {
        "rtol": setting["rtol"], "atol": setting["rtol"]
    }  # fmt: skip
    with ignore_predictability():
        run = integrate(
            module, (0, scene.duration), scene.y0, params, method=curve.method, form=curve.form,
            t_eval=np.linspace(0, scene.duration, LOOKS), energy=True, max_steps=10**8, **options,
        )  # fmt: skip
    assert run.energy is not None
    return float(np.abs(energy_error(module, params, run.energy)).max())
