"""Compiled code: right, cached, and never loaded before it is known to work."""

import ctypes
import os
import platform
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from shlex import quote

import numpy as np
import pytest
from benchmarks.double_pendulum import _peak_library
from folders import ROOT
from handwritten import handwritten

import generated.double_pendulum as dp
from solvers.integration.compiled import compiler, kernel, native
from solvers.integration.compiled.compiler import LIBRARY, NoCompilerError, build
from solvers.integration.compiled.kernel import program
from solvers.integration.compiled.native import native_rhs
from solvers.io import build_cache
from solvers.io.build_cache import DIGESTS, _seal

SOURCE = "int answer(void);\nint answer(void) { return 42; }\n"

CC = quote(str(shutil.which("cc")))
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


@pytest.mark.skipif(platform.machine() != "x86_64", reason="needs a processor of Intel or AMD")
def test_the_system_s_compiler_tunes_for_processors_with_vectors_of_32_bytes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wide = build(SOURCE)
    monkeypatch.setattr(compiler, "_processor", lambda: "flags : fpu sse2 avx avx2")
    assert answer(build(SOURCE).path) == 42
    assert build(SOURCE).path != wide.path
    assert compiler._tuning(("/usr/bin/cc",)) == ("-mtune=skylake-avx512",)
    assert compiler._tuning(("/usr/bin/zig", "cc")) == ()


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


def fake_compiler(folder: Path, script: str) -> tuple[str, ...]:
    path = folder / "cc"
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
    return (str(path),)


@pytest.mark.long("more cases of the same kind", keep=8)
@pytest.mark.parametrize(
    ("script", "message"),
    [
        ("echo no licence >&2; exit 1", "no licence"),
        ("exit 3", "it ended with exit 3"),
        ("kill -40 $$", "it ended with signal 40, "),
        ("exit 0", "wrote no library"),
        (": > library.so", "wrote no library"),
        ("echo text > library.so", "does not work: .*file too short"),
        (
            "echo 'int other;' > source.c; {cc} $@",
            "does not work: .*undefined symbol: LIBRARY_KEY",
        ),
        ("echo 'char LIBRARY_KEY[] = {{1, 0}};' > source.c; {cc} $@", "it is another one"),
        ("{cc} $@; truncate -s 9000 library.so", "does not work: "),
        (
            "{cc} $@; printf '\\267' | dd of=library.so bs=1 seek=18 conv=notrunc",
            "does not work: ",
        ),
        ("sleep 60; true", "did not end within 1 s"),
        ("yes >&2", "did not end within 1 s"),
        ("sleep 2 & exit 1", "exit 1"),
    ],
)
def test_after_a_failing_compiler_the_next_is_used_with_a_notice(
    script: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    working = (str(shutil.which("cc")),)
    broken = fake_compiler(tmp_path, script.format(cc=CC))
    if {"sleep", "yes"} & {*script.split()}:
        monkeypatch.setattr(compiler, "PATIENCE", 0.5)
        monkeypatch.setattr(compiler, "TRIAL_LIMIT", 0.5)
    monkeypatch.setattr(compiler, "compilers", lambda: iter([broken]))
    with pytest.raises(NoCompilerError, match=message):
        build(SOURCE)
    monkeypatch.setattr(compiler, "compilers", lambda: iter([broken, working]))
    with pytest.warns(UserWarning, match=f"^compiling with {working[0]}: .*{message}"):
        library = build(SOURCE)
    assert library.compiler == working[0]
    assert answer(library.path) == 42


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("__builtin_trap();", "it ended with signal "),
        ("for (;;) {}", "it did not return within 0.5 s"),
    ],
)
def test_a_library_that_cannot_be_called_is_not_kept(
    body: str, message: str, own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compiler, "PROBE_LIMIT", 0.5)
    with pytest.raises(NoCompilerError, match=message):
        build(f"{SOURCE}void probe(void);\nvoid probe(void) {{ {body} }}\n")
    assert [*own_cache.iterdir()] == []


