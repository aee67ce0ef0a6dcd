"""READMEs of packages: their snippets run, their links exist, and their tables match the code."""

import re
import shutil
import sys
from collections.abc import Callable, Iterator
from dataclasses import fields
from pathlib import Path
from typing import get_args

import pytest
from folders import ROOT
from snippets import assert_is_printed, run_snippet

import generated.double_pendulum as dp
from derive.codegen.module_files import GeneratedFiles
from derive.verification.documents.pages.verdict_table import document_record
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts, FormulaVerdict
from derive.verification.hand_derivation_files import EQUATIONS, HEADER
from derive.verification.judging.verdict import Verdict, VerdictName
from solvers.app.cli import main
from solvers.app.modules import load as load_module
from solvers.app.readme_tables import TABLES
from solvers.scenes import scene_reading as scenes
from solvers.scenes.models import model_catalogue
from solvers.scenes.scene_reading import find as find_scene
from solvers.scenes.scene_run import run_scene
from solvers.sweeps.definition import sweep_reading
from solvers.sweeps.execution.sweep_run import sweep

READMES = [p for package in ("derive", "solvers") for p in sorted((ROOT / package).rglob("*.md"))]
HOWTO = ROOT / "notebooks" / "docs" / "howto.md"

#: Links to READMEs that are to be written.
UNWRITTEN = {"runge_kutta/README.md"}


def blocks(path: Path, language: str) -> list[str]:
    """Code blocks of a README in a language."""
    text = path.read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


