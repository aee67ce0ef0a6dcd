"""Random invalid files end within seconds, with a message or with finite numbers.

The ordinary tests run a sample; `make campaign` runs thousands of cases.
"""

import json
import tomllib
from math import isfinite
from pathlib import Path
from shutil import copytree
from typing import Any

import numpy as np
import pytest
from damage import contents, documents, texts, toml
from forked import Ended, forked
from fuzzing import SIZES, command, examine, in_folder
from hypothesis import strategies as st
from valid_files import ANGLES, BEAD, HAND, PENDULUM, SCENE, STARTS, SWEEP

import generated.double_pendulum as dp
from solvers import integrate
from solvers.integration.compiled.kernel import kernel


def run_sweep(folder: Path) -> Ended:
    """Run the sweep in a folder."""
    arguments = ("sweep", folder / "sweep.toml", "--output", folder / "out")
    return command(*arguments, "--json", "--workers", "1")


def damaged_files(folder: Path) -> st.SearchStrategy[tuple[str, bytes]]:
    """The relative path of one of the files in a folder, and its damaged content."""
    files = {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    return st.sampled_from(sorted(files)).flatmap(
        lambda name: st.tuples(st.just(name), contents(files[name]))
    )


def maps_in(folder: Path) -> dict[str, bytes]:
    """The maps that a sweep has written."""
    return {path.name: path.read_bytes() for path in folder.glob("*.npy")}


def is_finite(numbers: Any) -> bool:
    """Whether all numbers in JSON values are finite."""
    if isinstance(numbers, dict | list):
        return all(map(is_finite, numbers.values() if isinstance(numbers, dict) else numbers))
    return not isinstance(numbers, float) or isfinite(numbers)


@SIZES
def test_system_files(cases: int) -> None:
    def check(text: str, folder: Path) -> None:
        (folder / "mine.toml").write_text(text, encoding="utf-8")
        ended = command("derive", folder / "mine.toml", "--output", folder / "out")
        modules = [*(folder / "out").glob("mine.py")]
        assert len(modules) == (ended.value == 0)
        if modules:
            namespace: dict[str, Any] = {}
            exec(modules[0].read_text(encoding="utf-8"), namespace)
            assert np.isfinite(namespace["DEFAULTS"]).all()

    names = ("x", "x_dot", "m", "k", "c", "g", "t", "height", "value", "positive", "reactions")
    examine(cases, documents(tomllib.loads(BEAD), names), in_folder(check))


@SIZES
def test_hand_derivations(cases: int) -> None:
    def check(text: str, folder: Path) -> None:
        (folder / "page.toml").write_text(text, encoding="utf-8")
        ended = command("verify", folder / "page.toml", "--json")
        assert ended.value in (0, 1, 2)
        assert ended.value == 2 or json.loads(ended.out)

    examine(cases, documents(tomllib.loads(HAND), PENDULUM), in_folder(check))


@SIZES
def test_scenes(cases: int) -> None:
    def check(text: str, folder: Path) -> None:
        (folder / "scene.toml").write_text(text, encoding="utf-8")
        ended = command("run", folder / "scene.toml", "--output", folder / "out", "--json")
        if ended.value == 0:
            assert is_finite(json.loads(ended.out)["final_state"])

    examine(cases, documents(tomllib.loads(SCENE), ANGLES), in_folder(check))


@pytest.mark.long("random cases, each in another process")
@SIZES
def test_sweeps(cases: int) -> None:
    def check(text: str, folder: Path) -> None:
        (folder / "sweep.toml").write_text(text, encoding="utf-8")
        run_sweep(folder)

    examine(cases, documents(tomllib.loads(SWEEP), ANGLES), in_folder(check))


@SIZES
def test_tables_of_starts(cases: int) -> None:
    sweep = tomllib.loads(SWEEP) | {"axes": "starts.csv"}
    sweep["maps"] = {"end": {"kind": "final", "of": ["theta1"]}}

    def check(text: str, folder: Path) -> None:
        (folder / "sweep.toml").write_text(toml(sweep), encoding="utf-8")
        (folder / "starts.csv").write_text(text, encoding="utf-8")
        run_sweep(folder)

    examine(cases, texts(STARTS), in_folder(check))


@pytest.mark.long("random cases, each in another process")
@SIZES
def test_damaged_folders_of_sweeps(cases: int, tmp_path: Path) -> None:
    (tmp_path / "sweep.toml").write_text(SWEEP, encoding="utf-8")
    assert run_sweep(tmp_path).value == 0
    whole = maps_in(tmp_path / "out")

    def check(case: tuple[str, bytes], folder: Path) -> None:
        name, content = case
        copytree(tmp_path, folder, dirs_exist_ok=True)
        (folder / "out" / name).write_bytes(content)
        if run_sweep(folder).value == 0:
            assert maps_in(folder / "out") == whole

    examine(cases, damaged_files(tmp_path / "out"), in_folder(check))


@pytest.mark.long("random cases, each in another process")
@SIZES
def test_damaged_generated_files(cases: int, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(BEAD, encoding="utf-8")
    assert command("derive", tmp_path / "mine.toml", "--output", tmp_path / "out").value == 0
    files = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}

    def check(case: tuple[str, bytes], folder: Path) -> None:
        name, content = case
        copytree(tmp_path, folder, dirs_exist_ok=True)
        (folder / "out" / name).write_bytes(content)
        arguments = ("derive", folder / "mine.toml", "--output", folder / "out")
        assert command(*arguments, "--check").value == (content != files[name])
        assert command(*arguments).value == 0
        assert {path.name: path.read_bytes() for path in (folder / "out").iterdir()} == files

    examine(cases, damaged_files(tmp_path / "out"), in_folder(check))


@SIZES
def test_damaged_caches(cases: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    final = forked(final_state).value
    assert [*tmp_path.rglob("*.so")]

    def check(case: tuple[str, bytes], folder: Path) -> None:
        name, content = case
        copytree(tmp_path, folder, dirs_exist_ok=True)
        (folder / name).write_bytes(content)
        monkeypatch.setenv("XDG_CACHE_HOME", str(folder))
        ended = forked(final_state)
        assert ended.value == final, ended

    examine(cases, damaged_files(tmp_path), in_folder(check))


def final_state() -> list[float]:
    """The final state of a motion in a compiled loop, which is not yet in memory."""
    kernel.cache_clear()
    motion = integrate(dp, (0, 1), (1.0, 0.5, 0.0, 0.0), dp.DEFAULTS, backend="compiled")
    return list(motion.y[:, -1])
