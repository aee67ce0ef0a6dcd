"""Links in figures: lines and areas through points of the plane of view."""

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

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
