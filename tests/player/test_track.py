"""Tracks of a page: small and exact, refused if they cannot be values, written atomically."""

import json
import os
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import UNIT, at_rest, track_of

from solvers.player.player_page import Page
from solvers.player.track import MOST_SAMPLES, CoordinateTrack, Track


@pytest.fixture(scope="module")
def tracks() -> list[Track]:
    return [track_of("verner853")]


def motions(path: Path) -> list[dict[str, Any]]:
    match = re.search(r'id="motions">(.*?)</script>', path.read_text(encoding="utf-8"))
    assert match
    return json.loads(match[1])


def test_a_page_is_small_and_as_exact_as_a_screen(tracks: list[Track], tmp_path: Path) -> None:
    path = tmp_path / "new" / "page.html"
    Page("", "", tracks).write(path)
    assert path.stat().st_size < 60_000  # of which the player is the larger part
    (values,) = motions(path)
    for name, tolerance in (("t", 1e-6), ("positions", 1e-5), ("energy_error", 1e-9)):
        assert np.array(values[name]) == pytest.approx(getattr(tracks[0], name), abs=tolerance)
    for name, digits in (("positions", 6), ("energy_error", 5)):
        assert all(x == float(f"{x:.{digits}g}") for x in np.ravel(values[name]))
    assert values["t"] == [round(t, 6) for t in tracks[0].t.tolist()]
    assert not re.search(r"https?:|\bsrc=|@import|url\(", path.read_text(encoding="utf-8"))


def test_coordinates_and_rates_have_six_digits(tracks: list[Track], tmp_path: Path) -> None:
    (x, _), (y, _) = tracks[0].positions.swapaxes(0, 1)
    track = replace(tracks[0], coordinates=[CoordinateTrack("x", "m", x, y)])
    Page("", "", [track]).write(tmp_path / "page.html")
    ((*_, values, rates),) = motions(tmp_path / "page.html")[0]["coordinates"]
    for found, exact in ((values, x), (rates, y)):
        assert found == [float(f"{number:.6g}") for number in exact]


def test_many_samples_are_reduced_evenly(tmp_path: Path) -> None:
    n = 3 * MOST_SAMPLES
    t = np.linspace(1e4, 1e4 + 6, n)
    track = Track("many", t, np.array([[t, t]]), (), t, UNIT)
    Page("", "", [track]).write(tmp_path / "page.html")
    (values,) = motions(tmp_path / "page.html")
    assert len(values["t"]) == len(values["positions"][0][0]) == MOST_SAMPLES
    assert (values["t"][0], values["t"][-1]) == (t[0], t[-1])
    steps = np.diff(values["t"])
    assert 1e-4 < steps.min() <= steps.max() < 5e-4


REST = at_rest()
X = CoordinateTrack("x", "m", REST.t, REST.t)
HOLE = np.where(np.arange(501) == 7, np.nan, REST.t)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"t": REST.t[:1]}, r"t has shape \(1,\), .* n at least 2"),
        ({"t": REST.t[:400]}, r"positions has shape \(1, 2, 501\), .* \(masses, 2, 400\)"),
        ({"positions": np.array(1.0)}, r"positions has shape \(\), .* \(masses, 2, 501\)"),
        ({"positions": REST.positions[:0]}, r"positions has shape \(0, 2, 501\)"),
        ({"positions": REST.positions[:, :1]}, r"positions has shape \(1, 1, 501\)"),
        ({"energy_error": REST.t[:9]}, r"energy_error has shape \(9,\), .* \(501,\)"),
        ({"energy_error": HOLE}, r"energy_error\[7\] is nan, .* finite: leave out"),
        ({"positions": REST.positions * HOLE}, r"positions\[0, 0, 7\] is nan"),
        ({"t": REST.t[::-1]}, r"t\[1\] = 4.99 follows t\[0\] = 5.0, .* increase: sort"),
        ({"t": np.minimum(REST.t, 4.9)}, r"t\[491\] = 4.9 follows t\[490\] = 4.9"),
        ({"links": (("rod", (0, 1)),)}, r"links has a rod of points \(0, 1\): number .* pivot -1"),
        ({"links": (("spring", (-2, 0)),)}, r"links has a spring of points \(-2, 0\)"),
        ({"links": (("wheel", (0, -1)),)}, r"links has a wheel of points \(0, -1\): give 3"),
        ({"links": (("chain", (0, -1)),)}, r"links has the kind 'chain': known are rod,"),
        ({"coordinates": (replace(X, rates=REST.t[:9]),)}, r"rate of x has shape \(9,\)"),
        ({"coordinates": (replace(X, values=HOLE),)}, r"x\[7\] is nan"),
        ({"points": np.zeros((1, 3, 501))}, r"points has shape \(1, 3, 501\), but positions"),
    ],
)
def test_tracks_that_cannot_be_played_are_refused(
    wrong: dict[str, Any], words: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match="track 'at rest': " + words):
        Page("", "", [replace(REST, **wrong)]).write(tmp_path / "page.html")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("kinds", "least"), [(("rod", "thread", "spring", "rail"), 2), (("plate", "ring", "wheel"), 3)]
)
def test_links_have_the_points_that_determine_them(kinds: tuple[str, ...], least: int) -> None:
    for kind in kinds:
        replace(REST, links=((kind, (-1, 0, -1)[:least]),)).check()
        with pytest.raises(ValueError, match=f"a {kind} of points .*: give {least} at least"):
            replace(REST, links=((kind, (-1, 0, -1)[: least - 1]),)).check()


def test_a_page_without_runs_is_refused_at_once() -> None:
    with pytest.raises(ValueError, match=r"tracks is empty, but .* at least one"):
        Page("", "", [])


def test_energy_errors_of_different_units_share_no_axis() -> None:
    other = replace(REST, energy_unit="J")
    with pytest.raises(ValueError, match=f"are '{UNIT}', 'J', but they share an axis"):
        Page("", "", [REST, other])
    Page("", "", [other, other])


def test_coordinates_of_different_names_share_no_chart() -> None:
    with pytest.raises(ValueError, match="but they share charts: give all tracks the same ones"):
        Page("", "", [REST, replace(REST, coordinates=(X,))])


def test_two_samples_suffice_and_the_unit_is_plain_text() -> None:
    ends = Track("a", np.array([0.0, 1.0]), np.ones((1, 2, 2)), (), np.zeros(2), "<b>T</b>")
    assert "relative to the &lt;b&gt;T&lt;/b&gt;" in Page("", "", [ends]).html


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_a_failed_write_leaves_the_old_page_and_nothing_else(
    step: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "page.html"
    Page("old", "", [REST]).write(path)
    old = path.read_bytes()

    def full(*_: object) -> None:
        assert path.read_bytes() == old
        assert len(list(tmp_path.iterdir())) == 2
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, step, full)
    with pytest.raises(OSError, match="No space"):
        Page("new", "", [REST]).write(path)
    assert [(file.name, file.read_bytes()) for file in tmp_path.iterdir()] == [(path.name, old)]
