"""Input files of any kind: regular, small, and with keys that are read in a moment."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from folders import ROOT

from solvers.app.cli import main
from solvers.app.modules import load
from solvers.io.toml_input import InputError, read_table

COMMANDS = [["run"], ["sweep"], ["verify"], ["derive", "--output", "out"]]
LONG = ".".join("a" * 49_000)


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("kind", ["pipe", "device", "folder"])
def test_files_that_are_not_regular_are_refused(
    command: list[str],
    kind: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "mine.toml"
    {
        "pipe": lambda: os.mkfifo(path),
        "device": lambda: path.symlink_to("/dev/zero"),
        "folder": path.mkdir,
    }[kind]()
    assert main([*command, "mine.toml"]) == 2
    assert "mine.toml is no file" in capsys.readouterr().err


@pytest.mark.parametrize("text", [
    f"{LONG} = 1", f"[{LONG}]", f"a = {{ {LONG} = 1 }}", f"a = [{{ {LONG} = 1 }}]",
    ".".join(["'a b'"] * 9000) + " = 1", " . ".join("a" * 9000) + " = 1",
])  # fmt: skip
def test_a_key_of_thousands_of_parts_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=r"mine\.toml is not valid TOML: a key has more than 100"):
        read_table(path, "")


def test_long_texts_with_points_are_no_keys(tmp_path: Path) -> None:
    path, formula = tmp_path / "mine.toml", " + ".join(f"{n}.5*x" for n in range(2000))
    path.write_text(f'a.b = "{formula}"\nc = "{"word" * 9000}"\n')
    assert read_table(path, "")["a"] == {"b": formula}


def test_a_byte_order_mark_is_no_part_of_the_first_key(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("system = 1\n", encoding="utf-8-sig")
    assert read_table(path, "") == {"system": 1}


def test_a_missing_package_is_written_beside_its_generator(tmp_path: Path) -> None:
    for package in ("derive", "solvers"):
        shutil.copytree(ROOT / package, tmp_path / package)
    command = [sys.executable, "-m", "derive", "single_pendulum"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    assert (tmp_path / "generated" / "single_pendulum.py").is_file()


@pytest.mark.parametrize("command", ["run", "verify", "demo", "sweep", "chart"])
def test_a_damaged_package_is_reported_with_the_command_that_mends_it(
    command: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    arguments = {"verify": [], "sweep": ["flips"], "demo": ["--output", str(tmp_path)]}

    def damaged(_: str) -> None:
        raise SyntaxError("'(' was never closed")

    monkeypatch.setattr("solvers.app.modules.import_module", damaged)
    assert main([command, *arguments.get(command, ["report"])]) == 4
    message = capsys.readouterr().err
    assert "generated is damaged: SyntaxError: '(' was never closed" in message
    assert "mend it with: holonomic derive" in message


@pytest.mark.parametrize("missing", ["generated", "numpy"])
def test_a_system_is_built_without_the_package_and_not_beside_a_broken_import(
    missing: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def absent(_: str) -> None:
        raise ModuleNotFoundError(f"No module named {missing!r}", name=missing)

    monkeypatch.setattr("solvers.app.modules.import_module", absent)
    monkeypatch.setattr("solvers.app.modules.build", lambda system: system.name)
    if missing == "generated":
        assert load("single_pendulum") == "single_pendulum"
    else:
        with pytest.raises(OSError, match=r"generated is damaged: .* No module named 'numpy'"):
            load("single_pendulum")


@pytest.mark.parametrize("name", ["generated", "derive", "solvers", "math", "collections"])
def test_a_system_hides_no_module(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = """
    potential = 0
    coordinates = { x = { unit = "m" } }
    parameters = { m = { value = 1, unit = "kg" } }
    masses = [{ mass = "m", position = ["x", "0"] }]
    """
    path = tmp_path / f"{name}.toml"
    path.write_text(text)
    assert main(["derive", str(path), "--output", str(tmp_path)]) == 2
    assert f"its module would hide the module {name!r}" in capsys.readouterr().err
