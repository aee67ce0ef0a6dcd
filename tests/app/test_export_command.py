"""The command ``holonomic export``: files that run, and mistakes that are named."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from solvers import run_scene
from solvers.app import simulation_export
from solvers.app.cli import main


def exported(*arguments: str, folder: Path) -> int:
    return main(["export", *arguments, "--output", str(folder)])


def test_the_rows_of_a_scene_keep_its_accuracy(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exported("figure_3_1", "--to", "python", folder=tmp_path) == 0
    printed, file = capsys.readouterr().out, tmp_path / "figure_3_1.py"
    run = subprocess.run([sys.executable, file], capture_output=True, text=True, check=True)
    rows = np.array([[*map(float, row.split(","))] for row in run.stdout.splitlines()[1:]])
    scene = run_scene("figure_3_1")
    assert np.allclose(rows[:, 0], scene.t, rtol=1e-12)
    difference = abs(rows[:, 1:-1].T - scene.y).max()
    assert difference < scene.scene.accuracy
    assert f"differ from the motion of the scene by at most {difference:.1e}" in printed
    assert "run it with: python figure_3_1.py" in printed
    assert f"at most {difference:.1e}" in file.read_text()


def test_rows_that_are_too_low_differ_as_well(monkeypatch: pytest.MonkeyPatch) -> None:
    low = run_scene("figure_3_1").y - 0.002
    monkeypatch.setattr(simulation_export, "_motion", lambda *_, **__: low)
    _, simulation = simulation_export.of_scene("figure_3_1")
    assert "differ from the motion of the scene by at most 2.0e-03" in simulation.note


def test_an_event_has_rows_between_the_others(tmp_path: Path) -> None:
    arguments = ("report", "--to", "python", "--event", "theta1 = 10 deg")
    assert exported(*arguments, folder=tmp_path) == 0
    file = tmp_path / "report.py"
    run = subprocess.run([sys.executable, file], capture_output=True, text=True, check=True)
    rows = np.array([[*map(float, row.split(","))] for row in run.stdout.splitlines()[1:]])
    events = rows[rows[:, -1] == 1.0]
    assert len(events) > 0
    assert abs(events[:, 1] - np.radians(10)).max() < 1e-12
    assert (np.diff(rows[:, 0]) > 0).all()


def test_single_precision_states_its_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exported("figure_3_1", "--to", "embedded_c", folder=tmp_path) == 0
    assert "The rows in single precision differ" in capsys.readouterr().out
    assert "operations and calls at most" in (tmp_path / "figure_3_1.h").read_text()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("report", "--to", "javasript"), "did you mean 'javascript'?"),
        (("reprt", "--to", "rust"), "did you mean 'report'?"),
        (
            ("double_pendulum", "--to", "rust", "--event", "theta1 = 0"),
            "double_pendulum is a system",
        ),
        (("report", "--to", "jax"), "jax is a library of functions"),
        (("report", "--to", "rust", "--event", "theta1"), "is not NAME = VALUE"),
        (("report", "--to", "rust", "--event", "theta1 = 3 m"), "m"),
        (("program_2", "--to", "matlb"), "did you mean 'matlab'?"),
    ],
)
def test_mistakes_are_named(
    arguments: tuple[str, ...], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exported(*arguments, folder=tmp_path) == 2
    assert message in capsys.readouterr().err
    assert not [*tmp_path.iterdir()]
