"""Scenes are read strictly and safely, and invalid scenes are refused."""

from dataclasses import replace
from math import pi
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from counting import counted_calls

import generated.double_pendulum as dp
import generated.single_pendulum as sp
from solvers.app.modules import load as load_module
from solvers.app.scenes import load_sweep
from solvers.equations.singularities import MassMatrixWarning
from solvers.io.quantity import QuantityError, quantity
from solvers.io.toml_input import InputError
from solvers.scenes.scene import Scene
from solvers.scenes.scene_reading import find, names, read, scene
from solvers.scenes.scene_run import run_scene

PLAIN = {"system": "double_pendulum", "duration": 5, "initial": {"theta1": 1, "theta2": 2}}


def scene_from(**changes: object) -> Any:
    return scene("mine", {**PLAIN, **changes}, load_module)


@pytest.mark.parametrize(("text", "unit", "value"), [
    ("90 deg", "rad", pi / 2),
    ("pi/2", "rad", pi / 2),
    ("2*pi", "rad", 2 * pi),
    ("1/2", "kg", 0.5),
    ("1/2 turn", "rad", pi),
    ("500 g", "kg", 0.5),
    ("10 deg/s", "rad/s", pi / 18),
    ("9.81 m/s^2", "m/s^2", 9.81),
    ("981 cm/s**2", "m/s^2", 9.81),
    ("1 kg*m/s^2", "N", 1.0),
    ("2 N/mm", "N/m", 2000.0),
    ("90°", "rad", pi / 2),
    ("180 deg", "turn", 0.5),
    ("30 rpm", "rad/s", pi),
    ("-(1 + 2)**2", "m", -9.0),
    ("1e-3 m", "m", 1e-3),
    (" 0.5 min ", "s", 30.0),
    (7, "m", 7.0),
])  # fmt: skip
def test_numbers_have_units_and_exact_fractions(text: object, unit: str, value: float) -> None:
    assert quantity(text, unit) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(("text", "words"), [
    ("90 deg", "give m or a unit of that kind"),
    ("1 foo", "unit 'foo' is not known"),
    ("m^2", "give m or"),
    ("2^2", r"a power is written \*\*"),
    ("1/0", "has no value"),
    ("9**9**9", "has no value"),
    ("(-1)**0.5", "is no number"),
    ("nan", "not known"),
    ("1e999", "is not finite"),
    (10**400, "is not finite"),
    (float("nan"), "is not finite"),
    (True, "is no number"),
    ([1], "is no number"),
    ("__import__('os').system('touch /tmp/executed')", "is no number"),
    ("().__class__", "is no number"),
    ("(lambda: 1)()", "is no number"),
    ("[x for x in (1,)][0]", "is no number"),
    ("1 if 1 else 2", "is no number"),
    ("'1'*9", "is no number"),
    ("(" * 49 + ")" * 49, "is no number"),
    ("(" * 100_000, "longer than a number"),
    ("", "is no number"),
])  # fmt: skip
def test_text_that_is_no_number_is_refused_with_little_work(text: object, words: str) -> None:
    with pytest.raises(QuantityError, match=words), counted_calls() as calls:
        quantity(text, "m")
    assert calls.count < 10_000


