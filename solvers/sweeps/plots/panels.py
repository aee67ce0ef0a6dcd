"""Panels of a map: their titles, and functions that draw them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from solvers.io.notation import symbol
from solvers.sweeps.checks import ENERGY
from solvers.sweeps.maps import Panels
from solvers.sweeps.plots.image import image
from solvers.sweeps.plots.labels import letter
from solvers.sweeps.plots.lines import curves, line, section
from solvers.sweeps.plots.quantity import Quantity
from solvers.sweeps.results import Results


def number_panels(name: str, results: Results) -> Panels:
    """A panel for each number of a map: an image over a grid, else a line or points."""
    one = results.definition.maps[name]
    is_image = results.definition.axes.is_grid and len(results.axes) > 1
    draw = image if is_image else line
    for index in np.ndindex(one.shape):
        parts = [labels[k] for labels, k in zip(one.labels, index, strict=False)]
        title = " ".join([name, *map(symbol, parts[:1]), *parts[1:]])
        yield title, partial(draw, quantity=Quantity(results, name, index))


def curve_panels(name: str, results: Results) -> Panels:
    """A panel for each component, with some of the motions over time."""
    (components,) = results.definition.maps[name].labels
    for k, component in enumerate(components):
        quantity = Quantity(results, name, (k,))
        yield f"{name}: {symbol(component)}", partial(curves, quantity=quantity)


def section_panels(name: str, results: Results) -> Panels:
    """A panel of crossings for each energy and each set of parameters."""
    for title, selection in _groups(results):
        yield title, partial(section, results=results, name=name, selection=selection)


def _groups(results: Results) -> Iterator[tuple[str, Any]]:
    """Titles and indices of motions with the same energy and parameters."""
    axes = results.axes
    if not results.definition.axes.is_grid:
        yield "", ...
        return
    names = [name for name in axes if name in (ENERGY, *results.definition.module.PARAMETERS)]
    for indices in product(*(range(len(axes[name])) for name in names)):
        group = dict(zip(names, indices, strict=True))
        words = (f"{letter(q)} = {axes[q][k]:.4g} {results.unit(q)}" for q, k in group.items())
        yield ", ".join(words), tuple(group.get(name, slice(None)) for name in axes)
