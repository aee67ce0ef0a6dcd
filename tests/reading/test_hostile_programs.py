"""Hostile programs are read or refused within seconds, and nothing of them is executed."""

import os
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from derive.reading.programs.program import ProgramError
from derive.reading.programs.program_reader import known_languages, read_program
from solvers.io.toml_input import InputError

#: Text that can be slow in a grammar, and in what follows.
HOSTILE = {
    "open brackets": "x = " + "(\n" * 45_000,
    "nested brackets": "x = " + "(\n" * 20_000 + "1" + "\n)" * 20_000,
    "nested lists": "x = " + "[\n" * 20_000 + "]\n" * 20_000,
    "continued": "x = y" + "...\n.z" * 20_000,
    "binary": "".join(map(chr, range(1, 256))) * 200,
}
HOSTILE_PROGRAMS = {
    "one long line": "x = y*sin(z); " * 7_000,
    "long sum": "x = (" + "+\n".join(["y"] * 30_000) + ")",
    "many lines": "x = y*sin(z);\n" * 7_000,
    "doubled": "x = y\n" + "x = x*x + x\n" * 400,
    "long members": ("x = y" + ".z" * 2_400 + "\n") * 20,
    "indices": "x = y" + "[0]" * 1_600,
    "huge number": "x = 9" + "9" * 4_000 + "**9**9**9",
    "no targets": "() = x\n[] = y\n(a, (b, c)) = 1, 2\n",
    "huge exponent": "x = 1e999999999; y[10**9] = 2; y[99999999999] = 1; z = 9**9**9",
    "calls": "\n".join(
        f"def f{i}(x):\n    return f{i + 1}(x) + f{i + 1}(x + 1)*f{i + 1}(x - 1)"
        for i in range(500)
    ),
    "recursion": "def f(x):\n    return f(x + 1)*f(x - 1)\n" * 3 + "y = f(2)",
    "blocks": "\n".join(" " * i + "if x:" for i in range(500)) + "\n" + " " * 500 + "x = 1",
}


@pytest.mark.long("more cases of the same kind", keep=16)
@pytest.mark.timeout(60)  # they take less than two seconds each
@pytest.mark.parametrize("language", [one.name for one in known_languages()])
@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_text_is_read_or_refused(name: str, language: str) -> None:
    with suppress(ProgramError):
        assert not read_program(HOSTILE[name], language).equations


@pytest.mark.long("more cases of the same kind", keep=4, daily=6)
@pytest.mark.parametrize("name", HOSTILE_PROGRAMS)
def test_hostile_programs_are_read_or_refused(name: str) -> None:
    with suppress(ProgramError):
        assert not read_program(HOSTILE_PROGRAMS[name], "Python").equations


def test_calls_within_calls_are_followed_eight_deep() -> None:
    def chain(count: int) -> str:
        functions = ["def g0(x):\n    return -9.81*x"]
        functions += [f"def g{i}(x):\n    return g{i - 1}(x)" for i in range(1, count)]
        last = f"def f(t, y):\n    return [y[1], g{count - 1}(y[0])]"
        return "\n".join([*functions, last, ""])

    (equation,) = read_program(chain(8), "Python").equations
    assert equation.text == "y_0_ddot = -9.81*y_0"
    recursive = "def g0(x):\n    return -g0(x)\ndef f(t, y):\n    return [y[1], g0(y[0])]\n"
    for text in (chain(9), recursive):
        program = read_program(text, "Python")
        assert program.equations == ()
        (unread,) = program.unread
        assert unread.reason.endswith("calls of g0 within calls are not followed")


def test_nothing_is_executed(tmp_path: Path) -> None:
    mark = tmp_path / "mark"
    text = f"open({str(mark)!r}, 'w')\ndef f(t, y):\n    return [y[1], exec('raise SystemExit')]\n"
    program = read_program(text, "Python")
    assert not mark.exists()
    assert [one.reason for one in program.unread] == ["the function exec is not followed"]


def test_files_are_refused_with_the_way_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "program.py"
    path.write_bytes(b"x = 1\0")
    with pytest.raises(ProgramError, match="null characters"):
        read_program(path)
    path.write_text("x" * 10_000_000)
    with pytest.raises(InputError, match=r"program\.py has more than 400000 bytes"):
        read_program(path)
    path.write_text("x" * 200_000)
    with pytest.raises(ProgramError, match="at most 100000 allowed"):
        read_program(path)
    os.mkfifo(tmp_path / "pipe.py")  # nobody writes to it
    with pytest.raises(InputError, match=r"pipe\.py is no file"):
        read_program(tmp_path / "pipe.py")
    with pytest.raises(ProgramError, match=r"unknown suffix '.txt'; known are: .c .h"):
        read_program(_text(tmp_path))
    with pytest.raises(ProgramError, match="did you mean 'Python'"):
        read_program("x = 1", "pyton")
    monkeypatch.setitem(sys.modules, "tree_sitter_python", None)
    path.write_text("x = 1")
    from derive.reading.programs.languages.language import _parser

    _parser.cache_clear()
    with pytest.raises(ProgramError, match=r"pip install 'holonomic\[documents\]'"):
        read_program(path)


def _text(folder: Path) -> Path:
    path = folder / "notes.txt"
    path.write_text("x = 1")
    return path
