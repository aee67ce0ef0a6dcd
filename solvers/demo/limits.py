"""How long steps may be: stability regions, exact, and one limit measured."""

from __future__ import annotations

from collections.abc import Mapping
from math import isinf

import numpy as np
from matplotlib.figure import Figure as Chart
from matplotlib.lines import Line2D

from solvers.catalogue import load
from solvers.demo.html import drawing, pair, table
from solvers.demo.station import Figure, Station
from solvers.pictures import COLOURS, panels
from solvers.scenes.scene import Scene
from solvers.stability.critical import critical_step
from solvers.stability.modes import Modes
from solvers.stability_function import StabilityFunction

#: Whose regions are drawn; the last one's limit is measured, too.
DRAWN = {"rk1": "Euler", "dp54": "Dormand-Prince", "dop853": "DOP853", "rk4": "RK4"}
#: Methods whose limits are listed.
LISTED = ("rk1", "midpoint", "rk3", "rk4", "dp54", "dop853", "verner87", "gauss2", "radau3")
#: What of the complex plane is shown.
LEFT, RIGHT, TOP = -7.0, 4.0, 7.0


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
                regions({DRAWN[name]: functions[name] for name in DRAWN}),
                "Boundaries of stability regions in the plane of step times eigenvalue",
            ),
            table(("method", "order", "longest stable step"), rows),
        ),
        (
            Figure("longest stable step of RK4, predicted", f"{measured.predicted:.5g} s",
                   "exact stability function, by Sturm's theorem, over the fastest frequency, "
                   f"{fastest:.5g} rad/s", "holonomic stability report"),
            Figure("the same, measured", f"{measured.measured:.5g} s",
                   "bisection with the running stepper on the nonlinear equations",
                   "holonomic stability report"),
        ),
    )  # fmt: skip


def regions(functions: Mapping[str, StabilityFunction]) -> Chart:
    """Boundaries |R| = 1 in one panel.

    Parameters
    ----------
    functions : mapping of str to StabilityFunction
        By what they are called in the legend; up to seven, which is how many colours there are.

    Returns
    -------
    matplotlib.figure.Figure
        The plane of hλ, a step times an eigenvalue, which has no unit.
    """
    figure, (panel,) = panels("", size=(5.2, 4.8))
    x, y = np.linspace(LEFT, RIGHT, 331), np.linspace(-TOP, TOP, 421)
    for function, colour in zip(functions.values(), COLOURS, strict=False):
        size = np.abs(function(x + 1j * y[:, None]))
        panel.contour(x, y, size, levels=[1], colors=[colour], linewidths=1.4)
    panel.axvline(0, color="#bbbbbb", linewidth=0.6, zorder=0)
    panel.axhline(0, color="#bbbbbb", linewidth=0.6, zorder=0)
    panel.set(xlabel="Re hλ", ylabel="Im hλ", aspect="equal")
    handles = [Line2D([], [], color=colour) for colour, _ in zip(COLOURS, functions, strict=False)]
    figure.legend(handles, list(functions), frameon=False, loc="outside upper center", ncols=4,
                  fontsize="small", columnspacing=1.2)  # fmt: skip
    return figure
