"""Methods on a scene: speed against accuracy, and the longest stable steps."""

from collections.abc import Sequence
from math import isfinite, isinf

from matplotlib.figure import Figure

from solvers.app.demo.stage import ReportedNumber, Stage, pair, svg_image, table
from solvers.equations.linearisation.normal_modes import Modes
from solvers.io.figures import COLOURS, panels
from solvers.runge_kutta.method_catalogue import load
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.scenes.scene import Scene
from solvers.studies.stability.critical_step import critical_step
from solvers.studies.stability.scene_stability import boundaries
from solvers.studies.work_precision.cost_curve import Combination, CostCurve
from solvers.studies.work_precision.measured_curves import curves
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
#: Methods whose stability regions are plotted, with labels.
PLOTTED = {"rk1": "Euler", "dp54": "Dormand-Prince", "dop853": "DOP853", "rk4": "RK4"}
#: Methods whose limits are listed.
LISTED = ("rk1", "midpoint", "rk3", "rk4", "dp54", "dop853", "verner853", "gauss2", "radau3")


def cost(scene: Scene) -> Stage:
    """Measure seconds against errors; nothing else should run on the machine meanwhile."""
    reference = Reference.of(scene)
    measured = curves(scene, reference, COMPARED)
    seconds = {COMPARED[curve.combination]: curve.at(ERROR) for curve in measured}
    seconds = {name: cost for name, cost in seconds.items() if isfinite(cost)}
    best, *others = sorted(seconds, key=seconds.__getitem__)
    least = f"{best} {seconds[best] * 1e6:.0f} µs"
    ratios = [(name, _ratio(seconds[name] / seconds[best])) for name in others]
    compared = ", ".join(f"{name} {ratio} ×" for name, ratio in ratios)
    method = (
        f"medians of runs on this machine; errors against {reference.METHOD}, "
        f"own error {reference.global_error:.0e}"
    )
    description = "Error at the end against seconds, with a curve for each method"
    times = table((f"for an error of {ERROR:g}", "times as long"), [(best, "1"), *ratios])
    quantity, command = f"seconds for an error of {ERROR:g}", f"holonomic chart {scene.name}"
    return Stage(
        (f"an error of {ERROR:g} takes {least};", compared),
        pair(svg_image(_work_precision(measured), description), times),
        (ReportedNumber(quantity, f"{least}; {compared}", method, command),),
    )


def _ratio(value: float) -> str:
    return f"{value:.3g}" if value < 100 else f"{value:.0f}"


def _work_precision(measured: Sequence[CostCurve]) -> Figure:
    """One panel, which fits a narrow screen."""
    figure, (panel,) = panels("", size=(5.2, 4.4))
    for curve, colour in zip(measured, COLOURS, strict=False):
        style = {"linestyle": "--" if curve.backend == "scipy" else "-", "color": colour}
        seconds, errors = curve.costs("work_seconds")
        panel.loglog(seconds, errors, marker=".", label=COMPARED[curve.combination], **style)
    panel.set(xlabel="time of a run / s", ylabel="error at the end / rad, rad/s")
    figure.legend(frameon=False, loc="outside upper center", ncols=3, fontsize="small")
    return figure


def limits(scene: Scene) -> Stage:
    """The longest steps with which no small oscillation of a scene's system grows."""
    functions = {name: StabilityFunction.of(load(name)) for name in {*PLOTTED, *LISTED}}
    fastest = float(Modes.at_rest(scene.module, scene.params).frequencies[-1])
    rk4 = critical_step("rk4", scene.module, scene.params)
    predicted, measured = f"{rk4.predicted:.5g} s", f"{rk4.measured:.5g} s"
    rows = []
    for name in LISTED:
        step = _longest(functions[name].imaginary_stability_interval, fastest)
        rows.append((f"{name}: {load(name).title}", str(load(name).order), step))
    plot = boundaries({label: functions[name] for name, label in PLOTTED.items()})
    description = "Boundaries of stability regions in the plane of step size times eigenvalue"
    steps = table(("method", "order", "longest stable step"), rows)
    exact = (
        "exact stability function, by Sturm's theorem, divided by the highest frequency, "
        f"{fastest:.5g} rad/s"
    )
    bisection = "bisection with the stepper on the nonlinear equations"
    quantity, command = "longest stable step of RK4", "holonomic stability report"
    return Stage(
        (f"{quantity}: {predicted} predicted, {measured} measured",),
        pair(svg_image(plot, description), steps),
        (
            ReportedNumber(f"{quantity}, predicted", predicted, exact, command),
            ReportedNumber(f"{quantity}, measured", measured, bisection, command),
        ),
    )


def _longest(interval: float, frequency: float) -> str:
    if isinf(interval):
        return "any"
    return f"{interval / frequency:.4g} s" if interval else "none"
