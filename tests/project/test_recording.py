"""Recorded outputs: differences are seen, but for the last digit of a decimal."""

import re
from pathlib import Path

import pytest
from folders import ROOT
from recording import RECORDS, Record

TEXT = "period 2.0064 s, energy -1.50e-03 J\n3 motions"


@pytest.fixture
def kept(tmp_path: Path) -> Record:
    Record(tmp_path / "kept.txt", is_written=True).check(TEXT)
    return Record(tmp_path / "kept.txt", is_written=False)


@pytest.mark.parametrize("same", [TEXT, TEXT.replace("64", "65"), TEXT.replace("1.50", "1.49")])
def test_decimals_may_differ_by_one_in_their_last_digit(same: str, kept: Record) -> None:
    kept.check(same)


@pytest.mark.parametrize("other", [
    TEXT.replace("64", "66"), TEXT.replace("-03", "-04"), TEXT.replace("3 m", "4 m"),
    TEXT.replace("-1.50", "1.50"), TEXT.replace("J", "W"), f"{TEXT}\nmore", TEXT[:30],
])  # fmt: skip
def test_other_differences_are_shown_with_the_command(other: str, kept: Record) -> None:
    with pytest.raises(AssertionError, match="make records") as error:
        kept.check(other)
    assert "\n@@ " in str(error.value)


@pytest.mark.parametrize(("texts", "shown"), [
    ({"a": "x\n\ny\n\nz"}, "make records"),
    ({"a": "x\n\ny", "b": "z"}, "make records"),
    ({"a": "x\n\nw\n\nz", "b": "z"}, "a\n\n1 recorded paragraphs are now 1:\n\nw\n\nif"),
    ({"a": "x\n\nz", "b": "z"}, "1 recorded paragraphs are now 0:"),
])  # fmt: skip
def test_changed_paragraphs_are_shown(texts: dict[str, str], shown: str, tmp_path: Path) -> None:
    path = tmp_path / "kept.txt"
    recorded = {"a": "x\n\ny\n\nz", "b": "z"}
    Record(path, is_written=True).check_digests(recorded)
    Record(path, is_written=False).check_digests(recorded)
    with pytest.raises(AssertionError, match=re.escape(shown)):
        Record(path, is_written=False).check_digests(texts)


def test_every_record_is_that_of_a_test() -> None:
    text = "".join(one.read_text(encoding="utf-8") for one in ROOT.glob("tests/*/test_*.py"))
    tests = tuple(re.findall(r"def test_(\w+)_(?:is|are)_as_recorded", text))
    assert [path.name for path in RECORDS.iterdir() if not path.stem.startswith(tests)] == []
