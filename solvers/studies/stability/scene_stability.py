"""The stability study of a scene: critical steps of every method, and stability regions."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from solvers.equations.linearisation.normal_modes import Modes, local_eigenvalues
from solvers.integration.integrate import integrate
from solvers.io.figures import COLOURS, coloured, panels
from solvers.io.terminal import text_table
from solvers.runge_kutta.method_catalogue import load, names
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.scenes.scene import Scene
from solvers.studies.stability.critical_step import CriticalStep, critical_step

Frequencies = NDArray[np.float64]
Eigenvalues = NDArray[np.complex128]

#: Limits of the plotted part of the complex plane, and points along each axis.
LEFT, RIGHT, TOP, POINTS = -7.0, 4.0, 7.0, 221
X, Y = np.linspace(LEFT, RIGHT, POINTS), np.linspace(-TOP, TOP, POINTS)


def regions(
    title: str, steps: Sequence[CriticalStep], frequencies: Frequencies, eigenvalues: Eigenvalues
) -> Figure:
    """The region |R| ≤ 1 of each stability function, with hλ of modes and along a motion."""
    shared: dict[object, list[CriticalStep]] = {}
    for step in steps:
        shared.setdefault(step.function, []).append(step)
    columns = min(5, len(shared))
    rows = -(-len(shared) // columns)
    figure, axes = panels(title, rows=rows, columns=columns, size=(2.6 * columns, 9))
    for panel, group in zip(axes, shared.values(), strict=False):
        _region(panel, group, frequencies, eigenvalues)
    for panel in axes[len(shared) :]:
        panel.set_axis_off()
    figure.supxlabel("Re h λ")
    figure.supylabel("Im h λ")
    return figure


def boundaries(functions: Mapping[str, StabilityFunction]) -> Figure:
    """Boundaries |R| = 1 in one panel.

    Parameters
    ----------
    functions : mapping of str to StabilityFunction
        By their labels; at most seven.

    Returns
    -------
    matplotlib.figure.Figure
        The plane of hλ, a step times an eigenvalue.
    """
    figure, (panel,) = panels("", size=(5.2, 4.8))
    for name, colour in coloured(functions):
        size = np.abs(functions[name](X + 1j * Y[:, None]))
        panel.contour(X, Y, size, levels=[1], colors=[colour], linewidths=1.4)
    panel.axvline(0, color="#bbbbbb", linewidth=0.6, zorder=0)
    panel.axhline(0, color="#bbbbbb", linewidth=0.6, zorder=0)
    panel.set(xlabel="Re hλ", ylabel="Im hλ", aspect="equal")
    handles = [Line2D([], [], color=colour) for _, colour in coloured(functions)]
    style = {"frameon": False, "fontsize": "small", "columnspacing": 1.2}
    figure.legend(handles, list(functions), loc="outside upper center", ncols=4, **style)
    return figure


def _region(
    panel: Axes, group: Sequence[CriticalStep], frequencies: Frequencies, eigenvalues: Eigenvalues
) -> None:
    first = group[0]
    size = np.abs(first.function(X + 1j * Y[:, None]))
    panel.contourf(X, Y, size, levels=[0, 1], colors=["#cfe3f2"])
    panel.contour(X, Y, size, levels=[1], colors=[COLOURS[0]], linewidths=0.8)
    panel.axhline(0, color="#bbbbbb", linewidth=0.5)
    panel.axvline(0, color="#bbbbbb", linewidth=0.5)
    limits = {0: "no step is stable", inf: "every step is stable"}
    limit = limits.get(first.predicted, f"h ≤ {first.predicted:.3g} s")
    h = 1 / frequencies[-1] if first.predicted in limits else first.predicted
    along = h * eigenvalues
    panel.plot(along.real, along.imag, ".", color="#999999", markersize=1.5)
    modes = h * np.concatenate([frequencies, -frequencies])
    panel.plot(np.zeros_like(modes), modes, "o", color=COLOURS[1], markersize=3)
    panel.set(xlim=(LEFT, RIGHT), ylim=(-TOP, TOP), aspect="equal")
    panel.set_title(f"{', '.join(step.method for step in group)}\n{limit}", fontsize="small")


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
