"""Documents: every delimiter of formulas with its place, in each format."""

import json
import re
from pathlib import Path

import pytest
from shared_documents import shared

from derive.reading.document import Display
from derive.reading.documents import read_document

KINDS = {"$$": "$$", "```math": "fence", ".. math::": "rst-math"}


def compared(latex: str) -> str:
    """LaTeX without spaces and without Markdown's escapes."""
    return re.sub(r"\s+|\\(?=[_*])", "", latex)


def displays(path: Path) -> list[Display]:
    return [one for one in read_document(path).displays if not one.is_inline]


def test_displays_of_public_documents_are_those_of_their_verdicts() -> None:
    folder = shared("documents")
    for document in json.loads((folder / "verdicts.json").read_text()):
        expected = [(d["n"], d["kind"], compared(d["latex"])) for d in document["displays"]]
        found = displays(folder / document["file"])
        assert [(d.number, KINDS[d.delimiter], compared(d.latex)) for d in found] == expected


def test_the_report_has_equations_1_to_128_and_20_more_displays() -> None:
    (path,) = shared("report").glob("*.txt")
    found = displays(path)
    ends = [re.search(r"(?:\\quad |\\tag\{)\(?(\d+)[)}]$", one.latex) for one in found]
    assert [int(end[1]) for end in ends if end] == list(range(1, 129))
    assert len(found) == 148


@pytest.mark.parametrize(
    ("name", "text", "delimiter", "latex"),
    [
        ("a.tex", "so $$x = 1$$", "$$", "x = 1"),
        ("a.tex", "so\n\\[x = 1\\]", r"\[", "x = 1"),
        ("a.tex", "so $x = 1$", "$", "x = 1"),
        ("a.tex", "so \\(x = 1\\)", r"\(", "x = 1"),
    ],
)
def test_delimiters(tmp_path: Path, name: str, text: str, delimiter: str, latex: str) -> None:
    path = tmp_path / name
    path.write_text(text)
    (one,) = read_document(path).displays
    assert (one.delimiter, one.latex) == (delimiter, latex)
    assert text[one.start : one.start + len(latex)] == latex
