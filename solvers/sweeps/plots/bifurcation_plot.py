"""Bifurcation diagrams: states once a period over a parameter, upwards and downwards."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from solvers.io.figures import COLOURS
from solvers.sweeps.plots.plot_quantity import Quantity, label_axis

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
