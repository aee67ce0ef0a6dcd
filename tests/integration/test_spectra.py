"""Lyapunov spectra of many motions, in compiled lanes, in Python, and in sweeps."""

from pathlib import Path

import numpy as np
import pytest

import generated.double_pendulum as dp
import generated.driven_pendulum as driven
import generated.single_pendulum as pendulum
import generated.swinging_atwood as atwood
from solvers.integration.ensemble import ensemble
from solvers.integration.loops import compiled_loop
from solvers.integration.prepare import NotFinishedError
from solvers.integration.problem.events import Event
from solvers.integration.problem.status import Status
from solvers.integration.variations.lyapunov_spectrum import Frames, lyapunov_spectrum
from solvers.integration.variations.transition_matrix import transition_matrix
from solvers.sweeps.definition.axes import Grid
from solvers.sweeps.definition.map_table import MapTable
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.sweep_run import sweep
from solvers.sweeps.maps.final import Final
from solvers.sweeps.maps.lyapunov_spectrum import Spectrum

FINE = {"rtol": 1e-12, "atol": 1e-12}


def singular_values(y: list[float], duration: float) -> np.ndarray:
    """Logarithms of the growth of the main directions, in the metric of the mass matrix."""
    motion = transition_matrix(dp, (0, duration), y, {})
    start, end = (
        np.kron(np.eye(2), np.linalg.cholesky(np.array(dp.mass_matrix(0, state, dp.DEFAULTS))).T)
        for state in (y, motion.y.tolist())
    )
    return np.linalg.svd(end @ motion.matrix @ np.linalg.inv(start))[1]


def test_volumes_are_those_of_the_transition_matrix() -> None:
    y = [1.0, 2.0, 0.3, -0.2]
    growth = Frames(dp, np.array([y]), dp.DEFAULTS, 4, **FINE).growth(np.array([3.0]), 6)
    assert growth.shape == (6, 1, 4)
    sizes = singular_values(y, 3.0)
    assert growth.sum() == pytest.approx(0.0, abs=1e-10)
    assert np.log(sizes).sum() == pytest.approx(0.0, abs=1e-8)
    assert growth.sum(axis=0)[0, 0] <= np.log(sizes[0])
    # intervals do not matter
    once = Frames(dp, np.array([y]), dp.DEFAULTS, 4, **FINE).growth(np.array([3.0]), 1)
    assert once[0] == pytest.approx(growth.sum(axis=0), abs=1e-8)


def test_motions_do_not_depend_on_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    starts = np.array([[1.0, 2.0, 0.0, 0.0], [0.3, 0.1, 0.0, 0.0], [2.0, -1.0, 1.0, 0.0]])
    params = [np.array([p, 1.1 * p, p]) for p in dp.DEFAULTS]
    durations = np.array([2.0, 3.0, 1.0])
    many = Frames(dp, starts, params, 2, **FINE)
    growth = many.growth(durations, 4)
    assert many.t == pytest.approx(durations, abs=1e-15)
    for k, start in enumerate(starts):
        own = [float(p[k]) for p in params]
        alone = Frames(dp, start[np.newaxis], own, 2, **FINE)
        assert alone.growth(durations[k : k + 1], 4)[:, 0] == pytest.approx(growth[:, k], abs=1e-12)
        assert alone.y[0] == pytest.approx(many.y[k], abs=1e-12)
    select = compiled_loop.select
    monkeypatch.setattr(
        compiled_loop, "select", lambda problem, lanes: (select(problem, lanes=lanes)[0], None)
    )
    python = Frames(dp, starts, params, 2, **FINE)
    assert python.growth(durations, 4) == pytest.approx(growth, abs=1e-8)
    assert python.y == pytest.approx(many.y, abs=1e-9)


