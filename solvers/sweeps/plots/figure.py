"""Pictures of sweeps: a panel or more for each map."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import product
from math import ceil
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solvers.io.figures import panels
from solvers.io.notation import symbol
from solvers.sweeps.axes import Grid
from solvers.sweeps.checks import ENERGY
from solvers.sweeps.maps import First, Samples, Section
from solvers.sweeps.plots.image import image
from solvers.sweeps.plots.labels import letter
from solvers.sweeps.plots.lines import CURVES, curves, line, section
from solvers.sweeps.results import Results

#: Panels at most.
MOST = 12


def drawn(results: Results) -> Figure:
    """All maps of a sweep, a panel or more each.

    Parameters
    ----------
    results : Results
        What it has found, whole or so far.

    Returns
    -------
    matplotlib.figure.Figure
        Up to `MOST` panels, three in a row; what the colours do not say stands below.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> from solvers.sweeps.axes import Grid
    >>> from solvers.sweeps.maps import EnergyError
    >>> from solvers.sweeps.run import sweep
    >>> from solvers.sweeps.sweep import Sweep
    >>> axes = Grid({"theta1": [0.1, 0.2, 0.3], "theta2": [0.0, 0.1]})
    >>> results = sweep(Sweep(dp, axes, {"drift": EnergyError()}, duration=5), "drift")
    >>> figure = drawn(results)
    """
    every = list(_panels(results))
    found = every[:MOST]
    columns = min(3, len(found))
    rows = ceil(len(found) / columns)
    figure, axes = panels(
        results.asked.title.replace("$", r"\$"), rows=rows, columns=columns,
        size=(max(6.4, 5.4 * columns), 4.9 * rows + 0.5),
    )  # fmt: skip
    for panel, (title, draw) in zip(axes, found, strict=False):
        draw(panel)
        if len(found) > 1:
            panel.set_title(title, fontsize="medium")
    for panel in axes[len(found) :]:
        panel.set_axis_off()
    hidden = f"{len(every) - MOST} more panels are not drawn" if len(every) > MOST else ""
    note = "; ".join(filter(None, [*_notes(results), hidden]))
    figure.supxlabel(note, x=0.01, ha="left", fontsize="small", color="#444444")
    return figure


def _notes(results: Results) -> Iterator[str]:
    """What the colours do not say."""
    asked, count = results.asked, results.count
    if any(isinstance(one, First) for one in asked.maps.values()):
        if "proved" in count:
            yield "white, inside the line: too little energy for it"
        if "finished" in count:
            yield f"grey or nothing: not within {asked.duration:g} s"
    if any(type(one) is Samples for one in asked.maps.values()) and asked.motions > CURVES:
        yield f"about {CURVES} of {asked.motions:,} motions over time"
    usual = ("finished", "event", "proved")
    yield from (f"{name}: {n:,} motions" for name, n in count.items() if name not in usual)


def _panels(results: Results) -> Iterator[tuple[str, Callable[[Axes], None]]]:
    """What each panel is called, and what draws it."""
    for name, one in results.asked.maps.items():
        if isinstance(one, Section):
            for where, chosen in _groups(results):
                yield where, partial(section, results=results, name=name, chosen=chosen)
        elif isinstance(one, Samples):
            for k, component in enumerate(one.of):
                title = f"{name}: {symbol(component)}"
                yield title, partial(curves, results=results, name=name, k=k)
        else:
            is_image = isinstance(results.asked.axes, Grid) and len(results.axes) > 1
            draw = image if is_image else line
            for place in product(*map(range, one.shape)):
                parts = [labels[k] for labels, k in zip(one.labels, place, strict=True)]
                title = " ".join([name, *map(symbol, parts[:1]), *parts[1:]])
                yield title, partial(draw, results=results, name=name, place=place)


def _groups(results: Results) -> Iterator[tuple[str, Any]]:
    """Motions that belong in one section: of one energy and one set of parameters."""
    axes = results.axes
    if not isinstance(results.asked.axes, Grid):
        yield "", ...
        return
    apart = [name for name in axes if name in (ENERGY, *results.asked.module.PARAMETERS)]
    for place in product(*(range(len(axes[name])) for name in apart)):
        where = dict(zip(apart, place, strict=True))
        words = (f"{letter(q)} = {axes[q][k]:.4g} {results.unit(q)}" for q, k in where.items())
        yield ", ".join(words), tuple(where.get(name, slice(None)) for name in axes)
