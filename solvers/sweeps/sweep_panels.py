"""Contents of a panel: images, lines, curves over time, sections, responses, bifurcations."""

from collections.abc import Iterator, Mapping
from itertools import product
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, to_rgba

from solvers.equations.module import has_function
from solvers.io.figure_names import axis_label, symbol
from solvers.io.figures import COLOURS
from solvers.io.quantity import with_unit
from solvers.sweeps.barrier import barrier, energies
from solvers.sweeps.definition.axes import Array, Grid
from solvers.sweeps.execution.initial_states import initial_states
from solvers.sweeps.plot_quantity import Quantity, add_legend, label_axis, letter, wrapped
from solvers.sweeps.results import PROVED, Results

#: Where nothing happened or nothing is known, and where it is proved that nothing can happen.
NOTHING, NEVER = "#c8c8c8", "#ffffff"
#: Largest number of pixels along each side of an image, and points along those of a boundary.
PIXELS, BOUNDARY = 2048, 400
#: Largest number of values with markers, of curves, and of points of a section.
MARKED, CURVES, POINTS = 100, 60, 200_000


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
    add_legend(panel, mappable, quantity)
    for record in results.records.get(quantity.name, []):
        if all(name in record["states"][0] for name in (x, y)):
            points = ([state[name] for state in record["states"]] for name in (x, y))
            panel.plot(*points, "o", color=NEVER, markeredgecolor="black", markersize=5)
    label_axis(panel, "x", results, x)
    label_axis(panel, "y", results, y)
    if fixed:
        at = (f"{letter(q)} = {with_unit(v, results.unit(q), 4)}" for q, v in fixed.items())
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
        add_legend(panel, points, quantity)
        label_axis(panel, "y", results, y)
        return
    is_joined = results.definition.axes.is_grid and not quantity.is_direction
    is_joined &= not quantity.classes
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
    times = results.definition.times([])[1][0]
    shades = mpl.colormaps["viridis"](np.linspace(0, 0.9, len(motions)))
    for y, colour in zip(motions, shades, strict=True):
        panel.plot(times, y, color=colour, linewidth=0.7)
    panel.set(xlabel="$t$ / s", ylabel=quantity.label)


def section(panel: Axes, *, results: Results, name: str, selection: Any) -> None:
    """The crossings of some motions, a colour each: the second component over the first.

    A single component is plotted over the number of the point.
    """
    one, units = results.definition.maps[name], results.definition.module.UNITS
    motions = results.maps[name][selection].reshape(-1, *one.shape)
    motions = motions[np.isfinite(motions).any(axis=(1, 2))]
    (components,), (_, count) = one.labels, one.shape
    indices = range(min(2, len(components)))
    stride = max(1, -(-len(motions) * count // POINTS))
    # larger points where there are few
    size = float(np.clip(150 / np.sqrt(1 + np.isfinite(motions[:, 0]).sum()), 1.1, 4))
    shades = mpl.colormaps["nipy_spectral"](np.linspace(0.02, 0.95, len(motions)))
    if has_function(results.definition.module, "power"):  # motions share their attractors
        shades[:] = to_rgba("black")
    for motion, colour in zip(motions[..., ::stride], shades, strict=True):
        points = [
            wrapped(motion[k]) if one.wraps_angles and units[components[k]] == "rad" else motion[k]
            for k in indices
        ]
        numbers = [] if points[1:] else [1 + stride * np.arange(len(points[0]))]
        panel.plot(*numbers, *points, ".", color=colour, markersize=size, markeredgewidth=0)
    labels = [axis_label(symbol(components[k]), units[components[k]]) for k in indices]
    x_label, y_label = labels if labels[1:] else ("number of the point", *labels)
    panel.set(xlabel=x_label, ylabel=y_label)


#: Colours of the directions.
DIRECTIONS = {"down": COLOURS[1], "up": COLOURS[0]}
#: Size of points, and number of them in a direction from which on they are smaller.
LARGE, SMALL, DENSE = 2.6, 1.3, 20_000


def bifurcation(panel: Axes, *, quantity: Quantity, selection: tuple[Any, ...]) -> None:
    """States of a component in both directions; where both are equal, those upwards are seen."""
    results = quantity.results
    *_, along = results.axes
    values = quantity.values(selection)
    x = np.repeat(results.axes[along], values.shape[1])
    size = SMALL if x.size > DENSE else LARGE
    for k, (direction, colour) in zip((1, 0), DIRECTIONS.items(), strict=True):
        panel.plot(x, values[..., k].ravel(), "o", color=colour, markersize=size,
                   markeredgewidth=0, label=direction, rasterized=True)  # fmt: skip
    panel.set_ylabel(quantity.label)
    panel.margins(x=0.01)
    panel.legend(frameon=False, fontsize="small", markerscale=3)
    label_axis(panel, "x", results, along)


#: Line and marker of each direction.
STYLES = {"up": ("-", ">"), "down": ("--", "<")}
#: Largest number of sets of parameters in a legend, and of curves.
MAX_LABELS, MAX_CURVES = 8, 60


def response(panel: Axes, *, results: Results, name: str, component: int) -> None:
    """Amplitudes of a component in both directions, for each value of the other axes."""
    *_, along = results.axes
    one, x = results.definition.maps[name], results.axes[along]
    curves = [*_curves(results, name, component)]
    curves = curves[:: -(-len(curves) // MAX_CURVES)]
    shades = [*COLOURS[:2]] if len(curves) == 1 else []
    ramp = mpl.colormaps["viridis"](np.linspace(0, 0.9, len(curves)))
    every = max(1, len(x) // 25)
    for k, (words, numbers) in enumerate(curves):
        for d, (direction, (line, marker)) in enumerate(STYLES.items()):
            colour = shades[d] if shades else ramp[k]
            label = direction if shades else words if d == 0 and k < MAX_LABELS else None
            panel.plot(x, numbers[:, d], line, marker=marker, markevery=(d * every // 2, every),
                       color=colour, label=label, linewidth=1.1, markersize=4)  # fmt: skip
    if not shades:
        for direction, (line, marker) in STYLES.items():
            panel.plot([], [], line, marker=marker, color="black", markersize=4, label=direction)
    component_name = one.labels[0][component]
    unit = one.unit(results.definition.module, component_name)
    panel.set_ylabel(axis_label(f"amplitude of {symbol(component_name)}", unit))
    panel.set_ylim(bottom=0)
    panel.legend(frameon=False, fontsize="small")
    label_axis(panel, "x", results, along)


def _curves(results: Results, name: str, component: int) -> Iterator[tuple[str, Array]]:
    """Values of the other axes in words, and amplitudes of shape (values, directions)."""
    *others, _ = results.axes
    for indices in product(*(range(len(results.axes[axis])) for axis in others)):
        at = zip(others, indices, strict=True)
        words = (
            f"{letter(q)} = {with_unit(results.axes[q][k], results.unit(q), 4)}" for q, k in at
        )
        selection: Any = (*indices, slice(None), component)
        yield ", ".join(words), np.asarray(results.maps[name][selection])
