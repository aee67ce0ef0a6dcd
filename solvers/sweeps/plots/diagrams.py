"""Responses and bifurcation diagrams: values over a parameter, upwards and downwards."""

from collections.abc import Iterator
from itertools import product
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from solvers.io.figure_names import axis_label, symbol
from solvers.io.figures import COLOURS
from solvers.io.quantity import with_unit
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.plots.plot_quantity import Quantity, label_axis, letter
from solvers.sweeps.results import Results

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
