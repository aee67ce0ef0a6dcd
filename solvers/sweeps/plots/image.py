"""A map over two axes, as an image."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap

from solvers.sweeps.axes import Array, Grid
from solvers.sweeps.barrier import barrier, energies
from solvers.sweeps.initial_states import initial_states
from solvers.sweeps.plots.labels import add_colour_bar, label_axis, letter
from solvers.sweeps.plots.quantity import NEVER, NOTHING, Quantity
from solvers.sweeps.status import PROVED

#: Largest number of pixels along each side of an image, and points along those of a boundary.
PIXELS, BOUNDARY = 2048, 400


def image(panel: Axes, *, quantity: Quantity) -> None:
    """One number of each motion over the two longest axes, in the middle of all others."""
    results = quantity.results
    x, y = longest(results.axes)
    xs, ys = results.axes[x], results.axes[y]
    cut: Any = tuple(
        slice(None, None, -(-len(axis) // PIXELS)) if q in (x, y) else len(axis) // 2
        for q, axis in results.axes.items()
    )
    values = quantity.values(cut)
    palette, norm = quantity.colours(values)
    options: Any = {"origin": "lower", "aspect": "auto", "interpolation": "nearest"}
    options["extent"] = [*_edges(xs), *_edges(ys)]
    panel.set_facecolor(NOTHING)
    mappable = panel.imshow(np.ma.masked_invalid(values.T), cmap=palette, norm=norm, **options)
    never = np.ma.masked_equal(results.status[cut].T == PROVED, False)
    panel.imshow(never, cmap=ListedColormap([NEVER]), **options)
    fixed = {q: float(axis[len(axis) // 2]) for q, axis in results.axes.items() if q not in (x, y)}
    if quantity.map.barrier:
        _draw_boundary(panel, quantity, (x, y), fixed)
    add_colour_bar(panel, mappable, quantity.label)
    label_axis(panel, "x", results, x)
    label_axis(panel, "y", results, y)
    if fixed:
        at = (f"{letter(q)} = {v:.4g} {results.unit(q)}" for q, v in fixed.items())
        panel.set_xlabel(f"{panel.get_xlabel()}, at {', '.join(at)}")


def longest(axes: Mapping[str, Array]) -> tuple[str, str]:
    """The two axes with most values, in their order."""
    two = sorted(axes, key=lambda name: -len(axes[name]))[:2]
    first, second = (name for name in axes if name in two)
    return first, second


def _draw_boundary(
    panel: Axes, quantity: Quantity, names: tuple[str, str], fixed: Mapping[str, float]
) -> None:
    """Draw the line on which motions start with the energy of a barrier."""
    definition, axes = quantity.results.definition, quantity.results.axes
    fine = {name: np.linspace(*_edges(axes[name]), BOUNDARY) for name in names}
    columns = Grid(fine).columns(0, BOUNDARY**2)
    columns |= {name: np.full(BOUNDARY**2, value) for name, value in fixed.items()}
    module = definition.module
    state, params, _ = initial_states(definition, columns)
    margin = energies(module, state[:, : len(module.STATE)], params)
    margin -= barrier(module, quantity.map.barrier, params, len(state))
    levels = margin.reshape(BOUNDARY, BOUNDARY).T
    panel.contour(*fine.values(), levels, [0.0], colors="#D55E00", linewidths=1.2)


def _edges(values: Array) -> tuple[float, float]:
    """Outer edges of the first and the last pixel of an axis."""
    half = float(values[-1] - values[0]) / max(len(values) - 1, 1) / 2 or 0.5
    return float(values[0]) - half, float(values[-1]) + half
