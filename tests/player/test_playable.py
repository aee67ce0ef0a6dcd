"""Results show themselves: pages, films, pictures and figures of integrated motions."""

import json
import re
import sys
import types
import webbrowser
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import generated.double_pendulum as dp
import generated.duffing as duffing
import generated.furuta_pendulum as furuta
import generated.single_pendulum as single
from solvers import Held, Solution, ensemble, integrate
from solvers.player.playable import Playable
from solvers.player.sampled_motion import energy_errors
from solvers.references.taylor import taylor

START = (2.0, 0.5, 0.0, 0.0)


@pytest.fixture(scope="module")
def motion() -> Solution:
    return integrate(dp, (0, 3), START, {}, t_eval=[3.0])


def motions_of(html: str) -> list[dict[str, object]]:
    """The motions that a page plays."""
    text = re.search(r'<script type="application/json" id="motions">(.*?)</script>', html)
    assert text is not None
    return json.loads(text[1])


def test_a_motion_with_one_sample_is_shown_smoothly(motion: Solution, tmp_path: Path) -> None:
    """Against Taylor series, to the digits that a page has."""
    page = motion.save(tmp_path / "motion.html").read_text()
    (shown,) = motions_of(page)
    times = np.array(shown["t"])
    assert (len(times), times[0], times[-1]) == (501, 0.0, 3.0)
    exact = np.array(taylor(dp, dp.DEFAULTS, START, times[::50].tolist(), 25), float)
    positions = np.array(dp.positions_many(times[::50], exact.T, dp.DEFAULTS))
    assert np.abs(np.array(shown["positions"])[:, :, ::50] - positions).max() < 1e-5


def test_a_notebook_shows_the_page(motion: Solution) -> None:
    assert motion._repr_html_().startswith("<iframe")


@pytest.mark.parametrize("in_notebook", [False, True])
def test_play_opens_the_page_in_a_browser(
    motion: Solution, monkeypatch: pytest.MonkeyPatch, *, in_notebook: bool
) -> None:
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    monkeypatch.delitem(sys.modules, "ipykernel", raising=False)
    if in_notebook:
        monkeypatch.setitem(sys.modules, "ipykernel", types.ModuleType("ipykernel"))
    page = motion.play()
    assert [Path(address.removeprefix("file://")).read_text() for address in opened] == [
        page.html
    ] * (not in_notebook)


def test_energy_that_forces_supply_is_no_error() -> None:
    """A driven oscillator with friction: the balance holds to the error of the integration."""
    motion = integrate(duffing, (0, 5), (1.0, 0.0), {}, rtol=1e-11, atol=1e-13)
    (shown,) = motion.sampled_motions()
    assert np.ptp(duffing.energy_many(shown.t, shown.y, duffing.DEFAULTS)) > 0.1
    assert shown.energy is not None
    assert np.ptp(shown.energy) < 1e-9


@pytest.mark.parametrize("inputs", [lambda t, y: [-y[0]], Held(0.5, lambda t, y: [-y[0]])])
def test_with_inputs_that_vary_no_energy_error_is_shown(inputs: Held, tmp_path: Path) -> None:
    motion = integrate(furuta, (0, 2), (0.1, 0.2, 0.0, 0.0), {}, inputs=inputs)
    (shown,) = motions_of(motion.save(tmp_path / "a.html").read_text())
    assert shown["energy_error"] is None
    values = {one[0]: one[2] for one in shown["coordinates"]}  # type: ignore[attr-defined]
    assert values["θ"][-1] == pytest.approx(motion.y[1, -1], abs=1e-5)
    assert [axes.get_ylabel() for axes in motion.plot().axes if "energy" in axes.get_ylabel()] == []


def test_a_motion_backwards_is_played_in_the_order_of_time() -> None:
    motion = integrate(dp, (3, 1), START, {})
    (shown,) = motion.sampled_motions()
    assert (shown.t[0], shown.t[-1]) == (1.0, 3.0)
    assert shown.y[:, -1] == pytest.approx(START)
    assert shown.y[:, 0] == pytest.approx(motion.y[:, -1], abs=1e-7)


