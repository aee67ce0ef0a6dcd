"""Lines and points: maps over one axis, motions over time, Poincaré sections."""

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from solvers.io.figures import COLOURS
from solvers.io.notation import axis_label, symbol
from solvers.sweeps.plots.labels import add_colour_bar, label_axis
from solvers.sweeps.plots.quantity import NOTHING, Quantity, wrapped
from solvers.sweeps.results import Results

#: Largest number of values with markers, of curves, and of points of a section.
MARKED, CURVES, POINTS = 100, 60, 200_000


def line(panel: Axes, *, quantity: Quantity) -> None:
    """One number of each motion over the quantity that varies; over two, coloured points."""
    results, values = quantity.results, quantity.values()
    (x, xs), *others = results.axes.items()
    label_axis(panel, "x", results, x)
    if len(others) == 1:
        ((y, ys),) = others
        palette, norm = quantity.colours(values)
        unknown = np.isnan(values)
        panel.scatter(xs[unknown], ys[unknown], color=NOTHING, s=4)
        points = panel.scatter(xs, ys, c=values, s=4, cmap=palette, norm=norm)
        add_colour_bar(panel, points, quantity.label)
        label_axis(panel, "y", results, y)
        return
    is_joined = results.definition.axes.is_grid and not quantity.is_direction
    is_marked = not is_joined or len(values) <= MARKED or np.isnan(values).any()
    style = ("." if is_marked else "") + ("-" if is_joined else "")
    panel.plot(xs, values, style, color=COLOURS[0], linewidth=0.9, markersize=3)
    panel.set_ylabel(quantity.label)
    if not np.isfinite(values).any():
        panel.text(0.5, 0.5, "no values", transform=panel.transAxes, ha="center")


def curves(panel: Axes, *, quantity: Quantity) -> None:
    """A sampled component of about `CURVES` motions over time, from all over the sweep."""
    results, one = quantity.results, quantity.map
    motions = results.maps[quantity.name].reshape(-1, *one.shape)
    motions = motions[:: max(1, -(-len(motions) // CURVES)), quantity.index[0]]
    times = np.linspace(0, results.definition.duration, one.sample_count)
    shades = mpl.colormaps["viridis"](np.linspace(0, 0.9, len(motions)))
    for y, colour in zip(motions, shades, strict=True):
        panel.plot(times, y, color=colour, linewidth=0.7)
    panel.set(xlabel="$t$ / s", ylabel=quantity.label)


def section(panel: Axes, *, results: Results, name: str, selection: Any) -> None:
    """The crossings of some motions, a colour each: the second component over the first."""
    one, units = results.definition.maps[name], results.definition.module.UNITS
    motions = results.maps[name][selection].reshape(-1, *one.shape)
    motions = motions[np.isfinite(motions).any(axis=(1, 2))]
    (components,), (_, count) = one.labels, one.shape
    indices = 0, min(1, len(components) - 1)
    stride = max(1, -(-len(motions) * count // POINTS))
    # larger points where there are few
    size = float(np.clip(150 / np.sqrt(1 + np.isfinite(motions[:, 0]).sum()), 0.9, 4))
    shades = mpl.colormaps["nipy_spectral"](np.linspace(0.02, 0.95, len(motions)))
    for motion, colour in zip(motions[..., ::stride], shades, strict=True):
        x, y = (
            wrapped(motion[k]) if one.wraps_angles and units[components[k]] == "rad" else motion[k]
            for k in indices
        )
        panel.plot(x, y, ".", color=colour, markersize=size, markeredgewidth=0)
    x_label, y_label = (axis_label(symbol(components[k]), units[components[k]]) for k in indices)
    panel.set(xlabel=x_label, ylabel=y_label)