@pytest.mark.parametrize(("changes", "words"), [
    ({"systen": "x"}, r"no key 'systen' \(did you mean 'system'\?\)"),
    ({"system": "doble_pendulum"}, "is called 'doble_pendulum' .did you mean 'double_pendulum'"),
    ({"system": "os"}, "no system is called"),
    ({"system": 3}, "must be a text"),
    ({"duration": 0}, "duration = 0.0 must be positive"),
    ({"duration": "-5 s"}, "must be positive"),
    ({"duration": "5 m"}, "duration: '5 m' has another unit: give s"),
    ({"initial": {"theta1": 1}}, "initial.theta2 is missing: give theta1, theta2"),
    ({"initial": {"theta1": 1, "thta2": 1}}, r"\[initial\] has no key 'thta2' .*'theta2'"),
    ({"initial": 3}, r"must be a table: write \[initial\]"),
    ({"parameters": {"m1": 0}}, 'm1 = 0 must be positive, in kg; .* m1 = "absent"'),
    ({"parameters": {"m1": -1}}, "parameters.m1 = -1 must be positive"),
    ({"parameters": {"m1": "1 m"}}, "give kg or"),
    ({"parameters": {"m1": True}}, "True is no number"),
    ({"parameters": {"m3": 1}}, r"\[parameters\] has no key 'm3'"),
    ({"parameters": {"g": "absent"}}, "parameters.g: 'absent'|parameters.g: unit"),
    ({"accuracy": 1e-15}, "below 1e-13"),
    ({"accuracy": "1 m"}, "give a number without a unit"),
    ({"samples": 1}, "whole number from 2"),
    ({"samples": 2.5}, "whole number"),
    ({"model": "small"}, "must be 'rest' or 'normal modes' or .*'full'"),
    ({"parameters": {"M1": 1}}, "did you mean 'm1'"),
    ({"parameters": {"l1": "0,5 m"}}, "a decimal point is a point"),
    ({"initial": {"theta1": 1, "theta2": 1, "method": "rk4"}}, "'method' belongs above the first"),
    ({"code": "quick"}, "'general' or 'specialised'"),
    ({"method": "rk5"}, "rk5"),
    ({"method": 4}, "must be a text"),
    ({"step": 0.1}, "needs a method"),
    ({"method": "rk4", "step": 6}, "longer than the duration"),
    ({"method": "LSODA", "step": 0.1}, "controls its steps"),
    ({"method": "gauss2", "step": 0.1, "form": "rational"}, "needs a Jacobian"),
    ({"form": "variational"}, "must be one of lagrangian, hamiltonian, rational"),
    ({"outputs": ["theta3"]}, r"'theta3' \(did you mean 'theta"),
    ({"outputs": ["energy"]}, "names no component of the state"),
    ({"outputs": "theta1"}, "must be a list"),
    ({"pictures": ["theta1 over x"]}, "write 'path', 'energy' or such as 'theta1 over t'"),
    ({"pictures": ["__import__('os') over t"]}, "pictures name"),
    ({"initial": 3, "beside": [{"method": "rk4"}]}, r"must be a table: write \[initial\]"),
    ({"parameters": 3, "beside": [{"method": "rk4"}]}, "must be a table"),
    ({"beside": [{"label": "x", "initial": 5}]}, "must be a table"),
    ({"title": "\x1b[31m red"}, "printable characters"),
    ({"title": "x" * 3000}, "up to 2000"),
    ({"pictures": ["path"] * 99}, "up to 24 are allowed"),
    ({"beside": [{"label": "x"}] * 99}, "up to 24"),
    ({"samples": 10**5000}, "whole number"),
    ({"samples": [1.0]}, r"samples has shape \(1,\): give a number, or times in s that increase"),
    ({"samples": [0.0, "2 m"]}, r"samples\[1\]: '2 m' has another unit"),
    ({"samples": [0.0, 2.0, 2.0]}, r"samples\[2\] = 2 s: give times in s that increase"),
    ({"samples": [0.0, 5.5]}, r"samples\[1\] = 5.5 s: .* from 0 to 5 s"),
    ({"duration": 10**5000}, "not finite"),
    ({"parameters": {"l1": 1e300}}, "mass matrix is not finite"),
    ({"beside": {}}, r"write \[\[beside\]\]"),
    ({"beside": [{"label": "x", "duration": 3}]}, r"\[\[beside\]\] has no key 'duration'"),
    ({"beside": [{"label": "x", "initial": {"theta1": "x"}}]}, "initial.theta1"),
])  # fmt: skip
def test_invalid_scenes_are_refused_with_a_remedy(changes: dict[str, object], words: str) -> None:
    with pytest.raises((InputError, ValueError), match=words):
        scene_from(**changes)


