"""Files of figures, and figures on dark pages."""

import re
from pathlib import Path
from typing import Any

import pytest
from folders import ROOT
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from solvers.io.figures import LIGHT, darken, panels, save, svg


def chart() -> Figure:
    figure, (panel,) = panels("A title")
    panel.plot([0, 1], [0, 1], label="a curve")
    panel.plot([0, 1], [1, 0], color="black")
    panel.legend()
    figure.supxlabel("a note", color="#444444")
    return figure


@pytest.mark.parametrize(
    ("name", "start"),
    [("a.pdf", b"%PDF-"), ("a.png", b"\x89PNG"), ("a.svg", b"<?xml"), ("A.PDF", b"%PDF-")],
)
def test_the_suffix_decides_the_format(tmp_path: Path, name: str, start: bytes) -> None:
    save(chart(), tmp_path / name)
    first = (tmp_path / name).read_bytes()
    assert first.startswith(start)
    save(chart(), tmp_path / name)
    assert (tmp_path / name).read_bytes() == first  # no date, no random number


@pytest.mark.parametrize("name", ["a", "a.jpg", "pdf", "a.png.txt"])
def test_other_suffixes_are_refused_before_anything_is_rendered(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Figure, "savefig", lambda *_, **__: pytest.fail("rendered"))
    with pytest.raises(ValueError, match=rf"{name}': its name must end in one of .pdf, .png, .svg"):
        save(chart(), tmp_path / name)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("width", [5, 10])
def test_a_long_title_is_wrapped_within_the_figure(width: float) -> None:
    words = "A title that is longer than its figure is wide:" + " and so on" * 12
    figure, (panel,) = panels(words, size=(width, 4))
    svg(figure)
    (title,) = figure.texts
    renderer = FigureCanvasAgg(figure).get_renderer()
    extent = title.get_window_extent(renderer)
    assert 0 <= extent.x0 < extent.x1 <= figure.bbox.width
    assert panel.get_tightbbox(renderer).y1 <= extent.y0


def test_a_dark_figure_has_light_text_and_no_paper() -> None:
    figure = chart()
    assert "#ffffff" in svg(figure)
    darken(figure)
    dark = svg(figure)
    assert dark.count(LIGHT) > 10
    assert "#1f77b4" in dark  # colours of data are kept
    for colour in ("#000000", "#444444", "#ffffff"):
        assert colour not in dark


def test_microseconds_have_their_sign() -> None:
    for path in (ROOT / "solvers").rglob("*.py"):
        assert not re.search(r"[}/] ?us\b", path.read_text(encoding="utf-8")), path


@pytest.mark.parametrize("given", [{"columns": 0}, {"rows": 101}, {"columns": 2.0}, {"rows": True}])
def test_numbers_of_panels_are_whole_and_limited(given: dict[str, Any]) -> None:
    ((name, number),) = given.items()
    words = f"{name} = {number} must be a whole number from 1 to 100"
    with pytest.raises(ValueError, match=words):
        panels("", **given)
    assert len(panels("", rows=2, columns=3)[1]) == 6
