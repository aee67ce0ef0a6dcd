"""Compiled code: right, cached, and never loaded from where it cannot be trusted."""

import ctypes
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from handwritten import handwritten

import generated.double_pendulum as dp
from solvers.integration.compiled import compiler
from solvers.integration.compiled.compiler import LIBRARY, TIME_LIMIT, NoCompilerError, build
from solvers.integration.compiled.native import native_rhs
from solvers.io.build_cache import DIGESTS, cache_folder
from solvers.studies.benchmarks.double_pendulum import _peak_library

ROOT = Path(__file__).parent.parent
SOURCE = "int answer(void);\nint answer(void) { return 42; }\n"

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "holonomic"


def answer(path: Path) -> int:
    return int(ctypes.CDLL(str(path)).answer())


@pytest.mark.parametrize("form", ["lagrangian", "hamiltonian", "rational"])
def test_native_right_hand_sides_give_the_bits_of_the_python_ones(form: str) -> None:
    rhs = native_rhs(dp, form, reproducible=True)
    suffix = "" if form == "lagrangian" else f"_{form}"
    generator = np.random.default_rng(3)
    params = np.array(dp.DEFAULTS)
    for _ in range(50):
        y = generator.uniform(-3, 3, 6 if form == "rational" else 4)
        dy = np.empty_like(y)
        rhs.function(0.0, y.ctypes.data, dy.ctypes.data, params.ctypes.data)
        assert tuple(dy) == getattr(dp, f"rhs{suffix}")(0.0, y, params)


def test_the_address_can_be_called_from_elsewhere() -> None:
    rhs = native_rhs(dp)
    signature = ctypes.CFUNCTYPE(None, ctypes.c_double, *[ctypes.c_void_p] * 3)
    y, dy, params = np.array([0.1, 0.2, 0.3, 0.4]), np.empty(4), np.array(dp.DEFAULTS)
    signature(rhs.address)(0.0, y.ctypes.data, dy.ctypes.data, params.ctypes.data)
    assert dy == pytest.approx(dp.rhs(0.0, y, params), rel=1e-14)


def test_an_unknown_form_or_a_missing_header_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"form 'linear': double_pendulum has lagrangian, "):
        native_rhs(dp, "linear")
    (tmp_path / "alone.py").write_text("")
    module = handwritten("alone", ("y",), __file__=str(tmp_path / "alone.py"))
    with pytest.raises(ValueError, match=r"alone.h is missing: write it with holonomic derive"):
        native_rhs(module)


def test_a_library_is_built_once(monkeypatch: pytest.MonkeyPatch) -> None:
    first = build(SOURCE)
    monkeypatch.setattr(subprocess, "Popen", None)
    assert build(SOURCE) == first
    assert answer(first.path) == 42


def test_other_code_or_other_flags_are_another_library() -> None:
    paths = {build(SOURCE).path, build(SOURCE + "\n").path, build(SOURCE, reproducible=True).path}
    assert len(paths) == 3


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: data[: len(data) // 2],
        lambda data: b"",
        lambda data: data[:-1] + bytes([data[-1] ^ 1]),
        lambda data: b"something else altogether",
    ],
)
def test_a_damaged_library_is_detected_before_it_is_loaded(damage: object) -> None:
    library = build(SOURCE)
    # replaced, not overwritten, since a mapped file must not change
    data = library.path.read_bytes()
    library.path.unlink()
    library.path.write_bytes(damage(data))  # type: ignore[operator]
    again = build(SOURCE)
    assert again.path.read_bytes() != damage(data)  # type: ignore[operator]
    assert answer(again.path) == 42


@pytest.mark.parametrize("name", [LIBRARY, DIGESTS])
def test_a_half_finished_entry_is_rebuilt(name: str) -> None:
    library = build(SOURCE)
    (library.path.parent / name).unlink()
    assert answer(build(SOURCE).path) == 42


def test_nothing_is_left_beside_finished_libraries(own_cache: Path) -> None:
    build(SOURCE)
    build(SOURCE + "\n")
    for entry in own_cache.iterdir():
        assert {path.name for path in entry.iterdir()} == {LIBRARY, DIGESTS}


