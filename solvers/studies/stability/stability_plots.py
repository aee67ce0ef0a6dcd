"""Stability regions with the modes of a scene, and boundaries of stability regions."""

from collections.abc import Mapping, Sequence
from math import inf

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from solvers.io.figures import COLOURS, coloured, panels
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.studies.stability.critical_step import CriticalStep

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
