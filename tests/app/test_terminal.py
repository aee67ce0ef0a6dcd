"""Commands on terminals, pipes and streams that are closed, full or in another encoding."""

import json
import os
import pty
import struct
import subprocess
import sys
import termios
import time
from contextlib import suppress
from fcntl import ioctl
from pathlib import Path
from shlex import quote

import pytest

from solvers.io import terminal
from solvers.io.terminal import Progress

SCRIPTS = Path(sys.executable).parent
#: Python does not write at once, but at the end, unless the tests' environment changes it.
BUFFERED = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}


def shell(command: str, **environment: str) -> tuple[int, str]:
    """Exit code of the first program of a pipe that calls ``holonomic``, and all messages."""
    run = subprocess.run(
        f"{command}; exit ${{PIPESTATUS[0]}}",
        shell=True,
        executable="/bin/bash",
        stderr=subprocess.STDOUT,
        stdout=subprocess.PIPE,
        check=False,
        env=BUFFERED | {"PATH": f"{SCRIPTS}{os.pathsep}{os.environ['PATH']}"} | environment,
    )
    return run.returncode, run.stdout.decode("utf-8", "backslashreplace")


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("command", ["--help", "--version", "run --help", "systems"])
def test_an_unread_pipe_is_no_error(command: str) -> None:
    assert shell(f"holonomic {command} | true") == (0, "")


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("arguments", ["--help", "--check double_pendulum"])
def test_the_module_derive_is_a_command_like_the_others(arguments: str) -> None:
    command = f"python -m derive {arguments}"
    assert shell(f"{command} | true") == (0, "")
    code, message = shell(f"{command} > /dev/full")
    assert code == 4
    assert message.endswith("No space left on device: 'standard output'\n")


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize("command", ["--help", "--version", "systems chain_2"])
def test_output_that_cannot_be_written_is_reported(command: str, unbuffered: str) -> None:
    code, messages = shell(f"holonomic {command} > /dev/full", PYTHONUNBUFFERED=unbuffered)
    (line,) = messages.splitlines()
    assert "No space left on device" in line
    if not unbuffered:
        assert line.endswith("'standard output'")
    assert code == 4


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("streams", ["2>&-", "2> /dev/full", "<&- 2>&-", "2>&1 | true"])
@pytest.mark.parametrize(("command", "code"), [
    ("--version", 0), ("sistems", 2), ("systems chain", 2), ("run nothing", 2),
])  # fmt: skip
def test_unread_messages_change_no_exit_code(command: str, code: int, streams: str) -> None:
    printed = shell(f"holonomic {command} {streams}")
    assert printed == (code, "" if code or "true" in streams else "holonomic 0.1.0\n")


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("streams", ["2>&-", "<&-", "2>&- <&-"])
def test_a_scene_runs_without_standard_error_or_input(streams: str, tmp_path: Path) -> None:
    code, printed = shell(f"holonomic run single --output {tmp_path} {streams}")
    assert code == 0
    assert "final state" in printed
    assert {path.suffix for path in tmp_path.iterdir()} == {".csv", ".html"}


def test_programs_that_a_command_starts_have_a_standard_input() -> None:
    code = (
        "import subprocess; from solvers.io.terminal import standard_streams\n"
        "with standard_streams(): print(subprocess.run('cat').returncode)"
    )
    assert shell(f"{quote(sys.executable)} -c {quote(code)} <&-") == (0, "0\n")


@pytest.mark.parametrize("streams", [">&-", ">&- <&-"])
def test_closed_output_is_refused_before_the_work(streams: str, tmp_path: Path) -> None:
    code, message = shell(f"holonomic run single --output {tmp_path} {streams}")
    assert code == 4
    assert message.startswith("holonomic: standard output is closed")
    assert not list(tmp_path.iterdir())


ENCODINGS = [
    {"PYTHONIOENCODING": "ascii"},
    {"PYTHONIOENCODING": "latin-1"},
    {"PYTHONIOENCODING": "ascii:strict"},
    {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
]


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("environment", ENCODINGS)
def test_characters_that_an_encoding_lacks_are_escaped(environment: dict[str, str]) -> None:
    code, printed = shell("holonomic systems chain_3", **environment)
    assert code == 0
    assert r"\u22ee" in printed  # the dots in the drawing of a chain
    assert "parameters: m1 = 1 kg" in printed


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("environment", ENCODINGS[:2])
def test_json_is_valid_in_every_encoding(environment: dict[str, str], tmp_path: Path) -> None:
    source = "É. Noether, \U0001d4e2"  # beyond Latin-1, and beyond 16 bits
    path = tmp_path / "own.toml"
    path.write_text(
        f'system = "single_pendulum"\nsource = "{source}"\n'
        'lagrangian = "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)"\n'
    )
    code, printed = shell(f"holonomic verify {path} --json", **environment)
    assert code == 0
    assert json.loads(printed)[0]["source"] == source


def test_a_name_that_is_no_text_is_quoted_in_a_message(tmp_path: Path) -> None:
    code, printed = shell(f"holonomic run {tmp_path}/$'a\\xff.toml'")
    assert code == 2
    assert printed.endswith("a\\udcff.toml: there is no such file\n")


@pytest.mark.parametrize(("columns", "most"), [(40, 39), (20, 19), (0, 78), (200, 78)])
def test_progress_fits_the_terminal(
    columns: int, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(terminal, "FIRST", 0.001)
    monkeypatch.setattr(terminal, "NEXT", 0.001)
    monkeypatch.setattr(terminal, "COLUMNS", 79)
    master, slave = pty.openpty()
    ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    with open(slave, "w", encoding="utf-8") as screen:
        monkeypatch.setattr(sys, "stderr", screen)
        with Progress() as report:
            report("a description that is longer than the terminal is wide " * 4)
            time.sleep(0.05)
    printed = b""
    with suppress(OSError):  # at the end
        while block := os.read(master, 4096):
            printed += block
    os.close(master)
    lines = printed.decode().split("\r")
    assert max(map(len, lines)) == most
    assert lines[-2:] == [" " * most, ""]  # erased at the end
