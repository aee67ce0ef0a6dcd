"""Generated files: the same bytes everywhere, checked, and complete at all times."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from runpy import run_path
from types import ModuleType

import pytest
from folders import ROOT

import generated
from derive.codegen.module_files import GeneratedFiles
from derive.commands import regenerate as command
from derive.commands.regenerate import main, planned
from solvers import integrate


def derive(*arguments: str, hash_seed: str = "random") -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONHASHSEED": hash_seed}
    return subprocess.run(
        [sys.executable, "-m", "derive", *arguments],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env=environment,
        check=False,
    )


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package of two systems in place of that of all systems."""
    monkeypatch.setattr(command, "names", lambda: ("double_pendulum", "single_pendulum"))
    monkeypatch.setattr(command, "_package_folder", lambda: tmp_path)
    assert main([]) == 0
    return tmp_path


# test_the_committed_files_are_what_the_generator_writes has a random seed
@pytest.mark.long("derives all systems in another process")
@pytest.mark.parametrize("seed", ["0", "1", pytest.param("2", marks=pytest.mark.campaign)])
def test_the_bytes_do_not_depend_on_the_hash_seed(seed: str, tmp_path: Path) -> None:
    assert derive("--output", str(tmp_path), hash_seed=seed).returncode == 0
    for path in tmp_path.iterdir():
        assert path.read_bytes() == (ROOT / "generated" / path.name).read_bytes()


def test_a_header_and_a_module_of_different_versions_are_refused_and_mended(tmp_path: Path) -> None:
    arguments = ["single_pendulum", "--output", str(tmp_path)]
    path, header = tmp_path / "single_pendulum.py", tmp_path / "single_pendulum.h"

    def final_state() -> list[float]:
        module = ModuleType("single_pendulum")
        vars(module).update(run_path(str(path)), __file__=str(path))
        motion = integrate(module, (0, 1), (1, 0), module.DEFAULTS, backend="compiled")
        return list(motion.y[:, -1])

    assert main(arguments) == 0
    text, end = header.read_text(), final_state()
    # killed between the two renames: only one file is new
    digest = run_path(str(path))["DIGEST"]
    header.write_text(text.replace("l*", "2*l*").replace(digest, "0123456789abcdef"))
    with pytest.raises(ValueError, match=r"single_pendulum\.h and .*\.py are of different version"):
        final_state()
    assert main(["--check", *arguments]) == 1
    assert main(arguments) == 0
    assert (header.read_text(), final_state()) == (text, end)


def test_the_bytes_do_not_depend_on_what_was_derived_before() -> None:
    texts = planned(["single_pendulum"], None).texts
    planned(["double_pendulum"], None)
    assert planned(["single_pendulum"], None).texts == texts


def test_the_committed_files_are_what_the_generator_writes() -> None:
    run = derive("--check")
    assert run.returncode == 0, run.stdout
    assert run.stdout.startswith(f"{3 * len(generated.__all__) + 2} files in ")


def test_files_contain_no_path_version_or_date() -> None:
    for path in (ROOT / "generated").glob("*.py"):
        text = re.sub("DIGEST = .*", "", path.read_text())  # which has any digits
        for foreign in (str(ROOT), os.uname().nodename, "1.14", "202"):
            assert foreign not in text


@pytest.mark.long("other tests reach its code")
def test_a_changed_character_is_detected_shown_and_restored(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = folder / "double_pendulum.py"
    path.write_text(path.read_text().replace("sin_x0", "sin_xO", 1))
    assert main(["--check"]) == 1
    shown = capsys.readouterr().out
    assert f"{path}: differs" in shown
    assert "-    sin_xO = sin(x0)\n" in shown
    assert "+    sin_x0 = sin(x0)\n" in shown
    assert "to update it: holonomic derive double_pendulum\n" in shown
    assert main(["double_pendulum"]) == 0
    assert main(["--check"]) == 0


def test_a_missing_file_is_detected(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "single_pendulum.py").unlink()
    assert main(["--check"]) == 1
    shown = capsys.readouterr().out
    assert "single_pendulum.py: missing" in shown
    assert "holonomic derive single_pendulum" in shown
    assert main(["--check", "double_pendulum"]) == 0


def test_an_orphan_is_reported_and_not_removed(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "triple_pendulum.py").write_text("")
    assert main(["--check"]) == 1
    assert f"to update it: rm {folder / 'triple_pendulum.py'}" in capsys.readouterr().out
    (folder / "single_pendulum.py").unlink()
    assert main([]) == 0
    shown = capsys.readouterr().out
    orphan = folder / "triple_pendulum.py"
    assert f"nothing generates {orphan}; remove it with: rm {orphan}\n" in shown
    assert f"wrote {folder / 'single_pendulum.py'}\n" in shown
    assert orphan.exists()


def test_an_output_folder_may_have_files_of_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "own.py").write_text("")
    arguments = ["single_pendulum", "--output", str(tmp_path)]
    assert main(arguments) == 0
    assert main(["--check", *arguments]) == 0
    assert "own.py" not in capsys.readouterr().out


