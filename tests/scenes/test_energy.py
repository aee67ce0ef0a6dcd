"""Energy errors: the balance of driven and damped motions, and their units."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import generated.driven_pendulum as driven
import generated.single_pendulum as sp
import generated.swinging_atwood as atwood
from solvers.equations.energy import energy_unit, supplied_energy
from solvers.integration.accuracy.checked_motion import Motion
from solvers.integration.accuracy.integration_run import IntegrationRun
from solvers.integration.accuracy.method_choice import SERIES, MethodChoice
from solvers.player.motion_plots import figure
from solvers.player.player_page import Page
from solvers.player.sampled_motion import energy_errors, tracks
from solvers.scenes.scene import Scene
from solvers.scenes.scene_output import together, write_files
from solvers.scenes.scene_run import run_scene

DAMPED = driven.params(c=0.3)
DRIVEN = Scene(driven, DAMPED, {"theta": 1.0}, 2.0, accuracy=1e-6)
ATWOOD = Scene(atwood, {}, {"r": 1.0, "theta": 1.0}, 1.0, accuracy=1e-6, title="Atwood")
PENDULUM = Scene(sp, {}, {"theta": 1.0}, 1.0, title="Pendulum")


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("samples", [2, 201, 5001])
@pytest.mark.parametrize("accuracy", [1e-4, 1e-7, 1e-10])
def test_the_energy_balance_is_as_accurate_as_the_state(accuracy: float, samples: int) -> None:
    result = run_scene(replace(DRIVEN, accuracy=accuracy, samples=samples))
    (errors,), unit = energy_errors(together([result]))
    assert unit == "energy above rest"
    # energies are tens of joules per rad or rad/s
    assert np.abs(errors).max() < 10 * max(result.selection.model.error_estimate, 1e-12)
    energy = result.scene.module.energy_many(result.t, result.y, DAMPED)
    assert np.ptp(energy) > 1


def test_the_balance_of_fixed_steps_shows_their_error() -> None:
    result = run_scene(replace(DRIVEN, method="rk4", step=1e-3))
    (errors,), _ = energy_errors(together([result]))
    finer = run_scene(replace(DRIVEN, method="rk4", step=5e-4))
    (fine,), _ = energy_errors(together([finer]))
    error = np.abs(result.y - finer.y).max()
    assert error / 100 < np.abs(errors).max() < 10 * error
    assert np.log2(np.abs(errors).max() / np.abs(fine).max()) == pytest.approx(4, abs=0.6)


def test_power_along_a_taylor_series_is_integrated_to_rounding() -> None:
    motion = Motion(driven, DAMPED, (1.0, 0.0), 0.3, (0, 1))
    run = IntegrationRun(motion, MethodChoice(SERIES, "rational", ""), 24)
    times = run.step_times()
    supplied = supplied_energy(driven, DAMPED, times, run.states)
    energy = driven.energy_many(times, run.states(times).T, DAMPED)
    assert np.ptp(supplied) > 1
    assert np.abs(energy - energy[0] - supplied).max() < 1e-12


def test_nothing_is_supplied_to_a_system_that_keeps_its_energy() -> None:
    states = pytest.fail
    assert supplied_energy(sp, sp.DEFAULTS, [0.0, 1.0], states).tolist() == [0.0, 0.0]


def test_energy_errors_are_in_joules_where_no_energy_above_rest_exists() -> None:
    params = sp.DEFAULTS
    rest, above, below = (sp.energy(0.0, (q, 0.0), params) for q in (0.0, 1.0, 1e-12))
    assert energy_unit(sp, params, above).is_relative
    assert energy_unit(sp, params, above).joules == pytest.approx(2 * 9.81 * (1 - np.cos(1)))
    for first in (rest, below, rest - 1):
        unit = energy_unit(sp, params, first)
        assert (unit.name, unit.joules, unit.is_relative) == ("J", 1.0, False)
    assert energy_unit(atwood, atwood.DEFAULTS, 3.0).name == "J"  # no equilibrium is known


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize(("scenes", "unit"), [
    ([PENDULUM], "energy above rest"),
    ([ATWOOD], "J"),
    ([PENDULUM, ATWOOD], "J"),
])  # fmt: skip
def test_plots_and_pages_state_the_unit_of_energy_errors(
    scenes: list[Scene], unit: str, tmp_path: Path
) -> None:
    results = [run_scene(scene) for scene in scenes]
    errors, shared = energy_errors(together(results))
    assert shared == unit
    for result, error in zip(results, errors, strict=True):
        module = result.scene.module
        energy = module.energy_many(0.0, result.y, result.scene.params)
        scale = energy_unit(module, result.scene.params, energy[0]).joules
        expected = (energy - energy[0]) / (scale if unit != "J" else 1)
        assert error == pytest.approx(expected, abs=1e-18)
    panel = figure(
        together([replace(one, scene=replace(one.scene, pictures=("energy",))) for one in results])
    )
    assert panel.axes[0].get_ylabel() == f"energy error / {unit}"
    page = write_files(results, tmp_path)["page"].read_text(encoding="utf-8")
    words = "in J" if unit == "J" else f"relative to the {unit}"
    assert f"Energy error <small>(absolute value, {words})</small>" in page


def test_a_page_refuses_energy_errors_in_different_units() -> None:
    one, other = (tracks(together([run_scene(scene)]))[0] for scene in (PENDULUM, ATWOOD))
    with pytest.raises(ValueError, match=r"'energy above rest', 'J', .* share an axis"):
        Page("", "", [one, other])
