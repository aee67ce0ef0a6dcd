"""One file adds a system: to derivation, code, verification, listings and documentation."""

import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

from derive import Derivation, load, names, systems
from derive.system.files.system_catalogue import markdown_table
from solvers.app.cli import main

SYSTEM = r'''
r"""A bead on a parabola.

    \     /
     \_o_/    an example
"""
from sympy import symbols

from derive import Coordinate, Parameter, PointMass, System

x, g = symbols("x g", real=True)
m, k = symbols("m k", positive=True)
system = System(
    name="parabola", title="Bead on a parabola",
    coordinates=[Coordinate(x, "m", "horizontal position")],
    parameters=[Parameter(m, "kg", 1.0, "mass"), Parameter(k, "1/m", 0.5, "curvature"),
                Parameter(g, "m/s^2", 9.81, "gravity")],
    masses=[PointMass(m, (x, k * x**2))])

PUBLISHED = """
source = "an example"
euler_lagrange = ["m*(1 + 4*k**2*x**2)*x_ddot + 4*k**2*m*x*x_dot**2 + 2*g*k*m*x = 0"]
"""
'''


@pytest.fixture(autouse=True)
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    folder = tmp_path / "systems"
    folder.mkdir()
    (folder / "parabola.py").write_text(SYSTEM.lstrip())
    monkeypatch.setattr(systems, "__path__", [*systems.__path__, str(folder)])
    yield folder / "parabola.py"
    sys.modules.pop("derive.systems.parabola", None)


def test_it_is_listed_and_derived(capsys: pytest.CaptureFixture[str]) -> None:
    assert "parabola" in names()
    assert str(Derivation(load("parabola")).mass_matrix[0]) == "m*(4*k**2*x**2 + 1)"
    assert main(["systems", "parabola"]) == 0
    assert "parabola: Bead on a parabola" in capsys.readouterr().out


def test_its_code_is_generated_and_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert main(["derive", "parabola", "--output", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.glob("parabola.*")} == {"parabola.h", "parabola.py"}
    monkeypatch.syspath_prepend(tmp_path)
    module = import_module("parabola")
    assert module.rhs(0.0, (1.0, 0.0), (1.0, 0.5, 10.0)) == (0.0, -5.0)


def test_its_published_equations_are_verified(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["verify", "parabola"]) == 0
    assert "parabola: an example" in capsys.readouterr().out
    file.write_text(file.read_text().replace("2*g*k*m*x", "g*k*m*x"))
    sys.modules.pop("derive.systems.parabola")
    assert main(["verify", "parabola"]) == 1


def test_it_has_a_row_in_the_table_of_systems() -> None:
    assert "| `parabola` | `x` | A bead on a parabola | an example |\n" in markdown_table()
