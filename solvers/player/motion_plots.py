"""Links in figures: lines and areas through points of the plane of view."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import cycle, groupby, pairwise
from math import ceil
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from solvers.equations.module import depends_on_time, links
from solvers.io.figure_names import axis_label, symbol
from solvers.io.figures import COLOURS, panels
from solvers.player.sampled_motion import (
    SampledMotion,
    curves_of,
    energy_errors,
    links_and_points,
    mass_positions,
    projected,
)
from solvers.player.track import Array

#: Width of the line of each kind in points.
WIDTHS = {
    "rod": 1.8,
    "thread": 0.9,
    "spring": 1.0,
    "rail": 0.7,
    "plate": 1.2,
    "ring": 1.2,
    "wheel": 1.2,
}
#: Kinds that cover what is behind them.
AREAS = ("plate", "wheel")
TEETH = 16


def draw_link(
    axes: Axes, kind: str, points: Array, size: float, colour: str, alpha: float = 1.0
) -> None:
    """Draw a link through points of shape (points, 2) below curves, in a picture of a size in m."""
    x, y = outline(kind, points, size).T
    if kind in AREAS:
        axes.fill(x, y, facecolor=colour, alpha=0.15 * alpha, linewidth=0, zorder=0)
    line = Line2D(x, y, color=colour, linewidth=WIDTHS[kind], alpha=alpha, zorder=0)
    line.set_solid_joinstyle("round")
    if kind == "rail":  # without ends, so that it determines no limits of the axes
        axes.add_artist(line)
    else:
        axes.add_line(line)
    axes.autoscale_view()


def outline(kind: str, points: Array, size: float) -> Array:
    """The line of a link, shape (any, 2); that of a wheel starts with its spoke."""
    match kind:
        case "spring":
            return np.concatenate([_zigzag(*ends, size / 50) for ends in pairwise(points)])
        case "ring":
            return _ellipse(points)
        case "wheel":
            return np.concatenate([points[:1], _ellipse(points)])
        case "plate":
            return np.concatenate([points, points[:1]])
        case "rail":
            along = points[1] - points[0]
            far = 100 * size / max(float(np.hypot(*along)), 1e-9 * size)
            return np.stack([points[0] - far * along, points[0] + far * along])
    return points


def _ellipse(points: Array) -> Array:
    """A circle from any direction: of its centre, and two points of it a quarter turn apart."""
    centre, first, second = points
    angle = np.linspace(0, 2 * np.pi, 65)[:, None]
    return np.asarray(centre + np.cos(angle) * (first - centre) + np.sin(angle) * (second - centre))


def _zigzag(start: Array, end: Array, width: float) -> Array:
    """A spring, whose number of teeth does not depend on its length."""
    along = end - start
    across = np.array([-along[1], along[0]]) * width / (np.hypot(*along) or 1.0)
    parts = 0.1 + 0.8 * (np.arange(TEETH) + 0.5) / TEETH
    sides = np.where(np.arange(TEETH) % 2, 1.0, -1.0)
    teeth = start + parts[:, None] * along + sides[:, None] * across
    return np.stack([start, start + 0.1 * along, *teeth, start + 0.9 * along, end])


#: The name of a curve if there are several, its horizontal and its vertical values.
Curve = tuple[str, Array, Array]
STYLES = ("-", "--", ":", "-.")
#: Smallest energy error on the logarithmic axis, and most panels in rows of three instead of four.
LEAST, MOST = 1e-17, 6
#: Width of a panel, heights of a row and the title in inches, and characters of the note per inch.
PANEL, ROW, TITLE, CHARACTERS = 4.6, 3.6, 0.22, 15


def figure(motions: Sequence[SampledMotion]) -> Figure:
    """All plots of a motion and of those beside it, with the note below.

    Parameters
    ----------
    motions : sequence of SampledMotion
        The first of them has the title, the note and the pictures; one at least.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each of the ``pictures``, row by row; by default `default_pictures`.
    """
    main = motions[0]
    pictures = main.pictures or default_pictures(main)
    columns = min(len(pictures), 3 if len(pictures) <= MOST else 4)
    rows = ceil(len(pictures) / columns)
    width = max(PANEL * columns, 7.0)
    note = plain(fill(main.note, int(width * CHARACTERS)))
    title = plain(main.title)
    size = (width, ROW * rows + 0.6 + 0.16 * note.count("\n"))
    chart, axes = panels(title, rows=rows, columns=columns, size=size)
    for panel, picture in zip(axes, pictures, strict=False):
        _draw(panel, picture, motions)
        panel.xaxis.set_major_locator(MaxNLocator(6))
    handles, labels = axes[0].get_legend_handles_labels()
    legend: dict[str, Any] = {"frameon": False, "fontsize": "small"}
    if len(motions) > 1:  # long labels, between the title and the panels
        chart.suptitle(title + "\n" * ceil(len(labels) / 2))
        legend |= {"bbox_to_anchor": (0.5, 1 - TITLE / chart.get_figheight())}
        chart.legend(handles, labels, loc="upper center", ncols=2, **legend)
    elif labels:
        axes[0].legend(**legend)
    for panel in axes[len(pictures) :]:
        panel.set_axis_off()
    chart.supxlabel(note, x=0.01, ha="left", fontsize="small", color="#444444")
    return chart


def plain(text: str) -> str:
    """Text in which a dollar sign starts no formula."""
    return text.replace("$", r"\$")


def default_pictures(motion: SampledMotion) -> tuple[str, ...]:
    """Pictures of all coordinates and velocities that exist, of the path and the energy."""
    module = motion.module
    state, n, units = module.STATE, len(module.COORDINATES), module.UNITS
    indices = [k for k in range(n) if np.isfinite(motion.y[[k, k + n]]).all()]
    coordinates, velocities = [state[k] for k in indices], [state[k + n] for k in indices]
    groups = [[q for q in coordinates if units[q] == u] for u in {units[q]: 0 for q in coordinates}]
    return (
        *(f"{', '.join(group)} over t" for group in groups),
        *(f"{v} over {q}" for q, v in zip(coordinates, velocities, strict=True)),
        *(f"{b} over {a}" for a, b in pairwise(coordinates)),
        *(f"{b} over {a}" for a, b in pairwise(velocities)),
        "path",
        *(["energy"] if motion.energy is not None else []),
    )


def _draw(panel: Axes, picture: str, motions: Sequence[SampledMotion]) -> None:
    width = 0.9 if picture in ("path", "energy") else 1.1
    runs = zip(motions, _runs(motions, picture), cycle(STYLES), strict=False)
    for n, (motion, curves, style) in enumerate(runs):
        shift = 2 * n % len(COLOURS)  # two curves of a run have colours of their own
        colours = COLOURS[shift:] + COLOURS[:shift]
        label = plain(motion.label) if len(motions) > 1 else ""
        for (name, x, y), colour in zip(curves, colours, strict=False):
            text = ", ".join(filter(None, [name, label]))
            panel.plot(x, y, style, color=colour, linewidth=width, label=text)
            if picture == "path":
                panel.plot(x[-1], y[-1], "o", color=colour, markersize=5)
                label = ""
        if picture == "path":
            _draw_links(panel, motion)
    label_axes(panel, picture, motions)


def _runs(motions: Sequence[SampledMotion], picture: str) -> Iterator[list[Curve]]:
    """The curves of each run."""
    if picture == "energy":
        for motion, error in zip(motions, energy_errors(motions)[0], strict=True):
            yield [] if error is None else [("", motion.t, np.maximum(np.abs(error), LEAST))]
    else:
        for motion in motions:
            yield _curves(motion, picture)


def _curves(motion: SampledMotion, picture: str) -> list[Curve]:
    if picture == "path":
        return [("", x, y) for x, y in projected(mass_positions(motion))]
    names, over = curves_of(picture)
    columns = {"t": motion.t, **dict(zip(motion.module.STATE, motion.y, strict=True))}
    return [(symbol(q) if len(names) > 1 else "", columns[over], columns[q]) for q in names]


def _draw_links(panel: Axes, motion: SampledMotion) -> None:
    """The links at the end of the motion."""
    links, points = links_and_points(motion)
    masses = projected(mass_positions(motion))
    size = float(np.ptp(masses, axis=(0, 2)).max()) or 1.0
    # the last one is the origin, -1
    places = np.concatenate([masses[..., -1], projected(points)[..., -1], np.zeros((1, 2))])
    for kind, numbers in links:
        draw_link(panel, kind, places[[*numbers]], size, "#999999")


def label_axes(panel: Axes, picture: str, motions: Sequence[SampledMotion]) -> None:
    """Label the axes of a picture of runs, and scale them."""
    module = motions[0].module
    if picture == "path":
        in_space = mass_positions(motions[0]).shape[1] == 3
        x, y = ("horizontal", "vertical, oblique view") if in_space else ("x", "y")
        panel.set(xlabel=f"{x} / m", ylabel=f"{y} / m")
        panel.set_aspect("equal", adjustable="datalim")
        pivot_may_move = depends_on_time(module, "positions") or links(module)
        if not pivot_may_move:
            panel.plot(0, 0, "k+", markersize=8)
    elif picture == "energy":
        label = axis_label("energy error", energy_errors(motions)[1])
        panel.set(yscale="log", xlabel=f"{symbol('t')} / s", ylabel=label)
    else:
        names, over = curves_of(picture)
        units = {**module.UNITS, "t": "s"}
        panel.set(xlabel=axis_label(symbol(over), units[over]), ylabel=_labelled(names, units))
        if over == "t":
            panel.set_xlim(motions[0].t[0], motions[0].t[-1])


def _labelled(names: Sequence[str], units: Mapping[str, str]) -> str:
    """Names with their units; one unit for those that share it."""
    groups = groupby(names, units.__getitem__)
    return ", ".join(axis_label(", ".join(map(symbol, group)), unit) for unit, group in groups)
