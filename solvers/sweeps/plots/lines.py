"""Panels of lines and points: maps over one axis, motions over time, Poincaré's sections."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from solvers.io.figures import COLOURS
from solvers.io.notation import axis_label, symbol
from solvers.sweeps.axes import Grid
from solvers.sweeps.maps import Final, Samples, Section
from solvers.sweeps.plots.colours import NOTHING, colours, is_direction, shown
from solvers.sweeps.plots.labels import bar, label, what
from solvers.sweeps.results import Results

#: Curves that are drawn, points that are marked, and points of a section.
CURVES, MARKED, POINTS = 60, 100, 200_000


def line(panel: Axes, *, results: Results, name: str, place: tuple[int, ...]) -> None:
    """One number of each motion over what varies; over two things, coloured points."""
    one, module = results.asked.maps[name], results.asked.module
    part = one.labels[0][place[0]] if place else ""
    unit = module.UNITS[part] if part else one.unit(module)
    cut: Any = (..., *place)
    values = shown(one, results.maps[name][cut], unit)
    (x, xs), *others = results.axes.items()
    label(panel, "x", results, x)
    if len(others) == 1:
        ((y, ys),) = others
        palette, norm = colours(one, values, unit)
        unknown = np.isnan(values)
        panel.scatter(xs[unknown], ys[unknown], color=NOTHING, s=4)
        points = panel.scatter(xs, ys, c=values, s=4, cmap=palette, norm=norm)
        bar(panel, points, what(one, name, part, unit))
        label(panel, "y", results, y)
        return
    joined = isinstance(results.asked.axes, Grid) and not is_direction(one, unit)
    is_marked = not joined or len(values) <= MARKED or np.isnan(values).any()
    style = ("." if is_marked else "") + ("-" if joined else "")
    panel.plot(xs, values, style, color=COLOURS[0], linewidth=0.9, markersize=3)
    panel.set_ylabel(what(one, name, part, unit))
    if not np.isfinite(values).any():
        panel.text(0.5, 0.5, "nothing", transform=panel.transAxes, ha="center")


def curves(panel: Axes, *, results: Results, name: str, k: int) -> None:
    """A component of some motions over time."""
    one: Any = results.asked.maps[name]
    assert isinstance(one, Samples)
    motions = results.maps[name].reshape(-1, *one.shape)
    some = motions[:: max(1, -(-len(motions) // CURVES)), k]
    times = np.linspace(0, results.asked.duration, one.count)
    shades = mpl.colormaps["viridis"](np.linspace(0, 0.9, len(some)))
    for y, colour in zip(some, shades, strict=True):
        panel.plot(times, y, color=colour, linewidth=0.7)
    panel.set(xlabel="$t$ / s", ylabel=_component(results, one.of[k]))


def section(panel: Axes, *, results: Results, name: str, chosen: Any) -> None:
    """The crossings of some motions, a colour each: the second component over the first."""
    one: Any = results.asked.maps[name]
    assert isinstance(one, Section)
    motions = results.maps[name][chosen].reshape(-1, *one.shape)
    motions = motions[np.isfinite(motions).any(axis=(1, 2))]
    x, y = one.of[0], one.of[min(1, len(one.of) - 1)]
    each = max(1, -(-len(motions) * one.count // POINTS))
    # few points are large ones
    size = float(np.clip(150 / np.sqrt(1 + np.isfinite(motions[:, 0]).sum()), 0.9, 4))
    shades = mpl.colormaps["nipy_spectral"](np.linspace(0.02, 0.95, len(motions)))
    for motion, colour in zip(motions[..., ::each], shades, strict=True):
        across, upwards = (
            shown(Final(()), motion[one.of.index(part)], results.asked.module.UNITS[part])
            for part in (x, y)
        )
        panel.plot(across, upwards, ".", color=colour, markersize=size, markeredgewidth=0)
    panel.set(xlabel=_component(results, x), ylabel=_component(results, y))


def _component(results: Results, name: str) -> str:
    return axis_label(symbol(name), results.asked.module.UNITS[name])
