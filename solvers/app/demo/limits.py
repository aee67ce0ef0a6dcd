"""How long steps may be: stability regions, exact, and one limit measured."""

from __future__ import annotations

from math import isinf

from solvers.app.demo.html import drawing, pair, table
from solvers.app.demo.station import Number, Station
from solvers.equations.normal_modes import Modes
from solvers.runge_kutta.catalogue import load
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.scenes.scene import Scene
from solvers.studies.stability.critical_step import critical_step
from solvers.studies.stability.plots import boundaries

#: Whose regions are drawn, and what to call them.
DRAWN = {"rk1": "Euler", "dp54": "Dormand-Prince", "dop853": "DOP853", "rk4": "RK4"}
#: Methods whose limits are listed.
LISTED = ("rk1", "midpoint", "rk3", "rk4", "dp54", "dop853", "verner87", "gauss2", "radau3")


def limits(scene: Scene) -> Station:
    """The longest steps that let no small motion of a scene's system grow."""
    functions = {name: StabilityFunction.of(load(name)) for name in {*DRAWN, *LISTED}}
    fastest = float(Modes.at_rest(scene.module, scene.params).frequencies[-1])
    measured = critical_step("rk4", scene.module, scene.params)
    rows = []
    for name in LISTED:
        interval = functions[name].imaginary_stability_interval
        longest = (
            "any" if isinf(interval) else f"{interval / fastest:.4g} s" if interval else "none"
        )
        rows.append((f"{name}: {load(name).title}", str(load(name).order), longest))
    return Station(
        (
            f"longest stable step of RK4: {measured.predicted:.5g} s predicted, "
            f"{measured.measured:.5g} s measured",
        ),
        pair(
            drawing(
                boundaries({DRAWN[name]: functions[name] for name in DRAWN}),
                "Boundaries of stability regions in the plane of step times eigenvalue",
            ),
            table(("method", "order", "longest stable step"), rows),
        ),
        (
            Number("longest stable step of RK4, predicted", f"{measured.predicted:.5g} s",
                   "exact stability function, by Sturm's theorem, over the fastest frequency, "
                   f"{fastest:.5g} rad/s", "holonomic stability report"),
            Number("the same, measured", f"{measured.measured:.5g} s",
                   "bisection with the running stepper on the nonlinear equations",
                   "holonomic stability report"),
        ),
    )  # fmt: skip
