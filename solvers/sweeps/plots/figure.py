"""Figures of sweeps: one or more panels for each map."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil

from matplotlib.figure import Figure

from solvers.io.figures import panels
from solvers.sweeps.plots.lines import CURVES
from solvers.sweeps.results import Results

#: Largest number of panels.
MAX_PANELS = 12


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
    every = [panel for name, one in definition.maps.items() for panel in one.panels(name, results)]
    shown = every[:MAX_PANELS]
    columns = min(3, len(shown))
    rows = ceil(len(shown) / columns)
    title, size = definition.title.replace("$", r"\$"), (max(6.4, 5.4 * columns), 4.9 * rows + 0.5)
    figure, axes = panels(title, rows=rows, columns=columns, size=size)
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
    kinds = definition.maps.values()
    if "proved" in count:
        yield "white, inside the line: not enough energy"
    if "finished" in count and any(one.ends_motion for one in kinds):
        yield f"grey or empty: no event within {definition.duration:g} s"
    if definition.samples and definition.motions > CURVES:
        yield f"about {CURVES} of {definition.motions:,} motions over time"
    usual = ("finished", "event", "proved")
    yield from (f"{name}: {n:,} motions" for name, n in count.items() if name not in usual)
