"""Scenes of systems with constraints: starts that are completed, and what is reported of them."""

from dataclasses import replace
from math import cos, sin
from pathlib import Path

import numpy as np
import pytest

from solvers.app.modules import load
from solvers.integration.integrate import integrate
from solvers.io.toml_input import InputError
from solvers.scenes.scene import Scene
from solvers.scenes.scene_output import figures, summary
from solvers.scenes.scene_reading import find
from solvers.scenes.scene_run import run_scene
from solvers.sweeps.definition.axes import Grid
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.definition.sweep_checks import FROM_ENERGY
from solvers.sweeps.execution.initial_states import initial_states
from solvers.sweeps.maps.final import Final
from solvers.sweeps.results import STATUSES

ROCKER = """
title = "Four-bar linkage"
coincide = [[
    ["a*cos(phi) + b*cos(psi)", "a*sin(phi) + b*sin(psi)"], ["d + c*cos(chi)", "c*sin(chi)"],
]]
[coordinates]
phi = {}
psi = {}
chi = {}
[parameters]
a = { value = 0.3, unit = "m" }
b = { value = 0.8, unit = "m" }
c = { value = 0.6, unit = "m" }
d = { value = 0.9, unit = "m" }
m = { value = 1, unit = "kg" }
g = { value = 9.81, unit = "m/s^2" }
[[masses]]
mass = "m"
position = ["a*cos(phi)", "a*sin(phi)"]
"""
SCENE = 'system = "rocker.toml"\nduration = 0.5\nmethod = "DOP853"\n[initial]\n'


def scene(folder: Path, initial: str, settings: str = "") -> Scene:
    (folder / "rocker.toml").write_text(ROCKER)
    (folder / "scene.toml").write_text(settings + SCENE + initial)
    return find(str(folder / "scene.toml"), load)


def gap(one: Scene) -> float:
    """Distance of the points that coincide."""
    phi, psi, chi = one.y0[:3]
    x = 0.3 * cos(phi) + 0.8 * cos(psi) - 0.9 - 0.6 * cos(chi)
    return abs(complex(x, 0.3 * sin(phi) + 0.8 * sin(psi) - 0.6 * sin(chi)))


def test_guesses_decide_between_the_branches(tmp_path: Path) -> None:
    plus = scene(tmp_path, 'phi = "60 deg"\nphi_dot = 2\nchi = { guess = "60 deg" }\n')
    minus = scene(tmp_path, 'phi = "60 deg"\nphi_dot = 2\nchi = { guess = "-90 deg" }\n')
    for one in (plus, minus):
        assert gap(one) < 1e-15
        assert one.y0[3] == 2.0
        assert one.y0[0] == pytest.approx(1.0471975512)
        assert one.completed.startswith("from the constraints: psi = ")
    assert plus.y0[2] > 0 > minus.y0[2]
    assert f"chi = {minus.y0[2]:.6g} rad" in plus.completed.split("another solution")[1]


def test_what_was_completed_is_reported(tmp_path: Path) -> None:
    one = scene(tmp_path, "phi = 1\n")
    shipped = run_scene(find("single", load))
    result = replace(shipped, scene=replace(shipped.scene, completed=one.completed))
    text, values = "\n".join(summary(result)), figures(result)
    first, second = one.completed.split("; ")
    assert f"\nstart {first}\n  {second}\nmodel" in text
    assert second.startswith("another solution, for guesses near it: psi = ")
    assert first.endswith(", psi_dot, chi_dot = 0")
    assert f"Start {one.completed}." in result.sampled_motions()[0].note
    assert values["completed"] == one.completed
    assert values["initial_state"] == dict(
        zip(shipped.scene.module.STATE, shipped.scene.y0, strict=True)
    )
    # a scene that states everything has nothing to report
    again = Scene(one.module, one.params, one.y0, 0.5)
    assert (again.y0, again.completed) == (one.y0, "")
    assert "start" not in "\n".join(summary(shipped))


@pytest.mark.parametrize(("initial", "message"), [
    ("phi = 1\npsi = 0\nchi = 0\n", r"phi = 1 rad, psi = 0 rad, chi = 0 rad .* pin_1_x = -0.538"),
    ("phi = { gues = 1 }\n", "initial.phi has no key 'gues' .did you mean 'guess'"),
    ("phi = { guess = '1 m' }\n", "initial.phi.guess: "),
    ("phi = 1\nksi = 2\n", "has no key 'ksi' .did you mean 'psi'"),
    ("phi = 1\nphi_dot = 1\npsi_dot = 9\n", "the nearest has pin_1_._dot = "),
])  # fmt: skip
def test_invalid_starts_of_scenes_are_refused(initial: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        scene(tmp_path, initial)


@pytest.mark.long("other tests reach its code")
def test_sweeps_complete_every_start(tmp_path: Path) -> None:
    module = scene(tmp_path, "phi = 1\n").module
    angles = np.linspace(0, np.pi, 41)
    definition = Sweep(module, Grid({"chi": angles}), {"end": Final(("phi",))}, 1.0)
    states, params, status = initial_states(definition, {"chi": angles})
    # oracle: crank and coupler reach the rocker's end
    distance = np.hypot(0.9 + 0.6 * np.cos(angles), 0.6 * np.sin(angles))
    reached = (distance > 0.5) & (distance < 1.1)
    assert 5 < reached.sum() < 36
    assert np.array_equal(status == 0, reached)
    assert (status[~reached] == STATUSES.index("no configuration")).all()
    residuals = module.constraints_many(0.0, states[reached].T, np.array(params)[:, reached])
    assert np.abs(residuals).max() < 1e-12
    assert np.array_equal(states[:, 2], angles)


def test_sweeps_give_a_velocity_by_the_energy(tmp_path: Path) -> None:
    module = scene(tmp_path, "phi = 1\n").module
    values = {"phi_dot": FROM_ENERGY, "energy": 5.0}
    angles = np.linspace(0.2, 3, 5)
    definition = Sweep(module, Grid({"phi": angles}), {"end": Final(("phi",))}, 1.0, values=values)
    states, params, status = initial_states(definition, {"phi": angles})
    assert not status.any()
    energies = module.energy_many(0.0, states.T, np.array(params))
    assert energies == pytest.approx(np.full(5, 5.0), abs=1e-12)
    assert np.abs(module.constraints_many(0.0, states.T, np.array(params))).max() < 1e-12


def test_values_of_eliminated_coordinates_are_refused(tmp_path: Path) -> None:
    text = ROCKER.replace("coincide", 'constraints = ["x - a*cos(phi)"]\ncoincide')
    (tmp_path / "slider.toml").write_text(text.replace("[parameters]", "x = {}\n[parameters]"))
    settings = SCENE.replace("rocker", "slider")
    (tmp_path / "scene.toml").write_text(settings + "phi = 1\n")
    one = find(str(tmp_path / "scene.toml"), load)
    assert "x" not in one.module.STATE
    words = "has 'x', which follows from phi, psi, chi: give these, or .* keep_coordinates=True"
    with pytest.raises(ValueError, match=f"y0 {words}"):
        integrate(one.module, (0, 1), {"x": 0.1}, {})
    (tmp_path / "scene.toml").write_text(settings + "x = 0.1\n")
    with pytest.raises(InputError, match=words):
        find(str(tmp_path / "scene.toml"), load)
