"""The front doors: every public name from `derive`, `solvers` and `holonomic`, loaded on use."""

import subprocess
import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import derive
import generated.double_pendulum as dp
import holonomic
import solvers
from solvers import Final, Grid, Sweep, load_scene, load_sweep, run_scene, sweep
from solvers.io.lazy import groups
from solvers.io.toml_input import InputError
from solvers.scenes.scene_reading import FILES
from solvers.sweeps.definition import sweep_reading

HEAVY = ("sympy", "numpy", "scipy", "matplotlib")


def loaded(code: str, packages: Iterable[str] = HEAVY) -> set[str]:
    """Numerical packages that a new process loads for these statements."""
    report = f"print(*({set(packages)!r} & {{*sys.modules}}))"
    argv = [sys.executable, "-c", f"import sys\n{code}\n{report}"]
    return {*subprocess.run(argv, capture_output=True, text=True, check=True).stdout.split()}


@pytest.mark.parametrize("package", ["derive", "solvers", "holonomic"])
def test_importing_and_completing_load_no_numerical_package(package: str) -> None:
    assert loaded(f"import {package}; dir({package}); {package}.__all__") == set()


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(
    ("statement", "packages"),
    [
        ("from solvers import integrate, ensemble, prepare, ode_solver, Event", {"numpy", "scipy"}),
        ("from holonomic import Scene, Sweep, run_scene, sweep, load", {"numpy", "scipy"}),
        ("from derive import System, PointMass, Derivation, load, write", {"sympy"}),
    ],
)
def test_a_name_loads_only_the_packages_that_it_needs(statement: str, packages: set[str]) -> None:
    assert loaded(statement) <= packages


def test_a_run_loads_no_parts_of_scipy() -> None:
    # they take as long to load as SymPy
    parts = [f"scipy.{name}" for name in ("integrate", "linalg", "optimize", "special")]
    code = (
        "import generated.double_pendulum as dp; from solvers import integrate;"
        "integrate(dp, (0, 1), (1.0, 0.0, 0.0, 0.0), {{}}, method='{}')"
    )
    assert loaded(code.format("dop853"), parts) == set()
    assert loaded(code.format("RK45"), parts) == set(parts)


def test_holonomic_offers_all_public_names() -> None:
    assert {*dir(holonomic)} >= {*dir(derive), *dir(solvers)}
    for name in {*derive.__all__} - {*solvers.__all__}:
        assert getattr(holonomic, name) is getattr(derive, name)
    for name in solvers.__all__:
        assert getattr(holonomic, name) is getattr(solvers, name)


@pytest.mark.parametrize("package", [derive, solvers])
def test_a_package_lists_each_public_name_in_one_group(package: ModuleType) -> None:
    listed = [name for names in groups(package.__name__).values() for name in names]
    assert sorted(listed) == package.__all__


@pytest.mark.parametrize("name", ["derive", "solvers"])
@pytest.mark.parametrize("hiding", ["{}.py", "{}/__init__.py"])
def test_a_folder_that_hides_a_package_is_named(hiding: str, name: str, tmp_path: Path) -> None:
    path = tmp_path / hiding.format(name)
    path.parent.mkdir(exist_ok=True)
    path.touch()
    argv = [sys.executable, "-c", "import holonomic"]
    ended = subprocess.run(argv, capture_output=True, text=True, cwd=tmp_path, check=False)
    hides = path.parent if path.stem == "__init__" else path
    message = f"ImportError: {hides.resolve()} hides the package {name!r} of holonomic, "
    *_, last = ended.stderr.splitlines()
    assert last.startswith(message)
    assert last.endswith("rename it, or start Python in another folder")


@pytest.mark.parametrize("package", [derive, solvers, holonomic])
def test_an_unknown_name_raises_an_attribute_error(package: object) -> None:
    with pytest.raises(AttributeError, match="has no attribute 'intergate'"):
        _ = package.intergate  # type: ignore[attr-defined]


def test_a_scene_runs_by_name_by_file_and_as_an_object() -> None:
    by_name = run_scene("single")
    by_file = run_scene(FILES / "single.toml")
    as_object = run_scene(load_scene("single"))
    assert by_name.is_met
    assert np.array_equal(by_name.y, by_file.y)
    assert np.array_equal(by_name.y, as_object.y)
    with pytest.raises(InputError, match="did you mean 'single'"):
        run_scene("singel")


def test_results_are_shown_briefly(tmp_path: Path) -> None:
    result = run_scene("report")
    lines = repr(result).splitlines()
    assert lines[:2] == ["SceneResult: the report's scene", "  t = 0 to 5 s, 501 samples"]
    assert lines[2] == f"  model: full equations by {result.method}, {result.form} form"
    assert lines[3].endswith(", requested 1e-09")
    assert lines[4].startswith("  final state: theta1 = 2.22806 rad, theta2 = -0.267045 rad, ")
    assert "model: pendulum\n" in repr(run_scene("single"))
    axes = Grid({"theta1": [0.1, 0.2, 0.3], "theta2": [0.0, 0.1]})
    definition = Sweep(dp, axes, {"end": Final(("theta1",))}, duration=1)
    shown = repr(sweep(definition, tmp_path))
    assert "\n" not in shown
    assert shown.endswith(" 6 motions, finished 6; maps: end (3, 2, 1)")


def test_specialised_code_needs_no_further_argument() -> None:
    scene = replace(load_scene("report"), duration=0.5, code="specialised")
    assert run_scene(scene).is_met


def test_a_sweep_runs_by_file_and_as_an_object(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="did you mean 'flips'"):
        sweep("filps", tmp_path)
    path = tmp_path / "few.toml"
    text = (sweep_reading.FILES / "flips.toml").read_text(encoding="utf-8")
    path.write_text(text.replace("512", "8"), encoding="utf-8")
    by_file = sweep(path, tmp_path / "file")
    assert by_file.status.shape == (8, 8)
    as_object = sweep(load_sweep(path), tmp_path / "object")
    assert np.array_equal(by_file.maps["flip"], as_object.maps["flip"], equal_nan=True)
    assert isinstance(load_sweep("flips").axes, Grid)
