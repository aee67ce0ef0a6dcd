"""``holonomic fit`` from files: units, gaps, files that it writes, and input that it refuses."""

import csv
import json
import tomllib
from argparse import Namespace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from valid_files import BEAD, SCENE

import generated.single_pendulum as single
from solvers import Measurement, integrate, run_scene
from solvers.app.cli import main
from solvers.app.commands.fit import _divided, _system
from solvers.app.fitting import named_model

T = np.arange(0, 5, 1 / 30)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    noise = np.random.default_rng(5).normal(size=len(T))
    motion = integrate(single, (0, 5), {"theta": 1.0}, {"l": 0.7}, t_eval=T)
    angles = np.degrees(motion.y[0]) + noise
    rows = [f"{1000 * t:.6f};{a:.4f};{k}" for k, (t, a) in enumerate(zip(T, angles, strict=True))]
    rows[20:30] = [f"{1000 * t:.6f};;" for t in T[20:30]]
    Path("swing.csv").write_text("# a camera\nt [ms];theta [deg];frame\n" + "\n".join(rows) + "\n")
    return tmp_path


def test_a_table_with_units_and_gaps_gives_values_files_and_a_scene(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["fit", "single_pendulum", "swing.csv", "--ignore", "frame", "--json"]) == 0
    results = json.loads(capsys.readouterr().out)
    length = results["parameters"]["l"]
    assert length["interval_95"][0] < 0.7 < length["interval_95"][1]
    assert length["unit"] == "m"
    assert length["error"] < 0.001
    assert results["held"]["g"] == {"value": 9.81, "reason": "only as g/l"}
    assert results["held"]["m"]["reason"] == "no output depends on it"
    assert results["degrees_of_freedom"] == len(T) - 10 - 3
    files = {kind: Path(path) for kind, path in results["files"].items()}
    assert files["plot"].read_bytes()[1:4] == b"PNG"
    heads, *_ = lines = files["table"].read_text().splitlines()
    assert heads == "run,t,theta measured,theta fitted,theta residual"
    table = list(csv.DictReader(lines))
    assert len(table) == len(T)
    assert table[25]["theta residual"] == ""
    scene = tomllib.loads(files["scene"].read_text())
    assert scene["parameters"]["l"] == length["value"]
    again = run_scene(files["scene"])
    assert again.y[0, 0] == pytest.approx(1.0, abs=0.02)


def test_the_summary_states_values_and_held_parameters(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["fit", "single_pendulum", "swing.csv", "--ignore", "frame"]
    assert main([*arguments, "--unknown", "l"]) == 0
    text = capsys.readouterr().out
    assert "140 values of theta in 1 run, 1 unknown parameter" in text
    assert "95 % interval" in text
    assert main([*arguments, "--unknown", "l", "--compare", "l=1"]) == 0
    assert "selected: single_pendulum, with 1 unknown parameter" in capsys.readouterr().out


CASES = {
    "no quantity": ("t,thet\n0,1\n1,2\n", "'thet' names no quantity of the system (did you mean"),
    "time": ("t,theta\n0,1\n,2\n", "the time in row 2 is missing"),
    "order": ("t,theta\n0,1\n2,2\n1,3\n", "t[2] = 1.0 s is not after t[1] = 2.0 s"),
    "few": ("t,theta\n0,1\n1,2\n", "2 measured values do not suffice for 3 unknowns"),
    "empty": ("t,theta\n", "holds no data"),
    "gaps": ("t,theta\n0,\n1,nan\n", "holds no measured value"),
    "word": ("t,theta\n0,x\n", "line 2, column theta: 'x' is no number"),
    "cells": ("t,theta\n0\n", "line 2 has 1 cells, but there are 2 columns"),
    "unit": ("t,theta [kg]\n0,1\n", "the unit kg is not one of rad"),
    "unknown unit": ("t,theta [foot]\n0,1\n", "unit 'foot' is not known"),
    "no unit": ("t,theta []\n0,1\n", "column theta []: unit '' is not known"),
    "no name": ("t,[m]\n0,1\n", "column 2, '[m]', has no name"),
    "no time": ("theta\n1\n", "has no column of times"),
    "twice": ("t,theta,theta\n0,1,1\n", "two columns are named 'theta'"),
    "formula": ("t,l*sin(\n0,1\n", "cannot parse 'l*sin('"),
    "code": ("t,__import__('os')\n0,1\n", "__import__"),
    "binary": ("t,theta\n0,\udcff\n", "no text in UTF-8"),
}


@pytest.mark.parametrize("case", CASES)
def test_invalid_data_are_refused_with_the_place(
    case: str, capsys: pytest.CaptureFixture[str]
) -> None:
    text, message = CASES[case]
    Path("bad.csv").write_bytes(text.encode("utf-8", "surrogateescape"))
    assert main(["fit", "single_pendulum", "bad.csv", "--unknown", "l"]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert "bad.csv" in error or case in ("few", "formula", "code"), error


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--unknown", "l,g"], "l, g: only as g/l; give one of them a value"),
        (["--unknown", "m"], "m: no output depends on it"),
        (["--unknown", "len"], "has no parameter 'len'"),
        (["--compare", "m=1"], "'m' is not one of the unknown parameters, l"),
        (["--compare", "l=1 kg"], "--compare l: '1 kg' has another unit"),
        (["--test", "missing.csv"], "missing.csv: there is no such file"),
    ],
)
def test_invalid_options_are_refused(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["fit", "single_pendulum", "swing.csv", "--ignore", "frame", *arguments]) == 2
    assert message in capsys.readouterr().err
    assert not Path("out").exists()


