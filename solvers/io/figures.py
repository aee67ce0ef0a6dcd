"""Figures: creation, style and files."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.text import Text

from solvers.io.argument_types import check_type
from solvers.io.atomic_write import write_text
from solvers.io.suggestion import shortened

#: Wong's palette for colour-blind readers (Nature Methods 8, 441, 2011).
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
#: Paper, and text on a dark page.
WHITE, LIGHT = (1.0, 1.0, 1.0), "#e7e9eb"
#: Most rows or columns of a figure.
MOST_PANELS = 100

Value = TypeVar("Value")


def panels(
    title: str, *, rows: int = 1, columns: int = 1, size: tuple[float, float] = (10, 5)
) -> tuple[Figure, list[Axes]]:
    """A figure with a title and a grid of axes.

    Parameters
    ----------
    title : str
        Title of the figure; text between dollar signs is TeX.
    rows, columns : int, optional
        Number of rows and columns of axes.
    size : pair of float, optional
        Width and height in inches.

    Returns
    -------
    figure : matplotlib.figure.Figure
        A figure without a window; `save` writes it.
    axes : list of matplotlib.axes.Axes
        Rows times columns of them, row by row.

    Examples
    --------
    >>> figure, axes = panels("Two panels", columns=2)
    >>> len(axes)
    2
    """
    check_type("title", title, str, "a text")
    check_type("size", size, tuple | list, "width and height in inches")
    for name, number in (("rows", rows), ("columns", columns)):
        if type(number) is not int or not 0 < number <= MOST_PANELS:
            allowed = f"must be a whole number from 1 to {MOST_PANELS}"
            raise ValueError(f"{name} = {shortened(number)} {allowed}")
    # without pyplot, which needs a display and keeps every figure
    figure = Figure(size, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    figure.suptitle(title, wrap=True)
    return figure, list(axes.flat)


def coloured(values: Iterable[Value]) -> Iterator[tuple[Value, str]]:
    """The first seven different values, each with a colour of its own."""
    return zip(dict.fromkeys(values), COLOURS, strict=False)


def colours(count: int) -> list[str]:
    """So many colours, which repeat after the seventh."""
    return [COLOURS[k % len(COLOURS)] for k in range(count)]


def columns(rows: Sequence[object], *names: str) -> list[list[Any]]:
    """The values of each attribute of the rows, such as coordinates to plot."""
    return [[getattr(row, name) for row in rows] for name in names]


def legend_beside(axes: Axes, **options: Any) -> None:
    """Add a legend to the right of the axes."""
    axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(1, 1), **options)


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure as a PDF, PNG or SVG file, by the suffix of its name.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The figure; the upper and right edges of its axes are hidden.
    path : str or Path
        The file. Missing folders are created, and an existing file is replaced.

    Raises
    ------
    ValueError
        When the name ends in no suffix of `FORMATS`.
    OSError
        When it cannot be written; an existing file is unchanged.

    Examples
    --------
    >>> figure, (panel,) = panels("A line")
    >>> line = panel.plot([0, 1], [0, 1])
    >>> save(figure, "line.pdf")
    """
    check_type("figure", figure, Figure, "a figure of Matplotlib, as of panels")
    check_type("path", path, str | PathLike, "a path")
    suffix = Path(path).suffix.lower()
    if suffix not in FORMATS:
        known = ", ".join(FORMATS)
        raise ValueError(f"figure file {str(path)!r}: its name must end in one of {known}")
    write_text(Path(path), FORMATS[suffix](figure))


def pdf(figure: Figure) -> bytes:
    """A figure as the content of a PDF file."""
    dates = {"CreationDate": None, "Creator": None, "Producer": None}
    return _rendered(figure, format="pdf", metadata=dates)


def png(figure: Figure) -> bytes:
    """A figure as the content of a PNG file."""
    return _rendered(figure, format="png", dpi=120, metadata={"Software": None})


def svg(figure: Figure) -> str:
    """A figure as SVG, with text in the reader's fonts."""
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "holonomic"}):
        return _rendered(figure, format="svg", metadata={"Date": None, "Creator": None}).decode()


#: Writers of a figure, by the suffix of a file's name.
FORMATS: dict[str, Callable[[Figure], str | bytes]] = {".pdf": pdf, ".png": png, ".svg": svg}


def darken(figure: Figure) -> None:
    """Let a figure suit a dark page: dark grey text and lines become light, paper transparent."""
    for axes in figure.axes:
        axes.tick_params(which="both", colors=LIGHT)
        for spine in axes.spines.values():
            spine.set_edgecolor(LIGHT)
    for artist in figure.findobj():
        if isinstance(artist, Text | Line2D):
            red, green, blue = to_rgb(artist.get_color())
            if red == green == blue < 0.5:
                artist.set_color(LIGHT)
    legends = (legend.get_frame() for legend in figure.findobj(Legend))
    for paper in (figure.patch, *(axes.patch for axes in figure.axes), *legends):
        if to_rgb(paper.get_facecolor()) == WHITE:
            paper.set_facecolor("none")


def _rendered(figure: Figure, **options: Any) -> bytes:
    for axes in figure.axes:
        axes.spines[["top", "right"]].set_visible(False)
    buffer = BytesIO()
    figure.savefig(buffer, **options)
    return buffer.getvalue()
