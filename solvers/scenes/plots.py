"""Plots of a scene: coordinates over time, phase curves, paths and the energy error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from math import ceil
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from solvers.io.figures import COLOURS, panels
from solvers.io.notation import axis_label, symbol
from solvers.scenes.checks import curves_of
from solvers.scenes.geometry import energy_errors, links, mass_positions, projected
from solvers.scenes.run import SceneResult

STYLES = ("-", "--", ":", "-.")
#: Smallest energy error on the logarithmic axis.
LEAST = 1e-17
#: Most panels in rows of three; more are in rows of four.
MOST = 6
#: Height of the title in inches.
TITLE = 0.22
#: Width of a panel and height of a row in inches, and characters of the note per inch.
PANEL, ROW, CHARACTERS = 4.6, 3.6, 15


def figure(results: Sequence[SceneResult]) -> Figure:
    """All plots of a scene and of those beside it, with the note below.

    Parameters
    ----------
    results : sequence of SceneResult
        The scene's own, then those of the scenes beside it; one at least.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each of the scene's ``pictures``, row by row; by default `default_pictures`.
    """
    main = results[0]
    pictures = main.scene.pictures or default_pictures(main)
    columns = min(len(pictures), 3 if len(pictures) <= MOST else 4)
    rows = ceil(len(pictures) / columns)
    width = max(PANEL * columns, 7.0)
    note, title = (
        _plain(fill(full_note(results), int(width * CHARACTERS))),
        _plain(main.scene.title),
    )
    size = (width, ROW * rows + 0.6 + 0.16 * note.count("\n"))
    chart, axes = panels(title, rows=rows, columns=columns, size=size)
    for panel, picture in zip(axes, pictures, strict=False):
        _draw(panel, picture, results)
        panel.xaxis.set_major_locator(MaxNLocator(6))
    handles, labels = axes[0].get_legend_handles_labels()
    legend: dict[str, Any] = {"frameon": False, "fontsize": "small"}
    if len(results) > 1:  # long labels, between the title and the panels
        chart.suptitle(title + "\n" * ceil(len(labels) / 2))
        legend |= {"bbox_to_anchor": (0.5, 1 - TITLE / chart.get_figheight())}
        chart.legend(handles, labels, loc="upper center", ncols=2, **legend)
    elif labels:
        axes[0].legend(**legend)
    for panel in axes[len(pictures) :]:
        panel.set_axis_off()
    chart.supxlabel(note, x=0.01, ha="left", fontsize="small", color="#444444")
    return chart


def _plain(text: str) -> str:
    """Text in which a dollar sign starts no formula."""
    return text.replace("$", r"\$")


def default_pictures(result: SceneResult) -> tuple[str, ...]:
    """Pictures of all coordinates and velocities that exist, of the path and the energy."""
    module = result.scene.module
    state, n, units = module.STATE, len(module.COORDINATES), module.UNITS
    indices = [k for k in range(n) if np.isfinite(result.y[[k, k + n]]).all()]
    coordinates, velocities = [state[k] for k in indices], [state[k + n] for k in indices]
    groups = [[q for q in coordinates if units[q] == u] for u in {units[q]: 0 for q in coordinates}]
    return (
        *(f"{', '.join(group)} over t" for group in groups),
        *(f"{v} over {q}" for q, v in zip(coordinates, velocities, strict=True)),
        *(f"{b} over {a}" for a, b in pairwise(coordinates)),
        *(f"{b} over {a}" for a, b in pairwise(velocities)),
        "path",
        "energy",
    )


def full_note(results: Sequence[SceneResult]) -> str:
    """The scene's note, and the model and error estimate of every run."""
    words = results[0].scene.note.split()
    return " ".join([*words, *(_accuracy_note(one, len(results) > 1) for one in results)])


def _accuracy_note(result: SceneResult, is_labelled: bool) -> str:
    """Model, method and error estimate in brackets, with the label if there are several runs."""
    model, scene = result.selection.model, result.scene
    text = model.name if result.method is None else f"{model.name} by {result.method}"
    if scene.step is not None:
        text += f" with h = {scene.step:g} s"
    label = f"{scene.label}: " if is_labelled else ""
    return f"[{label}{text}, error estimate {model.error_estimate:.1g}.]"


@dataclass(frozen=True)
class _Curve:
    """A run in a panel: its result, the colours of its curves, line style and label."""

    result: SceneResult
    colours: Sequence[str]
    style: str
    label: str

    def plot(self, panel: Axes, picture: str) -> None:
        """Add the curves of a picture to a panel."""
        if picture == "path":
            self._path(panel)
        elif picture == "energy":
            error = np.maximum(np.abs(energy_errors(self.result)), LEAST)
            options: dict[str, Any] = {"color": self.colours[0], "label": self.label}
            panel.semilogy(self.result.t, error, self.style, linewidth=0.9, **options)
        else:
            self._curves(panel, picture)

    def _curves(self, panel: Axes, picture: str) -> None:
        names, over = curves_of(picture)
        module, t = self.result.scene.module, self.result.t
        columns = dict(zip(module.STATE, self.result.y, strict=True)) | {"t": t}
        units = {**module.UNITS, "t": "s"}
        for name, colour in zip(names, self.colours, strict=False):
            words = filter(None, [symbol(name) if len(names) > 1 else "", self.label])
            options: dict[str, Any] = {"color": colour, "label": ", ".join(words)}
            panel.plot(columns[over], columns[name], self.style, linewidth=1.1, **options)
        if over == "t":
            panel.set_xlim(0, t[-1])
        panel.set(xlabel=axis_label(symbol(over), units[over]), ylabel=_labelled(names, units))

    def _path(self, panel: Axes) -> None:
        positions, label = mass_positions(self.result), self.label
        view = projected(positions)
        for (x, y), colour in zip(view, self.colours, strict=False):
            panel.plot(x, y, self.style, color=colour, linewidth=0.9, label=label)
            panel.plot(x[-1], y[-1], "o", color=colour, markersize=5)
            label = ""
        for pair in links(self.result, positions):
            ends = [np.zeros(2) if k < 0 else view[k, :, -1] for k in pair]
            panel.plot(*np.transpose(ends), color="#bbbbbb", linewidth=1.5, zorder=0)


def _draw(panel: Axes, picture: str, results: Sequence[SceneResult]) -> None:
    for n, (result, style) in enumerate(zip(results, STYLES * len(results), strict=False)):
        shift = 2 * n % len(COLOURS)  # two curves of a run have colours of their own
        label = _plain(result.scene.label) if len(results) > 1 else ""
        _Curve(result, COLOURS[shift:] + COLOURS[:shift], style, label).plot(panel, picture)
    if picture == "path":
        in_space = mass_positions(results[0]).shape[1] == 3
        x, y = ("horizontal", "vertical, oblique view") if in_space else ("x", "y")
        panel.set(xlabel=f"{x} / m", ylabel=f"{y} / m")
        panel.set_aspect("equal", adjustable="datalim")
        if "positions" not in results[0].scene.module.TIMED:  # else the pivot may move
            panel.plot(0, 0, "k+", markersize=8)
    elif picture == "energy":
        panel.set(xlabel=f"{symbol('t')} / s", ylabel="energy error / energy above rest")


def _labelled(names: Sequence[str], units: Mapping[str, str]) -> str:
    """Names with their units; one unit for those that share it."""
    groups = groupby(names, units.__getitem__)
    return ", ".join(axis_label(", ".join(map(symbol, group)), unit) for unit, group in groups)
