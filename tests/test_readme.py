"""README's snippets run, and its numbers are those of the code."""

import re
import sys
import tomllib
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from derive import load, names
from derive.codegen.functions import contents
from solvers.app.cli import main
from solvers.app.modules import load as load_module
from solvers.io.figures import png
from solvers.scenes.models.catalogue import load as load_models
from solvers.scenes.reading import KEYS, scene
from solvers.scenes.run import run_scene
from solvers.scenes.shipped import find
from solvers.sweeps import map_kinds
from solvers.sweeps.job import STATUSES
from solvers.sweeps.plots.figure import figure
from solvers.sweeps.reading import find as find_sweep
from solvers.sweeps.reading import names as sweeps
from solvers.sweeps.run import sweep

README_FOLDER = Path(__file__).parent.parent
README = (README_FOLDER / "README.md").read_text(encoding="utf-8")
SNIPPETS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
TABLES = re.findall(r"```toml\n(.*?)```", README, re.DOTALL)


def table(name: str) -> str:
    """The file of this name, which its first line says."""
    (found,) = [text for text in TABLES if text.startswith(f"# {name}\n")]
    return str(found)


@pytest.mark.parametrize("snippet", SNIPPETS, ids=range(len(SNIPPETS)))
def test_snippets_run(snippet: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    exec(compile(snippet, "README.md", "exec"), {})


def test_the_picture_is_what_the_sweep_draws(tmp_path: Path) -> None:
    asked = find_sweep("flips", load_module)
    again = Image.open(BytesIO(png(figure(sweep(asked, tmp_path)))))
    shown = Image.open(README_FOLDER / re.findall(r"!\[.*?\]\((.*?)\)", README)[0])
    assert shown.size == again.size
    apart = np.abs(np.asarray(shown.convert("RGB"), int) - np.asarray(again.convert("RGB"), int))
    assert apart.mean() < 1  # fonts may differ


def test_every_link_leads_somewhere() -> None:
    heads = re.findall(
        r"^#+ (.*)$", re.sub(r"```.*?```", "", README, flags=re.DOTALL), re.MULTILINE
    )
    anchors = {re.sub(r"[^\w -]", "", head).lower().replace(" ", "-") for head in heads}
    for link in re.findall(r"\]\((?!https?:)(.*?)\)", README):
        assert link[1:] in anchors if link.startswith("#") else (README_FOLDER / link).exists(), (
            link
        )


def test_every_notebook_is_listed() -> None:
    listed = re.findall(r"^\| `(\d\d_\w+)` \|", README, re.MULTILINE)
    assert listed == sorted(path.stem for path in (README_FOLDER / "notebooks").glob("*.ipynb"))


def test_the_table_of_operations_is_true(double) -> None:  # type: ignore[no-untyped-def]
    counted = {f.name: f.lowering.cost[0] for f in contents(double).functions}
    table = README.partition("operations a call |")[2].partition("\n\n")[0]
    for row in re.findall(r"^\| (`[^|]*) \| ([^|]*) \|$", table, re.MULTILINE):
        called = re.findall(r"`(\w+)", row[0])
        stated = [int(number) for number in re.findall(r"\d+", row[1])]
        if "to" in row[1]:
            actual = [counted[name] for name in called]
            assert [min(actual), max(actual)] == stated
        else:
            assert [counted[name] for name in called] == stated


def test_every_command_that_is_shown_exists() -> None:
    from solvers.app.cli import COMMANDS

    assert set(re.findall(r"holonomic (\w+)", README)) <= {*COMMANDS}
    assert "double_pendulum" in names()


def test_the_scene_that_is_shown_is_answered_with_what_is_beside_it() -> None:
    whole = "".join(TABLES[:2])
    found = scene("my_scene", tomllib.loads(whole), load_module)
    assert run_scene(found).is_met
    euler, moved = found.beside
    assert not run_scene(euler).is_met
    assert (euler.label, moved.label) == ("rk1, step = 10 ms", "1e-3 rad further")
    assert moved.y0[0] - found.y0[0] == pytest.approx(1e-3)


def test_scenes_that_are_named_take_the_model_that_is_said() -> None:
    table = README.partition("| model | when | its error | scenes |")[2].partition("\n\n")[0]
    for row in table.splitlines()[2:]:
        model, *_, named = row.strip("| ").split(" | ")
        for name in re.findall(r"`(\w+)`", named):
            assert run_scene(find(name, load_module)).selection.model.name == model, name


def test_systems_have_the_coordinates_that_are_said() -> None:
    table = README.partition("| system | coordinates |")[2].partition("\n\n")[0]
    listed = set()
    for row in table.splitlines()[2:]:
        systems, coordinates = row.strip("| ").split(" | ")
        for name in {*re.findall(r"`(\w+)`", systems)} & {*names()}:
            listed.add(name)
            found = [c.symbol.name for c in load(name).coordinates]
            assert re.findall(r"`(\w+)`", coordinates) == found
    assert listed == {*names()}


def test_the_system_that_is_shown_is_derived_and_runs(tmp_path: Path) -> None:
    (tmp_path / "bead.toml").write_text(table("bead.toml"))
    text = 'system = "bead.toml"\nduration = 3\ninitial = { x = "10 cm" }\n'
    (tmp_path / "scene.toml").write_text(text)
    found = run_scene(find(str(tmp_path / "scene.toml"), load_module))
    assert found.is_met
    assert hasattr(found.scene.module, "power")


def test_the_hand_derivation_in_the_readme_has_the_verdicts_that_it_shows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    (tmp_path / "page.toml").write_text(table("page.toml"))
    assert main(["verify", str(tmp_path / "page.toml")]) == 1
    printed = capsys.readouterr().out.splitlines()
    shown = README.partition("$ holonomic verify page.toml\n")[2].partition("```")[0]
    assert shown.splitlines() == printed


def test_keys_and_models_that_are_listed_are_all_that_there_are() -> None:
    keys = README.partition("| key | meaning, and what is assumed |")[2].partition("\n\n")[0]
    named = {key for row in keys.splitlines()[2:] for key in re.findall(r"\w+", row.split("|")[1])}
    shown = {"system", "duration", "accuracy", "parameters", "initial", "label"}
    assert named | shown == {*KEYS}
    assert all(f'"{model}"' in keys for model in load_models())


def test_the_sweep_that_is_shown_runs_and_every_kind_is_listed(tmp_path: Path) -> None:
    (tmp_path / "my_sweep.toml").write_text(table("my_sweep.toml"))
    asked = find_sweep(str(tmp_path / "my_sweep.toml"), load_module)
    found = sweep(asked, tmp_path / "out")
    assert found.maps["highest"].shape == (50, 40, 1, 2)
    assert found.count == {"finished": 2000}
    listed = README.split("what is kept of a motion")[1].split("\n\n")[0]
    assert tuple(sorted(re.findall(r"\n\| `([a-z ]+)`", listed))) == map_kinds.names()
    codes = README.split("says how each motion ended: ")[1].split(". In the end")[0]
    said = {int(n) for n in re.findall(r"\b(\d+) ", codes.replace("\n", " "))}
    assert said < {*range(len(STATUSES))}
    assert [STATUSES[n] for n in (1, 2, 3, 9, 10)] == [
        "finished", "event", "step limit", "proved", "no such energy",
    ]  # fmt: skip
    shipped = README.split("sweeps ship:")[1].split("In Python")[0]
    assert set(re.findall(r"`(\w+)`", shipped)) == {*sweeps()}