def test_systems_without_parameters_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    """The potential of Henon and Heiles contains numbers only."""
    Path("star.csv").write_text("t,x\n0,0.1\n1,0.2\n")
    assert main(["fit", "henon_heiles", "star.csv"]) == 2
    assert "henon_heiles has no parameters that a fit could" in capsys.readouterr().err


def test_systems_with_constraints_are_refused_with_a_way_out(
    capsys: pytest.CaptureFixture[str],
) -> None:
    Path("crank.csv").write_text("t,phi\n0,0.5\n0.1,1.0\n0.2,1.4\n0.3,1.3\n")
    assert main(["fit", "four_bar", "crank.csv", "--unknown", "m1"]) == 2
    words = " ".join(capsys.readouterr().err.split())
    assert "system 'four_bar' has constraints, B_x, B_y: identifiable parameters, " in words
    assert "fits, need independent coordinates; write positions as functions of these" in words


def test_unknown_models_and_missing_files_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fit", "single_pendulm", "swing.csv"]) == 2
    assert "did you mean 'single_pendulum'?" in capsys.readouterr().err
    assert main(["fit", "single_pendulum", "none.csv"]) == 2
    assert main(["fit", "none.toml", "swing.csv"]) == 2


@pytest.mark.parametrize(("system", "named"), [
    ('system = "single_pendulum"', "single_pendulum"),
    ('system = "../mine.toml"', "../mine.toml"),
    ("", "../scenes/given.toml"),  # the file is that of a system
])  # fmt: skip
def test_the_new_scene_names_the_system_of_the_old_one(
    system: str, named: str, folder: Path
) -> None:
    Path("scenes").mkdir()
    Path("scenes/given.toml").write_text(system)
    arguments = Namespace(scene="scenes/given.toml", output=folder / "results")
    fitted: Any = SimpleNamespace(outputs=SimpleNamespace(module=single))
    assert _system(arguments, fitted) == named
    arguments.scene = "single"
    assert _system(arguments, fitted) == "single_pendulum"


def test_the_last_quarter_of_each_run_is_kept_back() -> None:
    t = np.linspace(2, 10, 81)
    runs = [Measurement(t, {"theta": t}), Measurement(2 * t, {"theta": t})]
    first, kept = _divided(runs)
    ends = [end for one in first for end in (one.t[0], one.t[-1])]
    assert ends == pytest.approx([2, 7.9, 4, 15.8])  # the rest begins at 8 and 16 s
    assert [begin for _, begin in kept] == pytest.approx([8, 16])
    assert [run for run, _ in kept] == runs


def test_a_model_in_a_file_is_a_system_if_it_has_masses() -> None:
    Path("bead.toml").write_text(BEAD)
    Path("swing.toml").write_text(SCENE)
    system, scene = named_model("bead.toml"), named_model("swing.toml")
    assert system.STATE == ("x", "x_dot")
    assert scene.title == "A scene"
