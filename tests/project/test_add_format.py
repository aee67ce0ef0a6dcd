"""One file adds a format of documents, and one a language of programs."""

from pathlib import Path

import pytest

from derive.reading import formats
from derive.reading.document_formats import kinds, read_document
from derive.reading.programs import languages
from derive.reading.programs.program_reader import known_languages, read_program

ORG = '''
"""Org mode: LaTeX between brackets with a backslash."""

import re

from derive.reading.scanning import Excerpt

KIND, SUFFIXES = "org", (".org",)


def excerpts(text):
    for one in re.finditer(r"\\\\\\[(.*?)\\\\\\]", text, re.S):
        yield Excerpt(one.start(1), one.end(1), one.span(), "\\\\[", False)


def decoded(text, excerpt):
    return text[excerpt.start : excerpt.end]


def prose(text):
    return f"<pre>{text}</pre>"
'''

PYTHON_WITH_TABS = '''
"""Files of another suffix."""

from dataclasses import replace

from derive.reading.programs.languages import python

sage = replace(python.language, name="Sage", suffixes=(".sage",), other_names=())
'''


def test_one_file_adds_a_format(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "formats"
    folder.mkdir()
    (folder / "org.py").write_text(ORG)
    monkeypatch.setattr(formats, "__path__", [*formats.__path__, str(folder)])
    assert kinds()[".org"] == "org"
    file = tmp_path / "swing.org"
    file.write_text("* A pendulum\n\\[ L = \\frac{m l^2 \\dot\\theta^2}{2} \\]\nand more.\n")
    (display,) = read_document(file).displays
    assert display.latex == "L = \\frac{m l^2 \\dot\\theta^2}{2}"
    assert display.line == 2


def test_one_file_adds_a_language(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "languages"
    folder.mkdir()
    (folder / "sage.py").write_text(PYTHON_WITH_TABS)
    monkeypatch.setattr(languages, "__path__", [*languages.__path__, str(folder)])
    assert "Sage" in [one.name for one in known_languages()]
    program = tmp_path / "swing.sage"
    program.write_text(
        "from math import sin\ndef f(y, t):\n    theta, omega = y\n"
        "    return [omega, -9.81*sin(theta)]\n"
    )
    plain = program.with_suffix(".py")
    plain.write_text(program.read_text())
    assert read_program(program).equations == read_program(plain).equations != ()
