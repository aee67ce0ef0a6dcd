"""A panel with a map over two axes, as an image."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from numpy.typing import NDArray

from solvers.sweeps.axes import Grid
from solvers.sweeps.barrier import barrier, energies
from solvers.sweeps.initial_states import begun
from solvers.sweeps.job import PROVED, Job
from solvers.sweeps.maps import First
from solvers.sweeps.plots.colours import NEVER, NOTHING, colours, shown
from solvers.sweeps.plots.labels import bar, label, letter, what
from solvers.sweeps.results import Results

Array: TypeAlias = NDArray[np.float64]

#: Pixels along each side of a map that are drawn, and of the energy's boundary.
PIXELS, BOUNDARY = 2048, 400


def image(panel: Axes, *, results: Results, name: str, place: tuple[int, ...]) -> None:
    """One number of each motion over the two longest axes, in the middle of all others."""
    one, module = results.asked.maps[name], results.asked.module
    part = one.labels[0][place[0]] if place else ""
    unit = module.UNITS[part] if part else one.unit(module)
    x, y = longest(results.axes)
    xs, ys = results.axes[x], results.axes[y]
    where: Any = tuple(
        slice(None, None, -(-len(axis) // PIXELS)) if q in (x, y) else len(axis) // 2
        for q, axis in results.axes.items()
    )
    within: Any = (*where, *place)
    values = shown(one, results.maps[name][within], unit)
    palette, norm = colours(one, values, unit)
    seen: dict[str, Any] = {
        "origin": "lower", "extent": [*_edges(xs), *_edges(ys)], "aspect": "auto",
        "interpolation": "nearest",
    }  # fmt: skip
    panel.set_facecolor(NOTHING)
    drawn = panel.imshow(np.ma.masked_invalid(values.T), cmap=palette, norm=norm, **seen)
    never = np.ma.masked_equal(results.status[where].T == PROVED, False)
    panel.imshow(never, cmap=ListedColormap([NEVER]), **seen)
    fixed = {q: float(axis[len(axis) // 2]) for q, axis in results.axes.items() if q not in (x, y)}
    if isinstance(one, First) and one.barrier:
        _boundary(panel, results, one, {x: xs, y: ys}, fixed)
    bar(panel, drawn, what(one, name, part, unit))
    label(panel, "x", results, x)
    label(panel, "y", results, y)
    if fixed:
        words = ", ".join(f"{letter(q)} = {v:.4g} {results.unit(q)}" for q, v in fixed.items())
        panel.set_xlabel(f"{panel.get_xlabel()}, at {words}")


def longest(axes: Mapping[str, Array]) -> tuple[str, str]:
    """The two axes with most values, in their order."""
    two = sorted(axes, key=lambda name: -len(axes[name]))[:2]
    first, second = (name for name in axes if name in two)
    return first, second


def _boundary(
    panel: Axes, results: Results, one: First, axes: Mapping[str, Array],
    fixed: Mapping[str, float],
) -> None:  # fmt: skip
    """The line below which energy forbids the event."""
    asked = results.asked
    fine = {name: np.linspace(*_edges(values), BOUNDARY) for name, values in axes.items()}
    columns = Grid(fine).columns(0, BOUNDARY**2)
    columns |= {name: np.full(BOUNDARY**2, value) for name, value in fixed.items()}
    state, params, _ = begun(Job.of(asked), asked.module, columns)
    left = energies(asked.module, state[:, : len(asked.module.STATE)], params)
    left -= barrier(asked.module, one.barrier, params, len(state))
    panel.contour(*fine.values(), left.reshape(BOUNDARY, BOUNDARY).T, [0.0], colors="#D55E00",
                  linewidths=1.2)  # fmt: skip


def _edges(values: Array) -> tuple[float, float]:
    """Where the first and the last pixel of an axis end."""
    half = float(values[-1] - values[0]) / max(len(values) - 1, 1) / 2 or 0.5
    return float(values[0]) - half, float(values[-1]) + half
