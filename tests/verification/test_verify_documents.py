"""``holonomic verify`` of documents: table, JSON, annotation and exit code."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from folders import ROOT

from derive.verification.documents.pages.verdict_table import document_lines, document_record
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts, FormulaVerdict
from solvers.app.cli import main

PENDULUM = r"""
The energies are $T = \frac{1}{2} m l^2\dot\theta^2$ and

$$ V = -m g l\cos\theta , $$

so that

$$
\ddot\theta + \frac{g}{l}\cos\theta = 0
$$
"""


@pytest.fixture
def pendulum(tmp_path: Path) -> str:
    path = tmp_path / "pendulum.md"
    path.write_text(PENDULUM)
    return str(path)


def test_the_table_abbreviates_only_correct_formulas() -> None:
    long = " + ".join(["a"] * 40)
    formulas = (
        FormulaVerdict(3, 1, 1, f"x &= {long}", "verified"),
        FormulaVerdict(12, 1, 0, f"y = {long}", "wrong", "a", "y = b", "1 instead of 2", "so"),
    )
    judged = DocumentVerdicts("a.md", "markdown", "a system", formulas, ("a note",))
    lines = list(document_lines(judged, 60))
    assert lines[:2] == ["a.md: a system", "a note"]
    assert lines[2].startswith("line 3   verified     x = a + a")
    assert lines[2].endswith(" ...")
    assert lines[3].startswith("line 12  wrong        y = a + a")
    assert " ".join(" ".join(lines[3:]).split()).count("a +") == 39
    assert [line.strip() for line in lines[-5:]] == [
        "wrong term: a", "correct formula: y = b", "value: 1 instead of 2", "note: so",
        "2 formulas: 1 verified, 1 wrong",
    ]  # fmt: skip


def test_a_hostile_formula_is_cut() -> None:
    formulas = (FormulaVerdict(1, 1, 1, "{" * 1_000_000, "unreadable"),)
    judged = DocumentVerdicts("a.md", "markdown", "", formulas)
    assert len("".join(document_lines(judged, 80))) < 3000


def test_formulas_of_notebooks_have_cells() -> None:
    formulas = (FormulaVerdict(3, 1, 1, "x = 1", "verified", cell=2),)
    judged = DocumentVerdicts("a.ipynb", "notebook", "", formulas)
    assert list(document_lines(judged, 60))[1].startswith("cell 2, line 3  verified")
    assert document_record(judged)["formulas"][0]["cell"] == 2


def test_the_table_of_a_document_without_formulas_is_not_empty(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, page = tmp_path / "empty.md", tmp_path / "page.html"
    path.write_text("A text.")
    assert main(["verify", str(path), "--annotate", str(page)]) == 3
    first, second, *_ = capsys.readouterr().out.splitlines()
    assert first == str(path)
    assert second.startswith("Nothing was judged. 0 formulas.")
    assert "It has no formulas." in page.read_text()


def test_json_has_the_formulas_of_each_document(
    pendulum: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["verify", pendulum, "--json"]) == 1
    (document,) = json.loads(capsys.readouterr().out)["documents"]
    assert document["file"] == pendulum
    assert document["system"].startswith("Single pendulum")
    first, second, third = document["formulas"]
    assert (first["line"], first["display"], first["verdict"]) == (2, 0, "verified")
    assert (second["line"], second["display"], second["verdict"]) == (4, 1, "verified")
    assert (third["line"], third["display"], third["verdict"]) == (9, 2, "wrong")
    assert third["latex"] == r"\ddot\theta + \frac{g}{l}\cos\theta = 0"
    assert "cos" in third["wrong_term"]
    assert "sin" in third["correction"]
    assert set(third) == {
        "line", "display", "latex", "verdict", "wrong_term", "correction", "witness", "state",
        "basis", "note",
    }  # fmt: skip


@pytest.mark.long("other tests reach its code")
def test_documents_stand_beside_derivations(
    pendulum: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "out" / "page.html"
    assert main(["verify", "single_pendulum", pendulum, "--annotate", str(page)]) == 1
    output = capsys.readouterr().out
    assert "energy            verified" in output
    assert "line 9  wrong" in output
    *_, document, total = output.splitlines()
    assert document.split()[1:] == ["2", "0", "0", "1", "0"]
    assert total.split()[1:] == ["5", "0", "0", "1", "0"]
    assert "<b>1</b> wrong" in page.read_text()
    assert main(["verify", "single_pendulum", pendulum, "--json"]) == 1
    result = json.loads(capsys.readouterr().out)
    assert [one["file"] for one in result["derivations"]] == ["single_pendulum"]
    assert [one["file"] for one in result["documents"]] == [pendulum]


def test_a_missing_document_is_refused_and_the_others_are_judged(
    pendulum: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["verify", str(tmp_path / "absent.tex"), pendulum]) == 1
    output, errors = capsys.readouterr()
    assert "absent.tex: No such file" in errors
    assert "line 9  wrong" in output


def test_a_document_without_formulas_is_counted_beside_others(
    pendulum: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "empty.md"
    path.write_text("A text.")
    assert main(["verify", pendulum, str(path)]) == 1
    output = capsys.readouterr().out
    assert "line 9  wrong" in output
    assert "0 formulas" in output
    *_, document, _total = output.splitlines()
    assert document.split()[1:] == ["0"] * 5


UNREADABLE = r"$$\int\theta$$"


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (PENDULUM, 1),
        (PENDULUM + UNREADABLE, 1),
        (PENDULUM.replace(r"{l}\cos", r"{l}\sin") + UNREADABLE, 2),
        (PENDULUM.replace(r"{l}\cos", r"{l}\sin"), 0),
    ],
)
def test_a_wrong_formula_decides_the_exit_code(text: str, code: int, tmp_path: Path) -> None:
    path = tmp_path / "a.md"
    path.write_text(text)
    assert main(["verify", str(path)]) == code


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["a.docx"], "a.docx is no document: documents end in .html, .htm, .md"),
        (["--annotate", "a.html"], "give a document"),
        (["--system", "single_pendulum"], "give a document"),
        (["double_pendulum", "--system", "single_pendulum"], "give a document"),
        (["a.md", "--annotate", "a.pdf"], "must end in .html or .tex"),
    ],
)
def test_files_of_unknown_kinds_are_refused(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["verify", *arguments]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.long("other tests reach its code")
def test_a_run_without_a_verdict_names_what_was_missing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "letters.md"
    path.write_text(r"$$a^2 + b^2 = c^2$$")
    assert main(["verify", str(path)]) == 3
    output = " ".join(capsys.readouterr().out.split())
    assert "Nothing was judged. 1 formula: 1 not judged because: no system was found" in output
    assert "--system and --names" in output
    assert main(["verify", str(path), "--system", "single_pendulum"]) == 3
    output = " ".join(capsys.readouterr().out.split())
    assert "no meaning of its letters was found" in output
    assert "in single_pendulum" in output


@pytest.mark.long("other tests reach its code")
def test_witnesses_do_not_depend_on_the_hash_seed(tmp_path: Path) -> None:
    text = r"$$T = \frac12 m\dot x^2, \qquad V = \frac12\alpha k x^2 + b g x^4$$"
    text += r"$$L = \frac12 m\dot x^2 - \frac12\alpha k x^2 - b g x^4$$"
    (tmp_path / "a.md").write_text(text + r"$$m\ddot x + \alpha k x + 3 b g x^3 = 0$$")
    code = f"from solvers.app.cli import main; main(['verify', {str(tmp_path / 'a.md')!r}])"
    outputs = [
        subprocess.run(
            [sys.executable, "-c", code],
            cwd=ROOT,
            env=os.environ | {"PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=False,
        ).stdout
        for seed in "123"
    ]
    assert "state: " in outputs[0]
    assert len({*outputs}) == 1
