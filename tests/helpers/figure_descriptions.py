"""What a figure shows, as text: curves by their ends, limits, labels, colours and marks."""

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import Collection, PathCollection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.figure import Figure


def described(figure: Figure) -> str:
    """The contents of a figure, a paragraph for each of its axes."""
    figure.draw_without_rendering()  # which decides on ticks
    lines = [f"figure {_numbers(figure.get_size_inches())}"]
    lines += [f"  text {one.get_text()!r}" for one in figure.texts]
    lines += [_legend(one.get_texts()) for one in figure.legends]
    shown = (axes for axes in figure.axes if axes.axison and axes.get_visible())
    return "\n\n".join(["\n".join(lines), *("\n".join(_axes(axes)) for axes in shown)])


def _axes(axes: Axes) -> Iterator[str]:
    yield f"  axes {axes.get_title()!r} aspect {axes.get_aspect()}"
    for name in "xy":
        axis = getattr(axes, f"{name}axis")
        ticks = " ".join(one.get_text() for one in axis.get_ticklabels() if one.get_text())
        limits = _numbers(getattr(axes, f"get_{name}lim")())
        yield f"    {name} {axis.label.get_text()!r} {axis.get_scale()} {limits}: {ticks}"
    for line in axes.lines:
        looks = f"{to_hex(line.get_color())} {line.get_linestyle()} {line.get_marker()}"
        looks += f" {line.get_linewidth():g} {line.get_markersize():.3g}"
        yield f"    line {_label(line)}{looks} {_points(np.asarray(line.get_xydata(), float))}"
    for mesh in axes.collections:
        yield f"    {_collection(mesh)}"
    for image in axes.images:
        yield f"    image {_values(image.get_array())} {_numbers(image.get_extent())}"
    if axes.patches:
        boxes = np.array([patch.get_extents().bounds for patch in axes.patches])
        colours = {to_hex(patch.get_facecolor()) for patch in axes.patches}
        yield f"    {len(boxes)} patches {' '.join(sorted(colours))} {_numbers(boxes.sum(axis=0))}"
    for text in axes.texts:
        yield f"    text {text.get_text()!r} at {_numbers(text.get_position())}"
    if legend := axes.get_legend():
        yield f"  {_legend(legend.get_texts())}"


def _legend(texts: Sequence[object]) -> str:
    return f"  legend {[one.get_text() for one in texts]}"  # type: ignore[attr-defined]


def _label(artist: Artist) -> str:
    label = str(artist.get_label())
    return "" if label.startswith("_") or not label else f"{label!r} "


def _collection(one: Collection) -> str:
    values = one.get_array()
    of_values = "" if values is None else f" {_values(values)} {one.get_cmap().name}"
    if isinstance(one, QuadMesh):
        return f"mesh{of_values} {_points(one.get_coordinates().reshape(-1, 2))}"
    if isinstance(one, PathCollection):
        return f"points {_label(one)}{_points(np.asarray(one.get_offsets(), float))}{of_values}"
    paths = [path.vertices for path in one.get_paths()]
    points = _points(np.concatenate(paths)) if paths else "empty"
    colours = sorted({to_hex(colour) for colour in one.get_edgecolor()})[:3]
    return f"paths {_label(one)}{len(paths)} {points} {' '.join(colours)}{of_values}"


def _points(points: np.ndarray) -> str:
    """The number, the ends, the range and the mean of points."""
    finite = points[np.isfinite(points).all(axis=1)]
    if not len(finite):
        return "no points"
    parts = finite[0], finite[-1], finite.min(axis=0), finite.max(axis=0), finite.mean(axis=0)
    return f"{len(finite)} of {len(points)}: " + " | ".join(map(_numbers, parts))


def _values(values: object) -> str:
    array = np.ma.masked_invalid(np.asarray(values, float)).compressed()
    parts = (array.min(), array.max(), array.mean()) if len(array) else ()
    return f"{np.shape(values)} {_numbers(parts)}"


def _numbers(values: Sequence[float] | np.ndarray) -> str:
    """Numbers with four significant digits; those that are rounding errors are zero."""
    return " ".join(f"{0.0 if abs(x) < 1e-9 else x:.4g}" for x in values)
