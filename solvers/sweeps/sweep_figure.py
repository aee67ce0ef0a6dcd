"""Figures of sweeps: one or more panels for each map."""

from collections.abc import Callable, Iterator
from functools import partial
from itertools import product
from math import ceil, prod
from typing import Any, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solvers.io import figures
from solvers.io.figure_names import symbol
from solvers.io.quantity import with_unit
from solvers.sweeps.definition.sweep_checks import ENERGY
from solvers.sweeps.plot_quantity import Quantity, label_axis, letter
from solvers.sweeps.results import GOOD, Results
from solvers.sweeps.sweep_panels import CURVES, bifurcation, curves, image, line, response, section

#: Titles of panels, and the functions that draw them.
Panels: TypeAlias = Iterator[tuple[str, Callable[[Axes], None]]]
#: Largest number of panels.
MAX_PANELS = 12
#: Width and height in inches of the figure of a single panel.
ALONE = (8.4, 6.2)

#: Size and opacity of a point, and number of points on a panel for which they hold.
SIZE, OPACITY, DENSE = 1.3, 0.35, 20_000
#: Largest number of points.
POINTS = 1_000_000


def figure(results: Results) -> Figure:
    """All maps of a sweep, one or more panels each.

    Parameters
    ----------
    results : Results
        Maps, complete or so far.

    Returns
    -------
    matplotlib.figure.Figure
        Up to `MAX_PANELS` panels, three in a row, with remarks below.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> from solvers import EnergyError, Grid, Sweep, sweep
    >>> axes = Grid({"theta1": [0.1, 0.2, 0.3], "theta2": [0.0, 0.1]})
    >>> results = sweep(Sweep(dp, axes, {"drift": EnergyError()}, duration=5), "drift")
    >>> drift = figure(results)
    """
    definition = results.definition
    maps = definition.maps.items()
    every = [panel for name, one in maps for panel in PANELS[one.plot](name, results)]
    shown = every[:MAX_PANELS]
    columns = min(3, len(shown))
    rows = ceil(len(shown) / columns)
    title, size = definition.title.replace("$", r"\$"), (5.4 * columns, 4.9 * rows + 0.5)
    size = size if len(shown) > 1 else ALONE
    figure, axes = figures.panels(title, rows=rows, columns=columns, size=size)
    for panel, (subtitle, draw) in zip(axes, shown, strict=False):
        draw(panel)
        if len(shown) > 1:
            panel.set_title(subtitle, fontsize="medium")
    for panel in axes[len(shown) :]:
        panel.set_axis_off()
    remarks = [*_remarks(results)]
    if hidden := len(every) - len(shown):
        remarks.append(f"{hidden} more panels are not shown")
    figure.supxlabel("; ".join(remarks), x=0.01, ha="left", fontsize="small", color="#444444")
    return figure


def _remarks(results: Results) -> Iterator[str]:
    """Meaning of colours, number of curves, and motions with an unusual status."""
    definition, count = results.definition, results.count
    if "proved" in count:
        yield "white, inside the line: not enough energy"
    if "finished" in count and any(one.ends_motion for one in definition.maps.values()):
        yield f"grey or empty: no event within {definition.extent}"
    has_curves = any(one.plot == "curves" for one in definition.maps.values())
    if has_curves and definition.motions > CURVES:
        yield f"about {CURVES} of {definition.motions:,} motions over time"
    remarks = {name: one.remark(definition.module) for name, one in definition.maps.items()}
    several = len(remarks) > 1
    yield from (f"{name}: {text}" if several else text for name, text in remarks.items() if text)
    yield from (f"{name}: {n:,} motions" for name, n in count.items() if name not in GOOD)


def _numbers(name: str, results: Results) -> Panels:
    """A panel for each number of a map: an image over a grid, else a line or points."""
    one = results.definition.maps[name]
    is_image = results.definition.axes.is_grid and len(results.axes) > 1
    draw = image if is_image else line
    for index in np.ndindex(one.shape):
        parts = [labels[k] for labels, k in zip(one.labels, index, strict=False)]
        title = " ".join([name, *map(symbol, parts[:1]), *parts[1:]])
        yield title, partial(draw, quantity=Quantity(results, name, index))