def test_an_unreadable_argument_has_the_exit_code_of_files(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def unreadable(*_: object) -> int:
        raise OSError("mine.toml: is a folder")

    monkeypatch.setattr(command, "run", unreadable)
    assert main(["mine.toml"]) == 4
    assert capsys.readouterr().err == "holonomic derive: mine.toml: is a folder\n"


def test_a_reader_that_needs_no_more_is_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def closed(*_: object) -> int:
        raise BrokenPipeError

    monkeypatch.setattr(command, "run", closed)
    assert main(["single_pendulum"]) == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["double_pendulun"], "did you mean 'double_pendulum'?"),
        (["__import__('os')"], "no system is called"),
    ],
)
def test_an_unknown_system_is_refused_with_those_that_exist(
    arguments: Sequence[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    shown = capsys.readouterr().err
    assert message in shown
    assert "single_pendulum" in shown


def test_a_folder_that_cannot_be_written_to_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    assert main(["single_pendulum", "--output", str(tmp_path / "file" / "folder")]) == 4
    shown = capsys.readouterr().err
    assert str(tmp_path / "file") in shown
    assert "--output" in shown


def test_current_files_are_not_written_again(tmp_path: Path) -> None:
    tree = GeneratedFiles(tmp_path, {"a.py": "a\n", "b.py": "b\n"}, complete=True)
    assert [path.name for path in tree.write()] == ["a.py", "b.py"]
    (tmp_path / "b.py").write_text("c\n")
    assert [path.name for path in tree.write()] == ["b.py"]
    assert tree.write() == []


def test_a_failed_write_leaves_the_old_files_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    GeneratedFiles(tmp_path, {"a.py": "old\n"}, complete=True).write()

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        GeneratedFiles(tmp_path, {"a.py": "new\n"}, complete=True).write()
    assert [path.name for path in tmp_path.iterdir()] == ["a.py"]
    assert (tmp_path / "a.py").read_text() == "old\n"


def test_the_next_run_removes_files_of_a_killed_run_but_not_of_an_active_one(
    tmp_path: Path,
) -> None:
    sleeper = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    temporary = tmp_path / f".a.py.{sleeper.pid}"
    temporary.write_text("")
    tree = GeneratedFiles(tmp_path, {"a.py": "a\n"}, complete=True)
    tree.write()
    assert temporary.exists()
    assert tree.orphans() == []
    sleeper.kill()
    sleeper.wait()
    tree.write()
    assert not temporary.exists()


@pytest.mark.long("other tests reach its code")
def test_a_kill_at_any_moment_leaves_complete_files(tmp_path: Path) -> None:
    old = {f"m{k}.py": "old\n" * 20_000 for k in range(8)}
    code = (
        "import sys; from pathlib import Path\n"
        "from derive.codegen.module_files import GeneratedFiles\n"
        "for n in range(10**6):\n"
        "    texts = {f'm{k}.py': f'{n}\\n' * 20_000 for k in range(8)}\n"
        "    GeneratedFiles(Path(sys.argv[1]), texts, complete=True).write()\n"
        "    print(n, flush=True)\n"
    )
    GeneratedFiles(tmp_path, old, complete=True).write()
    for pause in (0.0, 0.001, 0.003, 0.007, 0.013):
        run = subprocess.Popen(
            [sys.executable, "-c", code, str(tmp_path)], cwd=ROOT, stdout=subprocess.PIPE
        )
        assert run.stdout is not None
        assert run.stdout.readline() == b"0\n"
        time.sleep(pause)
        run.send_signal(signal.SIGKILL)
        run.wait()
        run.stdout.close()
        for name in old:
            lines = (tmp_path / name).read_text().splitlines()
            assert len(lines) == 20_000
            assert len(set(lines)) == 1
    GeneratedFiles(tmp_path, old, complete=True).write()
    assert {path.name for path in tmp_path.iterdir()} == set(old)
