"""Figures of the gallery: what is drawn spans the axes."""

import runpy
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solvers import panels

ROOT = Path(__file__).parents[2]
SCRIPTS = sorted((ROOT / "notebooks" / "gallery").glob("*.py"))
#: Least part of each axis that the drawn data span.
LEAST = 0.5


def drawn_points(axes: Axes) -> Iterator[np.ndarray]:
    """Points, in parts of the axes, of lines, markers, areas and images."""
    to_axes = axes.transData + axes.transAxes.inverted()
    for line in axes.lines:
        if line.get_transform().contains_branch(axes.transData):
            yield to_axes.transform(np.asarray(line.get_xydata(), float))
    for collection in axes.collections:
        yield to_axes.transform(np.asarray(collection.get_offsets(), float))
        yield from (to_axes.transform(path.vertices) for path in collection.get_paths())
    for patch in axes.patches:
        yield axes.transAxes.inverted().transform(
            patch.get_transform().transform(patch.get_path().vertices)
        )
    for image in axes.images:
        if np.ma.count(image.get_array()):
            left, right, bottom, top = image.get_extent()
            yield to_axes.transform([(left, bottom), (right, top)])


def spans(axes: Axes) -> np.ndarray:
    """Parts of both axes that the data within them span; 0 where there are none."""
    points = np.concatenate([np.empty((0, 2)), *drawn_points(axes)])
    inside = points[np.isfinite(points).all(axis=1) & (np.abs(points - 0.5) <= 0.5001).all(axis=1)]
    return np.ptp(inside, axis=0) if len(inside) else np.zeros(2)


def blank(figure: Figure) -> list[tuple[str, list[float]]]:
    """Titles and spans of the panels that are blank, or nearly."""
    figure.draw_without_rendering()
    shown = [axes for axes in figure.axes if axes.axison and axes.get_label() != "<colorbar>"]
    parts = [(axes.get_title(), spans(axes).round(2).tolist()) for axes in shown]
    return [(title, part) for title, part in parts if min(part) < LEAST]


@pytest.mark.long("seconds for each figure of the gallery")
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_what_is_drawn_spans_the_axes(script: Path) -> None:
    figures = [x for x in runpy.run_path(str(script)).values() if isinstance(x, Figure)]
    assert figures
    for figure in figures:
        assert blank(figure) == []


def test_a_blank_panel_and_one_with_a_speck_are_noticed() -> None:
    figure, (full, empty, speck) = panels("Three panels", columns=3)
    full.plot([0, 1], [2, 3])
    empty.set_title("empty")
    speck.plot([0, 0.1], [0, 0.1])
    speck.set(xlim=(0, 10), ylim=(0, 10), title="speck")
    assert blank(figure) == [("empty", [0.0, 0.0]), ("speck", [0.01, 0.01])]
