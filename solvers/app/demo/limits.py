"""The longest stable steps: exact stability regions, and one limit measured."""

from __future__ import annotations

from math import isinf

from solvers.app.demo.html import pair, svg_image, table
from solvers.app.demo.stage import Number, Stage
from solvers.equations.normal_modes import Modes
from solvers.runge_kutta.catalogue import load
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.scenes.scene import Scene
from solvers.studies.stability.critical_step import critical_step
from solvers.studies.stability.plots import boundaries

#: Methods whose stability regions are plotted, with labels.
PLOTTED = {"rk1": "Euler", "dp54": "Dormand-Prince", "dop853": "DOP853", "rk4": "RK4"}
#: Methods whose limits are listed.
LISTED = ("rk1", "midpoint", "rk3", "rk4", "dp54", "dop853", "verner87", "gauss2", "radau3")


def limits(scene: Scene) -> Stage:
    """The longest steps with which no small oscillation of a scene's system grows."""
    functions = {name: StabilityFunction.of(load(name)) for name in {*PLOTTED, *LISTED}}
    fastest = float(Modes.at_rest(scene.module, scene.params).frequencies[-1])
    rk4 = critical_step("rk4", scene.module, scene.params)
    predicted, measured = f"{rk4.predicted:.5g} s", f"{rk4.measured:.5g} s"
    rows = [
        (
            f"{name}: {load(name).title}",
            str(load(name).order),
            _longest(functions[name].imaginary_stability_interval, fastest),
        )
        for name in LISTED
    ]
    chart = svg_image(
        boundaries({label: functions[name] for name, label in PLOTTED.items()}),
        "Boundaries of stability regions in the plane of step size times eigenvalue",
    )
    exact = (
        "exact stability function, by Sturm's theorem, divided by the highest frequency, "
        f"{fastest:.5g} rad/s"
    )
    bisection = "bisection with the stepper on the nonlinear equations"
    command = "holonomic stability report"
    return Stage(
        (f"longest stable step of RK4: {predicted} predicted, {measured} measured",),
        pair(chart, table(("method", "order", "longest stable step"), rows)),
        (
            Number("longest stable step of RK4, predicted", predicted, exact, command),
            Number("longest stable step of RK4, measured", measured, bisection, command),
        ),
    )


def _longest(interval: float, frequency: float) -> str:
    if isinf(interval):
        return "any"
    return f"{interval / frequency:.4g} s" if interval else "none"
