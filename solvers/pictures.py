"""Pictures: of a run, and how every picture is begun and saved."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray

mpl.use("Agg")  # files only: no window, no display needed

from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solvers.written import written

#: Wong's palette, told apart by colour-blind eyes (Nature Methods 8, 441, 2011).
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")

Array = NDArray[np.float64]


def overview(
    path: Path,
    t: Array,
    angles: Array,
    names: Sequence[str],
    paths: Array,
    energy: Array,
    title: str,
) -> None:
    """Angles over time, the masses' paths and the energy's error, in one file.

    Parameters
    ----------
    path : Path
        The picture, a PNG file; it is written beside its name and moved into place.
    t : ndarray of shape (n,)
        Times in s.
    angles : ndarray of shape (coordinates, n)
        Angles in rad, with their `names`.
    names : sequence of str
        What to call them.
    paths : ndarray of shape (masses, 2, n)
        Positions in m.
    energy : ndarray of shape (n,)
        Energy in J.
    title : str
        Title of the whole picture.
    """  # fmt: skip
    figure = plt.figure(figsize=(10, 5), layout="constrained")
    figure.suptitle(title)
    grid = figure.add_gridspec(2, 2, width_ratios=(3, 2))
    over_time = figure.add_subplot(grid[0, 0], ylabel="angle / rad")
    drift = figure.add_subplot(grid[1, 0], sharex=over_time, xlabel="time / s",
                               ylabel="energy error / J")  # fmt: skip
    space = figure.add_subplot(grid[:, 1], xlabel="x / m", ylabel="y / m", aspect="equal")
    for row, name, colour in zip(angles, names, COLOURS, strict=False):
        over_time.plot(t, row, color=colour, label=name)
    over_time.legend(frameon=False)
    drift.plot(t, energy - energy[0], color="#555555")
    for (x, y), colour in zip(paths, COLOURS, strict=False):
        space.plot(x, y, color=colour, linewidth=1)
        space.plot(x[-1], y[-1], "o", color=colour)
    space.plot(0, 0, "k+", markersize=10)
    save(figure, path)


def panels(
    title: str, *, rows: int = 1, columns: int = 1, size: tuple[float, float] = (10, 5)
) -> tuple[Figure, list[Axes]]:  # fmt: skip
    """A figure with a title and axes, row by row."""
    figure, axes = plt.subplots(rows, columns, figsize=size, layout="constrained", squeeze=False)
    figure.suptitle(title)
    return figure, list(axes.flat)


def save(figure: Figure, path: Path) -> None:
    """Write a figure as a PNG file, beside its name first, and close it."""
    for axes in figure.axes:
        axes.spines[["top", "right"]].set_visible(False)
    drawn = BytesIO()
    figure.savefig(drawn, format="png", dpi=120, metadata={"Software": None})
    plt.close(figure)
    written(path, drawn.getvalue())