def test_a_motion_that_fails_has_no_growth() -> None:
    starts = np.array([[1.0, 0.5, 0.0, 0.0], [1.0, 0.0, -30.0, 0.0]])
    frames = Frames(atwood, starts, atwood.DEFAULTS, 4, rtol=1e-9, atol=1e-9)
    growth = frames.growth(np.array([0.5, 0.5]), 5)
    assert np.isfinite(growth[:, 0]).all()
    assert np.isnan(growth[:, 1]).all()
    assert frames.status_of(0) is Status.FINISHED
    assert frames.status_of(1) is not Status.FINISHED  # the thread's length becomes 0
    assert frames.t[1] < 0.1
    with pytest.raises(NotFinishedError, match=r"t = 0\.03"):
        lyapunov_spectrum(atwood, starts[1], {}, 10.0, interval=0.5)


def test_sweeps_store_spectra(tmp_path: Path) -> None:
    axes = Grid({"theta1": [0.1, 2.0], "theta2": [2.5]})
    maps = {"all": Spectrum(4, interval=1.0), "largest": Spectrum(1), "end": Final(("theta1",))}
    results = sweep(Sweep(dp, axes, maps, 50.0, rtol=1e-9, atol=1e-12), tmp_path)
    exponents = results.maps["all"]
    assert exponents.shape == (2, 1, 4)
    assert np.abs(exponents.sum(axis=-1)).max() < 1e-7
    assert (np.diff(exponents) <= 0).all()
    y = {"theta1": 0.1, "theta2": 2.5}
    one = lyapunov_spectrum(dp, y, {}, 50.0, interval=1.0)
    assert exponents[0, 0] == pytest.approx(one.exponents, abs=1e-5)
    assert results.maps["largest"][0, 0, 0] == pytest.approx(one.exponents[0], abs=0.05)
    with pytest.raises(ValueError, match="count = 5 must be from 1 to 4"):
        Sweep(dp, axes, {"all": Spectrum(5)}, 50.0)


def test_files_and_programs_have_the_same_interval_by_default() -> None:
    read = Spectrum.read(MapTable("maps.all", dp, {"count": 4}))
    assert Spectrum(4) == read == Spectrum(4, interval=2.0)


def test_friction_contracts_volumes_in_sweeps(tmp_path: Path) -> None:
    values = {"theta": 1.0, "Omega": 6.0, "a": 0.3}
    axes, tolerances = Grid({"c": [0.1, 0.4]}), {"rtol": 1e-9, "atol": 1e-12}
    definition = Sweep(driven, axes, {"all": Spectrum(2)}, 40.0, values, **tolerances)
    sums = sweep(definition, tmp_path).maps["all"].sum(axis=-1)
    assert sums == pytest.approx([-0.1, -0.4], abs=1e-7)  # -c/(m l²)


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("compensated", [False, True])
@pytest.mark.parametrize("method", ["dp54", "verner98", "gauss8"])
def test_perturbations_of_any_size_have_the_same_digits(method: str, compensated: bool) -> None:
    # powers of two are taken out of large ones; no rounding error depends on them
    sizes = np.exp2([0, -500, 60, 960])
    starts = np.stack([0 * sizes + 3.1, 0 * sizes + 0.1, sizes, sizes])
    event = Event(pendulum, "theta", 4.0)
    motions = ensemble(
        *(pendulum, (0, 8), starts, pendulum.DEFAULTS),
        method=method,
        form="variational",
        h=0.1,
        compensated=compensated,
        events=event,
    )
    for changes in (motions.y[2:], motions.y_events[2:, :, 0, 0]):
        scaled = changes / sizes
        assert np.array_equal(scaled, np.repeat(scaled[:, :1], 4, axis=1))
        assert np.abs(scaled).min() > 10
    growth = np.log(np.hypot(*motions.y[2:] / sizes) / np.sqrt(2))
    assert motions.growth == pytest.approx(growth, abs=1e-12)
    assert motions.nfev == pytest.approx(motions.nfev[0], rel=0.02)
