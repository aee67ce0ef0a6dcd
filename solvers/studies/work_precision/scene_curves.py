"""The work-precision study of a scene: curves, frontiers and findings."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from solvers.equations.linearisation.normal_modes import mode_spread
from solvers.io.exports import jsonable
from solvers.io.text_table import text_table
from solvers.scenes.scene import Scene
from solvers.studies.work_precision import work_precision_plots
from solvers.studies.work_precision.cost_curve import CostCurve, FrontierPoint, frontier
from solvers.studies.work_precision.curve_findings import (
    MisleadingEnergy,
    RoundingLimit,
    misleading_energy,
    rounding_limits,
    wrong_above,
)
from solvers.studies.work_precision.measured_curves import unit_of_energy
from solvers.studies.work_precision.reference import Reference

#: Choices with which the frontier is compared.
BACKENDS = ("compiled", "python", "scipy", "heyoka", "numbalsoda", "numba", "diffrax")
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
        for curve in self.curves:
            if curve.failure:
                yield f"{curve.program} failed: {curve.failure}"
        calls = [row for row in self.frontier_rhs if row.backend != "numba"]
        yield "in calls of the right-hand side: " + ", ".join(
            f"{row.global_error:.0e}: {row.work_rhs:.0f} ({row.method})" for row in calls[::3]
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
