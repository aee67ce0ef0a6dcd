"""The work-precision study of a scene: curves, frontiers and findings."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isfinite, nan
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from solvers.equations.energy import ABOVE_REST, energy_error
from solvers.equations.linearisation.normal_modes import mode_spread
from solvers.equations.module import has_function
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.io.exports import jsonable
from solvers.io.terminal import text_table
from solvers.runge_kutta.method_catalogue import load
from solvers.scenes.scene import Scene
from solvers.studies.work_precision import work_precision_plots
from solvers.studies.work_precision.cost_curve import (
    CostCurve,
    FrontierPoint,
    frontier,
    least_pair,
    select,
)
from solvers.studies.work_precision.measured_curves import REPORT_METHODS, unit_of_energy
from solvers.studies.work_precision.reference import Reference

#: Largest difference between an observed order and the method's order.
CLOSE = 0.5
#: A state is wrong if its error exceeds this part of the motion, or of 1 rad and 1 rad/s.
WRONG = 0.1
#: Largest energy error that counts as kept; number of runs examined, and of samples in each.
KEPT, CANDIDATES, SAMPLES = 1e-3, 20, 400


@dataclass(frozen=True)
class RoundingLimit:
    """The step at which the error of a method is least.

    Of the two neighbouring steps whose larger error is least, it is the shorter one, so that a
    single lucky run does not count.
    """

    method: str
    h: float  # in s
    global_error: float  # with this step
    finest: float  # the shortest step with a result, in s
    finest_error: float
    order: float  # observed with longer steps; NaN where errors do not yet fall accordingly

    def __str__(self) -> str:
        if not isfinite(self.order):
            return f"{self.method}: no observed order, least error {self.global_error:.1e}"
        text = f"{self.method}: error falls as h^{self.order:.2f} to {self.global_error:.1e}"
        if self.finest_error < 2 * self.global_error:
            return f"{text} at the shortest step, {self.finest:.1e} s"
        rounding = f"{self.finest_error:.1e} at {self.finest:.1e} s"
        return f"{text} at h = {self.h:.1e} s; by rounding it is {rounding}"


def rounding_limits(curves: Sequence[CostCurve]) -> list[RoundingLimit]:
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


def _rounding_limit(curve: CostCurve) -> RoundingLimit:
    steps, errors = np.array([(p.setting["h"], p.global_error) for p in curve.points]).T
    best = least_pair(errors.tolist())
    # errors that are small and above rounding
    straight = (errors < 1e-2) & (errors > 100 * errors[best])
    order = nan
    if straight.sum() >= 3:
        order = float(np.polyfit(np.log(steps[straight]), np.log(errors[straight]), 1)[0])
    if abs(order - load(curve.method).order) > CLOSE:
        order = nan
    h, least, finest, last = (float(x[k]) for k in (best, -1) for x in (steps, errors))
    return RoundingLimit(curve.method, h, least, finest, last, order)


@dataclass(frozen=True)
class MisleadingEnergy:
    """A compiled run with a small energy error and a wrong trajectory."""

    method: str
    form: str
    setting: dict[str, float]  # its step or tolerance
    energy_error: float  # largest over the whole run, relative to the energy above rest
    global_error: float  # of the final state

    def __str__(self) -> str:
        setting = ", ".join(f"{name} = {value:.2g}" for name, value in self.setting.items())
        return (
            f"misleading energy: {self.method}, {self.form}, {setting}: energy error "
            f"{self.energy_error:.0e} of the {ABOVE_REST}, error of the final state "
            f"{self.global_error:.2g}"
        )


def misleading_energy(
    curves: Sequence[CostCurve], scene: Scene, reference: Reference
) -> MisleadingEnergy | None:
    """The run with the least energy error among those with a wrong trajectory, if it is kept.

    None where forces change the energy, or where no error is relative to the energy above rest.
    """
    if has_function(scene.module, "power") or not unit_of_energy(scene).is_relative:
        return None
    limit = wrong_above(scene, reference)
    compiled = [curve for curve in curves if curve.backend == "compiled"]
    runs = [(curve, p) for curve in compiled for p in curve.points if p.global_error > limit]
    results = []
    for curve, point in sorted(runs, key=lambda run: run[1].energy_error)[:CANDIDATES]:
        energy = _largest_energy_error(scene, curve, point.setting)
        run = curve.method, curve.form, point.setting, energy, point.global_error
        results.append(MisleadingEnergy(*run))
    best = min(results, key=lambda run: run.energy_error, default=None)
    return best if best and best.energy_error < KEPT else None


def wrong_above(scene: Scene, reference: Reference) -> float:
    """The error above which no significant digit of a state is right."""
    size = max(map(abs, (*scene.y0, *reference.end.tolist())))
    return WRONG * min(1.0, size)


def _largest_energy_error(scene: Scene, curve: CostCurve, setting: dict[str, float]) -> float:
    t = np.linspace(0, scene.duration, SAMPLES)
    options: dict[str, Any] = {"t_eval": t, "energy": True, "max_steps": 10**8, **setting}
    if "rtol" in setting:
        options["atol"] = setting["rtol"]
    motion = scene.module, (0, scene.duration), scene.y0, scene.params
    with ignore_predictability():
        run = integrate(*motion, method=curve.method, form=curve.form, **options)
    assert run.energy is not None
    return float(np.abs(energy_error(scene.module, scene.params, run.energy)).max())


#: Choices with which the frontier is compared.
BACKENDS = ("compiled", "python", "scipy")
COMPARED = [("method", "rk4"), ("form", "lagrangian"), ("form", "hamiltonian")]
COMPARED += [("backend", backend) for backend in BACKENDS]


@dataclass(frozen=True)
class SceneCurves:
    """Curves of a scene, and the findings that follow from them."""

    scene: Scene
    reference: Reference
    curves: list[CostCurve]
    frontier: list[FrontierPoint]  # the cheapest combinations in seconds
    frontier_rhs: list[FrontierPoint]  # the same in evaluations of the right-hand side
    rounding_limits: list[RoundingLimit]
    misleading_energy: MisleadingEnergy | None

    @classmethod
    def of(cls, scene: Scene, reference: Reference, curves: list[CostCurve]) -> "SceneCurves":
        """Findings that follow from curves."""
        frontiers = frontier(curves), frontier(curves, "work_rhs")
        misleading = misleading_energy(curves, scene, reference)
        return cls(scene, reference, curves, *frontiers, rounding_limits(curves), misleading)

    def summary(self) -> Iterator[str]:
        """Reference, frontier and findings as text."""
        reference = self.reference
        yield f"{self.scene.title}, {self.scene.duration:g} s"
        others = "; ".join(f"{name} {error:.1e}" for name, error in reference.differences.items())
        error = f"own error {reference.global_error:.1e}"
        yield f"reference: {reference.METHOD}, {error}; differences: {others}"
        yield "the cheapest combination for each error, and the relative time of the best with ...:"
        ratios = [row.cost_ratios for row in self.frontier]
        shown = [pair for pair in COMPARED if any(pair[1] in each[pair[0]] for each in ratios)]
        columns = {"error": ".0e", "time/µs": ".1f", "calls": ".0f", "cheapest": ""}
        columns |= {value: ".3g" for _, value in shown}
        yield from text_table(columns, (_row(row, shown) for row in self.frontier))
        yield "in calls of the right-hand side: " + ", ".join(
            f"{row.global_error:.0e}: {row.work_rhs:.0f} ({row.method})"
            for row in self.frontier_rhs[::3]
        )
        yield from map(str, self.rounding_limits)
        if self.misleading_energy:
            yield str(self.misleading_energy)

    def plots(self) -> dict[str, Figure]:
        """Figures by the names of their files."""
        title, name, curves = self.scene.title, self.scene.name, self.curves
        wrong, unit = wrong_above(self.scene, self.reference), unit_of_energy(self.scene)
        return {
            f"work_precision_{name}": work_precision_plots.work_precision(
                f"Cost of accuracy: {title}", curves
            ),
            f"steps_{name}": work_precision_plots.steps(f"Shorter steps: {title}", curves),
            f"energy_{name}": work_precision_plots.energy(
                f"Energy and trajectory: {title}", curves, wrong, unit
            ),
        }


def _row(row: FrontierPoint, shown: Sequence[tuple[str, str]]) -> list[object]:
    name = f"{row.method}, {row.form if row.backend == 'compiled' else row.backend}"
    ratios = (row.cost_ratios[choice].get(value) for choice, value in shown)
    return [row.global_error, row.work_seconds * 1e6, row.work_rhs, name, *ratios]


def record(studies: Sequence[SceneCurves]) -> str:
    """The cheapest compiled combination of each scene for each error, as JSON."""
    rows = [
        {
            "scene": study.scene.name,
            "system": study.scene.module.SYSTEM,
            "duration": study.scene.duration,
            "spread": mode_spread(study.scene.module, study.scene.params),
            "frontier": frontier([c for c in study.curves if c.backend == "compiled"]),
        }
        for study in studies
    ]
    return json.dumps(jsonable(rows), indent=1) + "\n"