def _curves(name: str, results: Results) -> Panels:
    """A panel for each component, with some of the motions over time."""
    for k, component in enumerate(results.definition.maps[name].labels[0]):
        quantity = Quantity(results, name, (k,))
        yield f"{name}: {symbol(component)}", partial(curves, quantity=quantity)


def _section(name: str, results: Results) -> Panels:
    """A panel of points for each energy and each set of parameters.

    Where these are more than `MAX_PANELS`, bifurcation diagrams over the longest of their axes.
    """
    axes, definition = results.axes, results.definition
    fixed = (ENERGY, *definition.module.PARAMETERS)
    names = [quantity for quantity in axes if quantity in fixed]
    over = max(names, key=lambda axis: len(axes[axis]), default="")
    if not definition.axes.is_grid:
        names = names if len(axes) == len(names) == 1 else []
    if prod(len(axes[quantity]) for quantity in names) <= MAX_PANELS:
        over = ""
    groups = [quantity for quantity in names if quantity != over]
    for indices in product(*(range(len(axes[quantity])) for quantity in groups)):
        group = dict(zip(groups, indices, strict=True))
        words = [
            f"{letter(q)} = {with_unit(axes[q][k], results.unit(q), 4)}" for q, k in group.items()
        ]
        selection: Any = tuple(group.get(quantity, slice(None)) for quantity in axes)
        selection = selection if definition.axes.is_grid else (...,)
        if not over:
            yield (
                ", ".join(words),
                partial(section, results=results, name=name, selection=selection),
            )
            continue
        for k, component in enumerate(definition.maps[name].labels[0]):
            quantity = Quantity(results, name, (k,))
            title = ", ".join([f"{name}: {symbol(component)}", *words])
            yield title, partial(diagram, quantity=quantity, axis=over, selection=selection)


def _response(name: str, results: Results) -> Panels:
    """A panel for each component."""
    for k, component in enumerate(results.definition.maps[name].labels[0]):
        draw = partial(response, results=results, name=name, component=k)
        yield f"{name}: {symbol(component)}", draw


def _bifurcation(name: str, results: Results) -> Panels:
    """A panel for each component and each set of values of the other axes."""
    *others, _ = results.axes
    for indices in np.ndindex(*(len(results.axes[axis]) for axis in others)):
        words = [
            f"{letter(q)} = {with_unit(results.axes[q][i], results.unit(q), 4)}"
            for q, i in zip(others, indices, strict=True)
        ]
        for k, component in enumerate(results.definition.maps[name].labels[0]):
            draw = partial(
                bifurcation,
                quantity=Quantity(results, name, (k,)),
                selection=(*indices, slice(None)),
            )
            yield ", ".join([f"{name}: {symbol(component)}", *words]), draw


#: Panels of each kind of plot.
PANELS = {
    "response": _response,
    "bifurcation": _bifurcation,
    "numbers": _numbers,
    "curves": _curves,
    "section": _section,
}


def diagram(panel: Axes, *, quantity: Quantity, axis: str, selection: tuple[Any, ...]) -> None:
    """All numbers of a component over the values of `axis`, for the motions of a selection.

    Points are translucent, so that shades of grey show how often a value occurs.
    """
    results = quantity.results
    values = quantity.values(selection)  # the axis first where it is a grid
    values = values.reshape(len(results.axes[axis]), -1)
    values = values[:, :: max(1, -(-values.size // POINTS))]
    x = np.repeat(results.axes[axis], values.shape[1])
    is_dense = values.size > DENSE
    size, opacity = (SIZE, OPACITY) if is_dense else (2 * SIZE, 0.8)
    panel.plot(x, values.ravel(), "o", color="black", markersize=size, alpha=opacity,
               markeredgewidth=0, rasterized=True)  # fmt: skip
    panel.set_ylabel(quantity.label)
    panel.margins(x=0.01)
    label_axis(panel, "x", results, axis)