def test_samples_may_be_a_list_of_times() -> None:
    uneven = scene_from(samples=[0.5, "1500 ms", 4])
    result, even = run_scene(uneven), run_scene(replace(uneven, samples=11))
    assert result.t.tolist() == [0.5, 1.5, 4.0]
    errors = [one.selection.model.error_estimate for one in (result, even)]
    assert np.abs(result.y - even.y[:, [1, 3, 8]]).max() <= sum(errors)
    assert max(errors) <= uneven.accuracy


@pytest.mark.parametrize("method", ["LSODA", "verner853"])
def test_methods_that_control_their_steps_need_none(method: str) -> None:
    assert (scene_from(method=method).method, scene_from(method=method).step) == (method, None)


@pytest.mark.parametrize("key", ["system", "duration", "initial"])
def test_a_missing_key_is_named(key: str) -> None:
    with pytest.raises(InputError, match=f"'{key}' is missing"):
        scene("mine", {k: v for k, v in PLAIN.items() if k != key}, load_module)


def test_a_file_that_is_no_scene_is_refused_with_little_work(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    cases = {
        b"x" * 50_000_000: "more than",
        b"a = " + b"[" * 40_000: "is not valid TOML",
        b"\xff\xfe": "is not valid TOML",
        b'system = "double_pendulum"\n': "'duration' is missing",
        b"system = ": "is not valid TOML",
    }
    for content, words in cases.items():
        path.write_bytes(content)
        with pytest.raises(InputError, match=words), counted_calls() as calls:
            read(path, load_module)
        assert calls.count < 10_000
    with pytest.raises(InputError, match=r"none.toml: there is no such file"):
        read(tmp_path / "none.toml", load_module)


def test_a_scene_has_the_values_of_its_file(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("""
        title = "mine"
        system = "double_pendulum"
        duration = "2 s"
        accuracy = 1e-4
        outputs = ["theta1", "energy"]
        method = "rk4"
        step = "1 ms"
        pictures = ["theta1, theta2 over t", "path"]
        [parameters]
        m2 = "300 g"
        g = "-1 m/s^2"
        [initial]
        theta1 = "45 deg"
        theta2 = 0
        theta2_dot = "1 turn/s"
        [[beside]]
        label = "other"
        initial = { theta1 = "pi/4 + 1e-3" }
        [[beside]]
        label = "better"
        method = "verner98"
    """)
    mine = find(str(tmp_path / "mine.toml"), load_module)
    assert mine.name == "mine"
    assert mine.module is dp
    assert mine.params == (1.0, 0.3, 2.0, 2.0, -1.0)
    assert mine.y0 == pytest.approx((pi / 4, 0, 0, 2 * pi))
    assert (mine.duration, mine.accuracy, mine.step) == (2.0, 1e-4, 1e-3)
    assert mine.requested == (0,)
    other, better = mine.beside
    assert other.y0 == pytest.approx((pi / 4 + 1e-3, 0, 0, 2 * pi))
    assert (other.method, other.step, other.label) == ("rk4", 1e-3, "other")
    # a method replaces method and step of the first scene
    assert (better.method, better.step, better.y0) == ("verner98", None, mine.y0)


@pytest.mark.parametrize(("changes", "words"), [
    ({"y0": (1, 2, 3)}, r"y0 has shape \(3,\): give 4 numbers, theta1"),
    ({"y0": (1, 2, float("nan"), 0)}, "theta1_dot = nan must be a finite real number in rad/s"),
    ({"params": (1, -1, 2, 2, 9.81)}, "m2 = -1.0 must be positive, in kg"),
    ({"duration": float("inf")}, "duration = inf must be a finite real number"),
    ({"outputs": ("theta9",)}, "outputs name 'theta9'"),
    ({"method": "rk4", "step": -1.0}, "step = -1.0 must be positive"),
])  # fmt: skip
def test_a_scene_in_python_is_as_strict(changes: dict[str, Any], words: str) -> None:
    plain = {"module": dp, "params": dp.DEFAULTS, "y0": (1, 2, 0, 0), "duration": 5.0}
    assert Scene(**plain).outputs == dp.STATE
    with pytest.raises(ValueError, match=words):
        Scene(**{**plain, **changes})


def test_the_default_title_is_the_whole_title_of_the_system(tmp_path: Path) -> None:
    (tmp_path / "bead.toml").write_text(
        'title = "Bead of 1.5 kg: on a wire, no. 2"\ncoordinates = { x = { unit = "m" } }\n'
        'masses = [{ mass = "3/2", position = ["x", "0"] }]\npotential = "x**2"\n'
    )
    path = tmp_path / "scene.toml"
    path.write_text('system = "bead.toml"\nduration = 1\ninitial = { x = 1 }\n')
    assert read(path, load_module).title == "Bead of 1.5 kg: on a wire, no. 2"
    path.write_text(
        'system = "bead.toml"\nduration = 1\naxes = { x = { from = 0, to = 1, count = 2 } }\n'
        'maps = { end = { kind = "final", of = ["x"] } }\n'
    )
    assert load_sweep(path).title == "Bead of 1.5 kg: on a wire, no. 2"


def test_the_accuracy_is_1e_6_by_default_and_1e_13_at_most() -> None:
    assert scene_from().accuracy == 1e-6
    assert scene_from(accuracy=1e-13).accuracy == 1e-13
    assert (scene_from().label, scene_from().samples) == (scene_from().title, 0)
    assert [len(scene_from(**change).times) for change in ({}, {"samples": 7})] == [501, 7]


def test_degrees_without_a_unit_cause_a_warning() -> None:
    with pytest.warns(UserWarning, match='theta1 = 90 is 14.3 turns: write "90 deg"'):
        scene_from(initial={"theta1": 90, "theta2": 0})
    scene_from(initial={"theta1": "90 rad", "theta2": 0})


def test_a_scene_beside_another_is_labelled_by_the_differences() -> None:
    (one,) = scene_from(beside=[{"method": "rk4", "step": "1 ms", "initial": {"theta1": 2}}]).beside
    title = "Double pendulum: two point masses on rigid massless rods in a vertical plane"
    assert (one.title, one.label) == (title, "rk4, step = 1 ms, theta1 = 2")
    assert scene_from().title == title


def test_a_nearly_singular_mass_matrix_is_reported_with_its_coordinate() -> None:
    with pytest.warns(MassMatrixWarning, match=r"condition 4e\+12: theta"):
        scene_from(parameters={"m1": 1e-12})
    with pytest.raises(ValueError, match=r"condition .* theta. has hardly any inertia of its own"):
        scene_from(parameters={"m1": 1e-16})
    scene_from(parameters={"m2": 1e-12})  # light, but on its own


def test_splittings_use_lagranges_equations_unless_the_scene_names_others() -> None:
    scene = Scene(sp, sp.DEFAULTS, (1.0, 0.0), 1.0, method="leapfrog", step=0.01)
    assert scene.form is None
    with pytest.raises(ValueError, match="hamiltonian"):
        replace(scene, form="hamiltonian")


def test_all_shipped_scenes_are_valid() -> None:
    modules: set[ModuleType] = set()
    for name in names():
        one = find(name, load_module)
        assert len(one.y0) == len(one.module.STATE)
        assert len(one.params) == len(one.module.PARAMETERS)
        assert one.note
        modules.add(one.module)
    assert len(modules) == 3
    assert find("light_above", load_module).params == (1.0, 3.0, 2.0, 2.0, 9.81)
    assert {f"figure_{n}_{k}" for n in (3, 4) for k in range(1, 7)} <= set(names())
    with pytest.raises(InputError, match=r"'reprot' is not one of .*did you mean 'report'"):
        find("reprot", load_module)


def test_the_scenes_of_the_report_s_programs_have_the_printed_values() -> None:
    from derive.verification.report.programs import PROSE, programs

    settings = {"report": PROSE, **{f"program_{k + 1}": p.scene for k, p in enumerate(programs())}}
    for name, printed in settings.items():
        one = find(name, load_module)
        expected = [*printed.masses, *printed.lengths, printed.gravity]
        assert one.params == pytest.approx([float(x) for x in expected], rel=1e-15)
        start = [*printed.angles, *printed.velocities]
        assert one.y0 == pytest.approx([float(x) for x in start], rel=1e-15)
        assert one.duration == float(printed.duration)
