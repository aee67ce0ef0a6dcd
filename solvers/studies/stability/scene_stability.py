"""The stability study of a scene: critical steps of every method."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from solvers.equations.linearisation.normal_modes import Modes, local_eigenvalues
from solvers.integration.integrate import integrate
from solvers.io.text_table import text_table
from solvers.runge_kutta.method_catalogue import load, names
from solvers.scenes.scene import Scene
from solvers.studies.stability.critical_step import CriticalStep, critical_step
from solvers.studies.stability.stability_plots import regions

#: Samples of a scene's motion at which its modes are computed.
SAMPLES = 100


@dataclass(frozen=True)
class SceneStability:
    """Critical steps of every method for small motions with a scene's parameters."""

    scene: Scene
    steps: list[CriticalStep]

    @classmethod
    def of(cls, scene: Scene, report: Callable[[str], None] = lambda _: None) -> "SceneStability":
        """The critical steps of all methods, each reported before it is computed.

        Fixed steps of a method with variable order are those of another method, and splittings have
        no stability region.
        """
        steps, tableaus = [], {name: load(name) for name in names()}
        for method in (m for m, t in tableaus.items() if not t.lower and not t.is_splitting):
            report(f"{scene.name}: {method}")
            steps.append(critical_step(method, scene.module, scene.params))
        return cls(scene, steps)

    def summary(self) -> Iterator[str]:
        """The critical steps as a table."""
        yield f"Longest stable steps of {self.scene.title}: its fastest small oscillation, in s"
        columns = {"method": "", "order": "d", "real": ".4g", "imaginary": ".5g"}
        columns |= {"predicted": ".5g", "linear": ".5g", "nonlinear": ".5g"}
        columns |= {"at h": ".3g", "ln growth/step": ".1e", "predicted ln": ".1e"}
        yield from text_table(columns, map(_cells, self.steps))
        yield "0: unstable at every step size; inf: stable at every step size"

    def plot(self) -> Figure:
        """Stability regions of all methods with the scene's modes."""
        module, params, duration = self.scene.module, self.scene.params, self.scene.duration
        t = np.linspace(0, duration, SAMPLES)
        motion = integrate(module, (0, duration), self.scene.y0, params, t_eval=t)
        eigenvalues = local_eigenvalues(module, params, motion.y.T).ravel()
        frequencies = Modes.at_rest(module, params).frequencies
        title = f"|R(hλ)| ≤ 1, small motions (dots) and the motion (grey) of {self.scene.title}"
        return regions(title, self.steps, frequencies, eigenvalues)

    def rows(self) -> list[dict[str, Any]]:
        """The figures of each method, for JSON."""
        return [{"scene": self.scene.name} | _row(step) for step in self.steps]


def _cells(step: CriticalStep) -> tuple[object, ...]:
    intervals = step.function.real_stability_interval, step.function.imaginary_stability_interval
    limits = step.predicted, step.linear, step.measured
    growth = step.probe, step.growth_measured, step.growth_predicted
    return step.method, step.order, *intervals, *limits, *growth


def _row(step: CriticalStep) -> dict[str, Any]:
    function, probe = step.function, {"h": step.probe}
    probe |= {"growth_predicted": step.growth_predicted, "growth_measured": step.growth_measured}
    numerator, denominator = map(str, function.numerator), map(str, function.denominator)
    names = {name: getattr(step, name) for name in ("method", "title", "order", "stages")}
    return names | {
        "stability_function": {"numerator": [*numerator], "denominator": [*denominator]},
        "real_stability_interval": function.real_stability_interval,
        "imaginary_stability_interval": function.imaginary_stability_interval,
        "critical_step_predicted": step.predicted,
        "critical_step_measured": step.measured,
        "critical_step_measured_linear": step.linear,
        "probe": probe,
    }