def test_remains_of_killed_builds_are_removed_and_running_builds_are_not(own_cache: Path) -> None:
    build(SOURCE)
    ages = {"running": 2 * TIME_LIMIT, "killed": 11 * TIME_LIMIT}  # a build tries two compilers
    for name, age in ages.items():
        (own_cache / f"build-{name}").mkdir()
        os.utime(own_cache / f"build-{name}", (time.time() - age,) * 2)
    build(SOURCE + "\n")
    assert [path.name for path in own_cache.glob("build-*")] == ["build-running"]


def unusable(cache: Path, kind: str, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    match kind:
        case "open to all":
            cache.mkdir()
            cache.chmod(0o777)
        case "a link":
            cache.symlink_to(elsewhere)
        case "a file":
            cache.write_text("")


@pytest.mark.parametrize("kind", ["open to all", "a link", "a file"])
def test_a_cache_that_others_could_write_to_is_not_used(
    kind: str, own_cache: Path, tmp_path: Path
) -> None:
    unusable(own_cache, kind, tmp_path)
    assert cache_folder() != own_cache
    library = build(SOURCE)
    assert not library.path.is_relative_to(tmp_path)
    assert answer(library.path) == 42


def test_a_cache_of_another_user_is_not_used(
    own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own_cache.mkdir(mode=0o700)
    assert cache_folder() == own_cache
    user = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: user + 1)
    assert cache_folder() != own_cache


def test_without_a_home_it_still_works(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", "/proc/no-such-folder")
    assert answer(build(SOURCE).path) == 42


def fake_compiler(folder: Path, script: str) -> tuple[str, ...]:
    path = folder / "cc"
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
    return (str(path),)


@pytest.mark.parametrize(
    ("script", "message"),
    [
        ("echo no licence >&2; exit 1", "no licence"),
        ("exit 3", "exit 3"),
        ("exit 0", "wrote no library"),
        (": > library.so", "wrote no library"),
        ("sleep 60; true", "did not end within"),
    ],
)
def test_after_a_failing_compiler_the_next_is_tried(
    script: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken, working = fake_compiler(tmp_path, script), (str(shutil.which("cc")),)
    monkeypatch.setattr(compiler, "TIME_LIMIT", 0.5 if "sleep" in script else 60)
    monkeypatch.setattr(compiler, "compilers", lambda: iter([broken]))
    with pytest.raises(NoCompilerError, match=message):
        build(SOURCE)
    monkeypatch.setattr(compiler, "compilers", lambda: iter([broken, working]))
    library = build(SOURCE)
    assert library.compiler == working[0]
    assert answer(library.path) == 42


def test_without_a_compiler_the_message_names_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(compiler, "compilers", lambda: iter([]))
    with pytest.raises(NoCompilerError, match=r"none was found.*install one as `cc`, or .*ziglang"):
        build(SOURCE)


PROGRAM = (
    "import ctypes, sys; from solvers.integration.compiled.compiler import build;"
    f"print(ctypes.CDLL(str(build({SOURCE!r} + sys.argv[1]).path)).answer())"
)


def started(tail: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, tail], stdout=subprocess.PIPE, text=True, cwd=ROOT
    )


def test_sixteen_processes_at_once_all_succeed_and_leave_one_library(own_cache: Path) -> None:
    runs = [started("\n") for _ in range(16)]
    assert [run.communicate()[0] for run in runs] == ["42\n"] * 16
    assert len(list(own_cache.iterdir())) == 1


def test_after_a_kill_in_the_middle_the_next_run_builds_at_once() -> None:
    for pause in (0.05, 0.1, 0.15):
        run = started("\n\n")
        time.sleep(pause)
        run.send_signal(signal.SIGKILL)
        run.communicate()
    assert started("\n\n").communicate()[0] == "42\n"


def test_the_peak_program_does_the_operations_that_it_counts() -> None:
    # twelve sums, each x → x/2 + 1e-9 in every lane of a register: a product and a sum
    library, first = _peak_library(), 25.2
    for rounds in (0, 1, 2, 40):
        left = 0.5**rounds
        expected = first * left + 12 * 2e-9 * (1 - left)
        assert library.peak(rounds) == pytest.approx(expected, rel=1e-12)
    assert library.operations() in {12 * 2 * lanes for lanes in (2, 4, 8)}
