"""Stability regions: each with a scene's modes, or the boundaries of several."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from solvers.io.figures import COLOURS, panels
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.studies.stability.critical_step import CriticalStep

#: What of the complex plane is shown, and how finely.
LEFT, RIGHT, TOP, POINTS = -7.0, 4.0, 7.0, 221


def regions(
    title: str, steps: Sequence[CriticalStep], frequencies: NDArray[np.float64],
    along: NDArray[np.complex128],
) -> Figure:  # fmt: skip
    """One panel for each stability function: |R| ≤ 1 in colour, h λ on it.

    Parameters
    ----------
    title : str
        Of the picture.
    steps : sequence of CriticalStep
        Methods; those with the same function share a panel.
    frequencies : ndarray of shape (modes,)
        Of the modes about rest in rad/s, ascending: dots, with h at the limit, or
        1/frequency of the fastest if there is none.
    along : ndarray
        Eigenvalues along the scene's motion in 1/s, with the same h.

    Returns
    -------
    Figure
    """
    shared: dict[object, list[CriticalStep]] = {}
    for step in steps:
        shared.setdefault(step.function, []).append(step)
    columns = min(5, len(shared))
    figure, axes = panels(
        title, rows=-(-len(shared) // columns), columns=columns, size=(2.6 * columns, 9)
    )
    for panel, group in zip(axes, shared.values(), strict=False):
        _region(panel, group, frequencies, along)
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
        By what they are called in the legend; up to seven, which is how many colours there are.

    Returns
    -------
    matplotlib.figure.Figure
        The plane of hλ, a step times an eigenvalue, which has no unit.
    """
    figure, (panel,) = panels("", size=(5.2, 4.8))
    x, y = np.linspace(LEFT, RIGHT, POINTS), np.linspace(-TOP, TOP, POINTS)
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


def _region(
    panel: Axes, group: Sequence[CriticalStep], frequencies: NDArray[np.float64],
    along: NDArray[np.complex128],
) -> None:  # fmt: skip
    first = group[0]
    x, y = np.linspace(LEFT, RIGHT, POINTS), np.linspace(-TOP, TOP, POINTS)
    size = np.abs(first.function(x + 1j * y[:, None]))
    panel.contourf(x, y, size, levels=[0, 1], colors=["#cfe3f2"])
    panel.contour(x, y, size, levels=[1], colors=[COLOURS[0]], linewidths=0.8)
    panel.axhline(0, color="#bbbbbb", linewidth=0.5)
    panel.axvline(0, color="#bbbbbb", linewidth=0.5)
    limited = 0 < first.predicted < inf
    h = first.predicted if limited else 1 / frequencies[-1]
    panel.plot(h * along.real, h * along.imag, ".", color="#999999", markersize=1.5)
    modes = h * np.concatenate([frequencies, -frequencies])
    panel.plot(np.zeros_like(modes), modes, "o", color=COLOURS[1], markersize=3)
    panel.set(xlim=(LEFT, RIGHT), ylim=(-TOP, TOP), aspect="equal")
    limit = f"h ≤ {first.predicted:.3g} s" if limited else (
        "no step is stable" if first.predicted == 0 else "every step is stable"
    )  # fmt: skip
    panel.set_title(f"{', '.join(step.method for step in group)}\n{limit}", fontsize="small")