def snippets() -> Iterator[object]:
    for path in (*READMES, HOWTO):
        for k, text in enumerate(blocks(path, "python")):
            yield pytest.param(path, text, id=f"{path.parent.relative_to(ROOT)}-{k}")


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize(("path", "snippet"), [*snippets()])
def test_a_snippet_prints_its_comments(
    path: Path, snippet: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    for file in blocks(path, "toml"):
        if name := re.match(r"# (\w+\.toml)\n", file):
            (tmp_path / name[1]).write_text(file)
    run_snippet(snippet, str(path), {"__name__": "__main__"})


def test_a_comment_that_is_not_printed_is_an_error(tmp_path: Path) -> None:
    assert_is_printed("FINISHED, 2.228 -0.27 nan", "FINISHED [ 2.22806 -0.267045     nan]\n")
    for comment in ("2.229", "2.22806 rad", "-2.228", "2", "nan"):
        with pytest.raises(AssertionError, match="instead of"):
            assert_is_printed(comment, "2.22806\n")
    with pytest.raises(AssertionError, match="'2\\\\n' instead of '3'"):
        run_snippet("x = 1\nprint(\n    x + 1,\n)  # 3\n", "snippet", {})


@pytest.mark.parametrize("path", READMES, ids=lambda path: str(path.parent.relative_to(ROOT)))
def test_every_link_exists(path: Path) -> None:
    text = re.sub(r"```.*?```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
    links = {*re.findall(r"\]\((?!https?:|#)([^)#]*)", text)} - UNWRITTEN
    assert [link for link in links if not (path.parent / link).exists()] == []


DERIVE = ROOT / "derive" / "README.md"
VERIFICATION = ROOT / "derive" / "verification" / "README.md"
SCENES = ROOT / "solvers" / "scenes" / "README.md"
SWEEPS = ROOT / "solvers" / "sweeps" / "README.md"


@pytest.mark.parametrize(("name", "title", "table"), TABLES)
def test_a_generated_table_is_current(name: str, title: str, table: Callable[[], str]) -> None:
    between = rf"<!-- {title} -->\n(.*)<!-- end of {title} -->"
    (written,) = re.findall(between, (ROOT / name).read_text(encoding="utf-8"), re.DOTALL)
    assert written == table()


def test_every_marked_table_is_generated() -> None:
    titles = {
        (str(path.relative_to(ROOT)), title)
        for path in READMES
        for title in re.findall(r"<!-- end of (.*) -->", path.read_text(encoding="utf-8"))
    }
    assert titles == {(name, title) for name, title, _ in TABLES}


@pytest.fixture
def copied_readmes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a checkout that has READMEs, and no generated modules."""
    for path in READMES:
        (tmp_path / path.relative_to(ROOT)).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, tmp_path / path.relative_to(ROOT))
    generated = GeneratedFiles(tmp_path, {}, complete=False)
    monkeypatch.setattr("derive.commands.regenerate.planned", lambda *_: generated)
    monkeypatch.setattr("solvers.app.readme_tables.ROOT", tmp_path)
    return tmp_path


def test_the_command_checks_and_mends_a_table(
    copied_readmes: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = copied_readmes / "derive" / "README.md"
    page.write_text(page.read_text(encoding="utf-8").replace("| `foucault_", "| `faucault_"))
    assert main(["derive", "--check"]) == 1
    assert f"{page}: differs" in (output := capsys.readouterr().out)
    assert "+| `foucault_pendulum`" in output
    assert "to update it: holonomic derive\n" in output
    assert main(["derive"]) == 0
    assert page.read_text(encoding="utf-8") == DERIVE.read_text(encoding="utf-8")
    assert main(["derive", "--check"]) == 0


@pytest.mark.parametrize("marker", ["<!-- methods -->\n", "<!-- end of methods -->"])
def test_the_command_refuses_a_page_without_a_marker(
    copied_readmes: Path, marker: str, capsys: pytest.CaptureFixture[str]
) -> None:
    page = copied_readmes / "solvers" / "runge_kutta" / "README.md"
    changed = page.read_text(encoding="utf-8").replace(marker, "")
    page.write_text(changed, encoding="utf-8")
    assert main(["derive"]) == 2
    message = capsys.readouterr().err
    assert f"{page} has no table of methods" in message
    assert marker.strip() in message
    assert page.read_text(encoding="utf-8") == changed


def test_the_operations_of_the_readme_are_those_of_the_module() -> None:
    table = DERIVE.read_text(encoding="utf-8").partition("| operations |\n|---|---|---|\n")[2]
    rows = re.findall(r"^\| `(\w+)` \|.*\| (\d+) \|$", table.partition("\n\n")[0], re.MULTILINE)
    assert len(rows) == 10
    assert {name: int(count) for name, count in rows}.items() <= {
        name: operations for name, (operations, _) in dp.OPERATIONS.items()
    }.items()


def test_the_system_file_of_the_readme_runs(tmp_path: Path) -> None:
    file = blocks(DERIVE, "toml")[0]
    (tmp_path / "bead.toml").write_text(file)
    module = load_module(str(tmp_path / "bead.toml"))
    assert module.TIMED
    assert "power" in module.OPERATIONS


def first_column(path: Path, head: str) -> list[str]:
    """Names in code style in the first column of a table."""
    table = path.read_text(encoding="utf-8").partition(f"| {head} | ")[2].partition("\n\n")[0]
    return re.findall(r"`(\w+)`", " ".join(row.split("|")[1] for row in table.split("\n")[2:]))


@pytest.mark.parametrize(
    ("name", "language", "number"),
    [("page.toml", "toml", 0), ("pendulum.md", "markdown", 1), ("pendulum.js", "js", 2)],
)
def test_derivations_of_the_readme_have_the_verdicts_shown(
    name: str,
    language: str,
    number: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / name).write_text(blocks(VERIFICATION, language)[0])
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    assert main(["verify", name]) == (0 if name == "pendulum.js" else 1)
    expected = f"$ holonomic verify {name}\n{capsys.readouterr().out}"
    assert blocks(VERIFICATION, "text")[number] == expected


def test_the_letters_of_the_readme_are_those_of_a_document(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (letters,) = (text for text in blocks(VERIFICATION, "toml") if "# letters.toml" in text)
    Path("letters.toml").write_text(letters)
    Path("my_page.md").write_text(r"$$\ddot\alpha = -\frac gw\cos\alpha$$")
    assert main(["verify", "my_page.md", "--names", "letters.toml"]) == 0
    assert " verified " in capsys.readouterr().out


def test_the_keys_fields_and_verdicts_of_the_readme_are_those_of_the_code() -> None:
    assert sorted(first_column(VERIFICATION, "key")) == sorted((*HEADER, *EQUATIONS))
    assert first_column(VERIFICATION, "field") == [field.name for field in fields(Verdict)]
    document = DocumentVerdicts("", "latex", "", (FormulaVerdict(1, 1, 1, "", "wrong"),))
    (formula,) = document_record(document)["formulas"]
    assert first_column(VERIFICATION, "of a formula") == list(formula)
    assert first_column(VERIFICATION, "verdict") == [*get_args(VerdictName)]


def listed_keys(path: Path) -> list[str]:
    """Keys in the first column of the table of keys."""
    table = path.read_text(encoding="utf-8").partition("| key | meaning | default |")[2]
    rows = table.partition("\n\n")[0].split("\n")[2:]
    return re.findall(r"`\[*([a-z_]+)", " ".join(row.split("|")[1] for row in rows))


def test_the_keys_and_models_of_scenes_in_the_readme_are_those_of_the_code() -> None:
    assert sorted(listed_keys(SCENES)) == sorted(scenes.KEYS)
    text = SCENES.read_text(encoding="utf-8").partition("| scene | model |\n|---|---|\n")[2]
    rows = re.findall(r"^\| (.*) \| (.*) \|$", text.partition("\n\n")[0], re.MULTILINE)
    assert {model for _, model in rows} == {m.name for m in model_catalogue.load().values()}
    for names, model in rows:
        for name in re.findall(r"`(\w+)`", names):
            assert run_scene(find_scene(name, load_module)).selection.model.name == model, name


def test_the_scene_file_of_the_readme_runs(tmp_path: Path) -> None:
    (file,) = blocks(SCENES, "toml")
    (tmp_path / "my_scene.toml").write_text(file)
    scene = find_scene(str(tmp_path / "my_scene.toml"), load_module)
    assert run_scene(scene).is_met
    euler, moved = scene.beside
    assert not run_scene(euler).is_met
    assert (euler.label, moved.label) == ("rk1, step = 10 ms", "1e-3 rad further")
    assert moved.y0[0] - scene.y0[0] == pytest.approx(1e-3)


def test_the_keys_and_sweeps_of_the_readme_are_those_of_the_code() -> None:
    text = SWEEPS.read_text(encoding="utf-8")
    assert sorted(listed_keys(SWEEPS)) == sorted(sweep_reading.KEYS)
    shipped = text.partition("sweeps ship: ")[2].partition(". Their")[0]
    assert {*re.findall(r"`(\w+)`", shipped)} == {*sweep_reading.names()}


def test_the_sweep_file_of_the_readme_runs(tmp_path: Path) -> None:
    file, *shipped = blocks(SWEEPS, "toml")
    texts = {path.read_text(encoding="utf-8") for path in sweep_reading.FILES.iterdir()}
    assert texts.issuperset(shipped)
    (tmp_path / "my_sweep.toml").write_text(file)
    definition = sweep_reading.find(str(tmp_path / "my_sweep.toml"), load_module)
    results = sweep(definition, tmp_path / "out")
    assert results.maps["highest"].shape == (50, 40, 1, 2)
    assert results.count == {"finished": 2000}
