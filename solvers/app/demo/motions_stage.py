"""Stages on motions: costs of methods, longest stable steps, a motion, and a map of motions."""

import time
from collections.abc import Sequence
from functools import partial
from math import isfinite, isinf
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from solvers.app.demo.stage import ReportedNumber, Stage, pair, png_image, svg_image, table
from solvers.equations.energy import energy_error, energy_unit
from solvers.equations.linearisation.normal_modes import Modes
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.integration.results.solution import Solution
from solvers.io.figures import COLOURS, panels
from solvers.player.player_page import player
from solvers.player.track import Track
from solvers.runge_kutta.method_catalogue import load
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.scenes.scene import Scene
from solvers.studies.stability import boundaries, critical_step
from solvers.studies.work_precision.cost_curve import Combination, CostCurve
from solvers.studies.work_precision.measured_curves import curves
from solvers.studies.work_precision.reference import Reference
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.sweep_run import convergence, sweep, tighter_rtol
from solvers.sweeps.sweep_figure import figure

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


#: Relative and absolute tolerance of both programs, and the step size of Euler's method in s.
TOLERANCE, STEP = 1e-12, 0.01
#: The two rods.
RODS = (("rod", (-1, 0)), ("rod", (0, 1)))


def motion(scene: Scene) -> Stage:
    """Integrate a scene of the double pendulum, compare the end with SciPy's, and play it."""
    module, span = scene.module, (0.0, scene.duration)
    run = partial(integrate, module, span, scene.y0, scene.params, t_eval=scene.times, energy=True)
    accurate = run(method="verner98", rtol=TOLERANCE, atol=TOLERANCE)
    independent = partial(solve_ivp, module.rhs, span, scene.y0, args=(scene.params,))
    scipy = independent(method="DOP853", rtol=TOLERANCE, atol=TOLERANCE)
    with ignore_predictability():  # its errors are what is shown
        euler = run(method="rk1", h=STEP)
    tracks = [
        _track(scene, f"Verner 9(8), tolerance {TOLERANCE:g}", accurate),
        _track(scene, f"Euler, h = {STEP:g} s", euler),
    ]
    difference = float(np.abs(accurate.y[:, -1] - scipy.y[:, -1]).max())
    assert tracks[0].energy_error is not None
    change = float(np.abs(tracks[0].energy_error).max())
    angles = zip(module.COORDINATES, accurate.y[:, -1], strict=False)
    end = ", ".join(f"{name} = {value:.9f}" for name, value in angles)
    after, command = f"after {scene.duration:g} s", "holonomic demo"
    apart = f"largest difference between the states of two programs {after}"
    programs = f"Verner 9(8) and SciPy's DOP853, both with tolerances of {TOLERANCE:g}"
    energy = f"computed along the motion, relative to the {tracks[0].energy_unit}"
    return Stage(
        (
            f"{after}: {end} rad",
            accurate.run,
            f"difference from SciPy's DOP853 {difference:.1g}, energy error {change:.1g}",
        ),
        player(tracks),
        (
            ReportedNumber(apart, f"{difference:.1e} rad or rad/s", programs, command),
            ReportedNumber("largest relative energy error", f"{change:.1e}", energy, command),
        ),
    )


def _track(scene: Scene, label: str, run: Solution) -> Track:
    positions = np.asarray(scene.module.positions_many(0.0, run.y, scene.params))
    assert run.energy is not None
    error = energy_error(scene.module, scene.params, run.energy)
    unit = energy_unit(scene.module, scene.params, float(run.energy[0])).name
    return Track(label, run.t, positions, RODS, error, unit)


def flips(definition: Sweep, folder: Path) -> Stage:
    """Run or resume a sweep and plot its map: the time until a double pendulum first flips."""
    start = time.perf_counter()
    results = sweep(definition, folder)
    seconds = time.perf_counter() - start
    change = convergence(definition)["flip"]
    motions, duration = f"{definition.motions:,}", f"{definition.duration:g} s"
    flipped = f"{results.count.get('event', 0):,}"
    method = (
        f"{change.motions} of them repeated with rtol = {tighter_rtol(definition):.0e}: "
        f"half of the times change by less than {change.median:.0e} s"
    )
    quantity = f"motions of {motions} that flip within {duration}"
    return Stage(
        (f"{motions} motions of {duration}: {flipped} flip ({seconds:.1f} s this time)",),
        png_image(figure(results), "Map of the time until one of the rods flips"),
        (ReportedNumber(quantity, flipped, method, f"holonomic sweep {definition.name}"),),
    )
