"""Pictures of a scene: coordinates over time, phase curves, paths and the energy's error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby, pairwise
from math import ceil
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from solvers.io.figures import COLOURS, panels
from solvers.io.notation import axis_label, symbol
from solvers.scenes.checks import curves_of
from solvers.scenes.geometry import energy_errors, links, places, projected
from solvers.scenes.run import SceneResult

STYLES = ("-", "--", ":", "-.")
#: Energy errors below this are drawn there: a logarithm has no zero.
LEAST = 1e-17
#: So many pictures at most stand three in a row, more four.
MOST = 6
#: Height of the title in inches.
TITLE = 0.22
#: Width of a panel and height of a row in inches, and characters of a note to the inch.
PANEL, ROW, WRITTEN = 4.6, 3.6, 15


def figure(results: Sequence[SceneResult]) -> Figure:
    """All that a scene has to show, with what is shown beside it; the note stands below.

    Parameters
    ----------
    results : sequence of SceneResult
        The scene's own, then those of the scenes beside it; one at least.

    Returns
    -------
    matplotlib.chart.Figure
        A panel for each of the scene's ``pictures``, row by row; without these, for everything
        that there is to see.
    """
    main = results[0]
    pictures = main.scene.pictures or default_pictures(main)
    columns = min(len(pictures), 3 if len(pictures) <= MOST else 4)
    rows = ceil(len(pictures) / columns)
    width = max(PANEL * columns, 7.0)
    words = [*main.scene.note.split(), *(accuracy_note(a, named=len(results) > 1) for a in results)]
    note = _plain(fill(" ".join(words), int(width * WRITTEN)))
    chart, axes = panels(
        _plain(main.scene.title), rows=rows, columns=columns,
        size=(width, ROW * rows + 0.6 + 0.16 * note.count("\n")),
    )  # fmt: skip
    for panel, picture in zip(axes, pictures, strict=False):
        _draw(panel, picture, results)
        panel.xaxis.set_major_locator(MaxNLocator(6))
    handles, labels = axes[0].get_legend_handles_labels()
    if len(results) > 1:  # long words, between the title and the curves
        chart.suptitle(_plain(main.scene.title) + "\n" * ceil(len(labels) / 2))
        below = 1 - TITLE / chart.get_figheight()
        chart.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, below), ncols=2,
                      frameon=False, fontsize="small")  # fmt: skip
    elif labels:
        axes[0].legend(frameon=False, fontsize="small")
    for panel in axes[len(pictures) :]:
        panel.set_axis_off()
    chart.supxlabel(note, x=0.01, ha="left", fontsize="small", color="#444444")
    return chart


def _plain(text: str) -> str:
    """Text in which a dollar sign is one, and begins no formula."""
    return text.replace("$", r"\$")


def default_pictures(result: SceneResult) -> tuple[str, ...]:
    """Everything that there is to see of what moves."""
    state, n = result.scene.module.STATE, len(result.scene.module.COORDINATES)
    there = [k for k in range(n) if np.isfinite(result.y[[k, k + n]]).all()]
    places, speeds = [state[k] for k in there], [state[k + n] for k in there]
    units = result.scene.module.UNITS
    return (
        *(
            f"{', '.join(place for place in places if units[place] == unit)} over t"
            for unit in dict.fromkeys(units[place] for place in places)
        ),
        *(f"{speed} over {place}" for place, speed in zip(places, speeds, strict=True)),
        *(f"{b} over {a}" for a, b in pairwise(places)),
        *(f"{b} over {a}" for a, b in pairwise(speeds)),
        "path",
        "energy",
    )


def accuracy_note(result: SceneResult, *, named: bool) -> str:
    """How a run was made and how sure it is, in brackets, with its name if it is one of several."""
    model = result.selection.model
    how = model.name if result.method is None else f"{model.name} by {result.method}"
    if result.scene.step is not None:
        how += f" with h = {result.scene.step:g} s"
    title = f"{result.scene.label}: " if named else ""
    return f"[{title}{how}, error estimate {model.error_estimate:.1g}.]"


def _draw(panel: Axes, picture: str, results: Sequence[SceneResult]) -> None:
    for n, (result, style) in enumerate(zip(results, STYLES * len(results), strict=False)):
        shift = 2 * n % len(COLOURS)  # two curves a run have colours of their own
        first = COLOURS[shift:] + COLOURS[:shift]
        label = _plain(result.scene.label) if len(results) > 1 else ""
        if picture == "path":
            _path(panel, result, first, style, label)
        elif picture == "energy":
            error = np.abs(energy_errors(result))
            panel.semilogy(result.t, np.maximum(error, LEAST), style, color=first[0], label=label,
                           linewidth=0.9)  # fmt: skip
        else:
            _curves(panel, picture, result, first, style, label)
    if picture == "path":
        in_space = places(results[0]).shape[1] == 3
        across, upwards = ("to the side", "up, seen from above") if in_space else ("x", "y")
        panel.set(xlabel=f"{across} / m", ylabel=f"{upwards} / m")
        panel.set_aspect("equal", adjustable="datalim")
        if "positions" not in results[0].scene.module.TIMED:  # else the pivot may move
            panel.plot(0, 0, "k+", markersize=8)
    elif picture == "energy":
        panel.set(xlabel=f"{symbol('t')} / s", ylabel="energy error / energy above rest")


def _curves(
    panel: Axes, picture: str, result: SceneResult, colours: Sequence[str], style: str, label: str
) -> None:
    names, over = curves_of(picture)
    columns = dict(zip(result.scene.module.STATE, result.y, strict=True)) | {"t": result.t}
    units = {**result.scene.module.UNITS, "t": "s"}
    for name, colour in zip(names, colours, strict=False):
        words = [symbol(name) if len(names) > 1 else "", label]
        panel.plot(columns[over], columns[name], style, color=colour, linewidth=1.1,
                   label=", ".join(filter(None, words)))  # fmt: skip
    if over == "t":
        panel.set_xlim(0, result.t[-1])
    panel.set(xlabel=axis_label(symbol(over), units[over]),
              ylabel=_labelled(names, units))  # fmt: skip


def _labelled(names: Sequence[str], units: Mapping[str, str]) -> str:
    """Names with their units; one unit for those that share it."""
    groups = groupby(names, units.__getitem__)
    return ", ".join(axis_label(", ".join(map(symbol, group)), unit) for unit, group in groups)


def _path(panel: Axes, result: SceneResult, colours: Sequence[str], style: str, label: str) -> None:
    positions = places(result)
    seen = projected(positions)
    for (x, y), colour in zip(seen, colours, strict=False):
        panel.plot(x, y, style, color=colour, linewidth=0.9, label=label)
        panel.plot(x[-1], y[-1], "o", color=colour, markersize=5)
        label = ""
    for a, b in links(result, positions):
        ends = [np.zeros(2) if k < 0 else seen[k, :, -1] for k in (a, b)]
        panel.plot(*np.transpose(ends), color="#bbbbbb", linewidth=1.5, zorder=0)