def test_a_motion_in_longer_numbers_is_shown_at_its_own_times() -> None:
    times = np.linspace(0, 30, 41)
    motion = integrate(dp, (0, 30), START, {}, accuracy=1e-11, t_eval=times)
    assert "numbers" in motion.run
    (shown,) = motion.sampled_motions()
    assert np.array_equal(shown.t, times)
    assert np.array_equal(shown.y, motion.y)


def test_an_event_ends_what_is_shown() -> None:
    from solvers import Event

    event = Event(dp, "theta1", 0.0, terminal=True)
    motion = integrate(dp, (0, 9), START, {}, events=event)
    (shown,) = motion.sampled_motions()
    assert shown.t[-1] == motion.end[0]
    assert abs(shown.y[0, -1]) < 1e-8


def test_motions_side_by_side_are_named_by_their_starts(motion: Solution, tmp_path: Path) -> None:
    other = integrate(dp, (0, 3), (2.0, 0.6, 0.0, 0.0), {})
    page = motion.save(tmp_path / "two.html", beside=[other]).read_text()
    assert [one["label"] for one in motions_of(page)] == [
        "θ₁ = 2 rad, θ₂ = 0.5 rad",
        "θ₁ = 2 rad, θ₂ = 0.6 rad",
    ]
    page = motion.save(tmp_path / "two.html", beside=[motion]).read_text()
    assert [str(one["label"])[:2] for one in motions_of(page)] == ["1:", "2:"]


@pytest.mark.parametrize("suffix", [".svg", ".png"])
def test_pictures_of_a_motion_are_written(motion: Solution, suffix: str, tmp_path: Path) -> None:
    assert motion.save(tmp_path / f"a{suffix}").stat().st_size > 5000


def test_a_film_lasts_as_long_as_its_motion_by_default(tmp_path: Path) -> None:
    with Image.open(integrate(dp, (0, 0.05), START, {}).save(tmp_path / "a.gif")) as film:
        assert film.n_frames == 2  # type: ignore[attr-defined]  # 0 and 1/25 s


def test_a_figure_has_the_coordinates_over_the_whole_time(motion: Solution) -> None:
    first, *_ = motion.plot().axes
    times = first.lines[0].get_xdata()
    assert (times[0], times[-1]) == (0.0, 3.0)
    assert first.lines[1].get_ydata()[-1] == pytest.approx(motion.y[1, -1], abs=1e-7)


def test_the_energies_of_motions_beside_each_other_have_one_unit() -> None:
    runs = [integrate(single, (0, 1), (angle, 0.0), {}) for angle in (0.5, 1.0)]
    errors, unit = energy_errors([one for run in runs for one in run.sampled_motions()])
    assert unit == "energy above rest"
    assert all(error is not None and np.abs(error).max() < 1e-8 for error in errors)


def test_a_solution_from_a_file_has_no_equations_to_show(motion: Solution) -> None:
    import pickle

    with pytest.raises(ValueError, match="integrate again"):
        pickle.loads(pickle.dumps(motion)).sampled_motions()


@pytest.mark.parametrize("beside", ["abc", [3], 4])
def test_only_results_are_shown_beside_others(motion: Solution, beside: object) -> None:
    assert isinstance(motion, Playable)
    with pytest.raises(ValueError, match="must be a list of results"):
        motion.plot(beside=beside)  # type: ignore[arg-type]


def test_a_few_motions_of_an_ensemble_are_shown_side_by_side(tmp_path: Path) -> None:
    lengths = np.array([0.5, 1.0, 2.0])
    motions = ensemble(single, (0, 2), {"theta": np.ones(3)}, {"l": lengths})
    assert motions.motion(2).y[:, -1] == pytest.approx(motions.y[:, 2], abs=1e-8)
    shown = motions_of(motions.save(tmp_path / "a.html").read_text())
    highest = [np.abs(np.array(one["positions"])).max() for one in shown]
    assert highest == pytest.approx(lengths, rel=1e-3)


def test_many_motions_of_an_ensemble_are_not_shown_side_by_side() -> None:
    motions = ensemble(single, (0, 2), {"theta": np.linspace(0, 1, 13)}, {})
    with pytest.raises(ValueError, match="13 motions are more than the 12 that can be shown"):
        motions.plot()
    with pytest.raises(ValueError, match="motion 13 must be a number from 0 to 12"):
        motions.motion(13)