@pytest.mark.parametrize("lanes", [False, True])
def test_loops_and_right_hand_sides_are_called_before_they_are_kept(
    lanes: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def trapped(*arguments: object, **options: object) -> str:
        text = program(*arguments, **options)  # type: ignore[arg-type]
        function = "static __attribute__((noinline)) mask advance("
        assert function in text  # a step
        i = text.index("{", text.index(function)) + 1
        return f"{text[:i]} __builtin_trap(); {text[i:]}"

    monkeypatch.setattr(kernel, "program", trapped)
    with pytest.raises(NoCompilerError, match="does not work: it ended with signal"):
        kernel.Kernel(dp, "rational", "rk4", lanes=lanes)
    wrapper = native.WRAPPER.replace("params, dy);", "params, dy); __builtin_trap();")
    monkeypatch.setattr(native, "WRAPPER", wrapper)
    with pytest.raises(NoCompilerError, match="does not work: it ended with signal"):
        native_rhs(dp)


def test_a_library_of_another_program_is_replaced() -> None:
    other, library = build(SOURCE.replace("42", "13")), build(SOURCE)
    folder = library.path.parent
    shutil.rmtree(folder)
    shutil.copytree(other.path.parent, folder)
    assert answer(build(SOURCE).path) == 42
    # also with a seal under the name of the first one
    content = other.path.read_bytes()
    library.path.unlink()
    library.path.write_bytes(content)
    (folder / DIGESTS).write_text(_seal(folder.name, {LIBRARY: content}))
    assert build(SOURCE).path.read_bytes() != content


def counting(folder: Path, script: str) -> tuple[str, ...]:
    return fake_compiler(folder, f"echo >> {folder}/calls\n{script}")


def calls(folder: Path) -> int:
    return len((folder / "calls").read_text())


@pytest.mark.parametrize("script", ["exit 1", "sleep 60"])
def test_a_broken_compiler_is_tried_once_in_a_process_its_threads_and_forks(
    script: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = counting(tmp_path, script)
    monkeypatch.setattr(compiler, "compilers", lambda: iter([broken]))
    monkeypatch.setattr(compiler, "PATIENCE", 0.3)
    monkeypatch.setattr(compiler, "TRIAL_LIMIT", 0.3)

    with ThreadPoolExecutor(4) as threads:
        assert all(threads.map(fails, range(8)))
    with ProcessPoolExecutor(2, get_context("fork")) as processes:
        assert all(processes.map(fails, range(8, 12)))
    assert calls(tmp_path) == 2  # the program and a small one


def test_a_hanging_compiler_is_known_to_other_processes_for_some_time(
    tmp_path: Path, own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hanging = counting(tmp_path, "sleep 60")
    monkeypatch.setattr(compiler, "compilers", lambda: iter([hanging]))
    monkeypatch.setattr(compiler, "PATIENCE", 0.3)
    monkeypatch.setattr(compiler, "TRIAL_LIMIT", 0.3)

    def in_another_process() -> int:
        """The calls of the compiler so far."""
        monkeypatch.setattr(compiler, "_attempts", compiler.FailedCompilations())
        fails(1)
        return calls(tmp_path)

    assert in_another_process() == 2  # the program and a small one
    assert in_another_process() == 2
    with pytest.raises(NoCompilerError, match=r"did not end .* in another process \(remove .*/han"):
        build(SOURCE)
    (mark,) = own_cache.glob("hanging-*")
    old = time.time() - 2 * build_cache.VALID
    os.utime(mark, (old, old))
    assert in_another_process() == 4
    mark.unlink()
    os.mkfifo(mark)
    assert in_another_process() == 6
    Path(hanging[0]).write_text(f"#!/bin/sh\nexec '{shutil.which('cc')}' $@\n")
    monkeypatch.setattr(compiler, "PATIENCE", 20.0)
    monkeypatch.setattr(compiler, "_attempts", compiler.FailedCompilations())
    assert answer(build(SOURCE).path) == 42  # the mark is that of another file


def fails(k: int) -> bool:
    with pytest.raises(NoCompilerError):
        build(f"{SOURCE}/* {k} */")
    return True


def test_an_invalid_program_does_not_stop_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = counting(tmp_path, f"exec '{shutil.which('cc')}' $@")
    monkeypatch.setattr(compiler, "compilers", lambda: iter([own]))
    for _ in range(2):
        with pytest.raises(NoCompilerError, match="#error here"):
            build("#error here")
    assert calls(tmp_path) == 2
    assert answer(build(SOURCE).path) == 42


def test_a_slow_compiler_that_works_is_given_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compiler, "PATIENCE", 0.2)
    monkeypatch.setattr(compiler, "PROBE_LIMIT", 20)
    script = f"grep -q trial source.c || sleep 0.6\nexec '{shutil.which('cc')}' $@"
    monkeypatch.setattr(compiler, "compilers", lambda: iter([counting(tmp_path, script)]))
    assert answer(build(SOURCE).path) == 42


@pytest.mark.parametrize("name", ["CPATH", "C_INCLUDE_PATH"])
def test_headers_of_the_environment_are_not_included(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "stdint.h").write_text("#include_next <stdint.h>\n#define int32_t int16_t\n")
    monkeypatch.setenv(name, str(tmp_path))
    library = build(f"#include <stdint.h>\n{SOURCE.replace('42', '40 + sizeof(int32_t)')}")
    assert answer(library.path) == 44


@pytest.mark.parametrize("name", ["GCC_EXEC_PREFIX", "COMPILER_PATH", "LIBRARY_PATH"])
def test_programs_and_libraries_of_the_environment_are_not_used(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for file in ("as", "ld", "cc1", "collect2", "libm.so"):
        (tmp_path / file).write_text("#!/bin/sh\nexit 1\n")
        (tmp_path / file).chmod(0o755)
    monkeypatch.setenv(name, f"{tmp_path}/")
    assert answer(build(SOURCE).path) == 42


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
