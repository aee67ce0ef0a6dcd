"""Bifurcation diagrams: the values of a section over one quantity."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from solvers.sweeps.plots.quantity import Quantity, label_axis

#: Size and opacity of a point, and number of points on a panel for which they hold.
SIZE, OPACITY, DENSE = 1.3, 0.35, 20_000
#: Largest number of points.
POINTS = 1_000_000


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
