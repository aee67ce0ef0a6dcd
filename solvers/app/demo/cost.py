"""Speed against accuracy for a scene, measured in a few seconds."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from matplotlib.figure import Figure

from solvers.app.demo.html import pair, svg_image, table
from solvers.app.demo.stage import Number, Stage
from solvers.io.figures import COLOURS, panels
from solvers.scenes.scene import Scene
from solvers.studies.work_precision.curve import Combination, Curve
from solvers.studies.work_precision.measurement import curves
from solvers.studies.work_precision.reference import Reference

#: The compared methods: the report's, some with step control, and SciPy's.
COMPARED: dict[Combination, str] = {
    ("rk1", "rational", "compiled"): "Euler",
    ("rk4", "rational", "compiled"): "RK4",
    ("dp54", "rational", "compiled"): "Dormand-Prince 5(4)",
    ("verner98", "rational", "compiled"): "Verner 9(8)",
    ("RK45", "lagrangian", "scipy"): "SciPy RK45",
    ("DOP853", "lagrangian", "scipy"): "SciPy DOP853",
}
#: The error at which all are compared.
ERROR = 1e-6


def cost(scene: Scene) -> Stage:
    """Measure seconds against errors; nothing else should run on the machine meanwhile."""
    truth = Reference.of(scene)
    measured = curves(scene, truth, COMPARED)
    seconds = {_name(curve): curve.at(ERROR) for curve in measured}
    seconds = {name: cost for name, cost in seconds.items() if isfinite(cost)}
    best, *others = sorted(seconds, key=seconds.__getitem__)
    least = f"{best} {seconds[best] * 1e6:.0f} us"
    ratios = [(name, f"{seconds[name] / seconds[best]:.3g}") for name in others]
    compared = ", ".join(f"{name} {ratio} x" for name, ratio in ratios)
    method = (
        f"medians of runs on this machine; errors against {truth.METHOD}, "
        f"own error {truth.global_error:.0e}"
    )
    chart = svg_image(
        plot(measured), "Error at the end against seconds, with a curve for each method"
    )
    times = table((f"for an error of {ERROR:g}", "times as long"), [(best, "1"), *ratios])
    quantity, command = f"seconds for an error of {ERROR:g}", f"holonomic chart {scene.name}"
    return Stage(
        (f"an error of {ERROR:g} takes {least};", compared),
        pair(chart, times),
        (Number(quantity, f"{least}; {compared}", method, command),),
    )


def plot(measured: Sequence[Curve]) -> Figure:
    """One panel, which fits a narrow screen."""
    figure, (panel,) = panels("", size=(5.2, 4.4))
    for curve, colour in zip(measured, COLOURS, strict=False):
        seconds = [point.work_seconds for point in curve.points]
        errors = [point.global_error for point in curve.points]
        style = "--" if curve.backend == "scipy" else "-"
        panel.loglog(seconds, errors, style, marker=".", color=colour, label=_name(curve))
    panel.set(xlabel="time of a run / s", ylabel="error at the end / rad, rad/s")
    figure.legend(frameon=False, loc="outside upper center", ncols=3, fontsize="small")
    return figure


def _name(curve: Curve) -> str:
    return COMPARED[curve.combination]
