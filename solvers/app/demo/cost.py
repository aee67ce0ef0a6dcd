"""Speed against accuracy on a scene, measured now, in some seconds."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from matplotlib.figure import Figure

from solvers.app.demo.html import drawing, pair, table
from solvers.app.demo.station import Number, Station
from solvers.io.figures import COLOURS, panels
from solvers.scenes.scene import Scene
from solvers.studies.work_precision.curve import Curve
from solvers.studies.work_precision.measurement import Combination, curves
from solvers.studies.work_precision.reference import reference

#: What is compared: the report's methods, some that control their steps, and SciPy's.
COMPARED: dict[Combination, str] = {
    ("rk1", "rational", "compiled"): "Euler",
    ("rk4", "rational", "compiled"): "RK4",
    ("dp54", "rational", "compiled"): "Dormand-Prince 5(4)",
    ("verner98", "rational", "compiled"): "Verner 9(8)",
    ("RK45", "lagrangian", "scipy"): "SciPy RK45",
    ("DOP853", "lagrangian", "scipy"): "SciPy DOP853",
}
#: The error for which all are compared.
ERROR = 1e-6


def cost(scene: Scene) -> Station:
    """Chart seconds against errors; leave the machine alone meanwhile."""
    truth = reference(scene)
    measured = curves(scene, truth, COMPARED)
    seconds = {_name(curve): curve.at(ERROR) for curve in measured}
    seconds = {name: cost for name, cost in seconds.items() if isfinite(cost)}
    best, *others = sorted(seconds, key=seconds.__getitem__)
    least = f"{best} {seconds[best] * 1e6:.0f} us"
    ratios = [(name, f"{seconds[name] / seconds[best]:.3g}") for name in others]
    how = (
        f"medians of runs on this machine; errors against {truth.METHOD}, "
        f"own error {truth.global_error:.0e}"
    )
    return Station(
        (
            f"an error of {ERROR:g} takes {least};",
            ", ".join(f"{name} {ratio} x" for name, ratio in ratios),
        ),
        pair(
            drawing(charted(measured), "Error at the end over seconds, a curve for each method"),
            table((f"for an error of {ERROR:g}", "times as long"), [(best, "1"), *ratios]),
        ),
        (
            Number(f"seconds for an error of {ERROR:g}",
                   f"{least}; {', '.join(f'{name} {ratio} x' for name, ratio in ratios)}",
                   how, f"holonomic chart {scene.name}"),
        ),
    )  # fmt: skip


def charted(measured: Sequence[Curve]) -> Figure:
    """One panel, which a narrow screen can show."""
    figure, (panel,) = panels("", size=(5.2, 4.4))
    for curve, colour in zip(measured, COLOURS, strict=False):
        panel.loglog(
            [p.work_seconds for p in curve.points], [p.global_error for p in curve.points],
            marker=".", color=colour, label=_name(curve),
            linestyle="--" if curve.backend == "scipy" else "-",
        )  # fmt: skip
    panel.set(xlabel="time of a run / s", ylabel="error at the end / rad, rad/s")
    figure.legend(frameon=False, loc="outside upper center", ncols=3, fontsize="small")
    return figure


def _name(curve: Curve) -> str:
    return COMPARED[curve.method, curve.form, curve.backend]
