"""README: snippets run, links exist, tables and the picture are what the code gives now."""

import re
import sys
import tomllib
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from folders import ROOT
from PIL import Image
from snippets import run_snippet

import generated
import generated.double_pendulum as dp
from solvers import load_sweep, sweep
from solvers.app.cli import COMMANDS
from solvers.app.modules import load as load_module
from solvers.io.figures import png
from solvers.scenes.scene_reading import scene
from solvers.scenes.scene_run import run_scene
from solvers.sweeps.sweep_figure import figure

README = (ROOT / "README.md").read_text(encoding="utf-8")
SNIPPETS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
(SCENE,) = re.findall(r"```toml\n(.*?)```", README, re.DOTALL)


def test_it_is_short() -> None:
    assert 120 <= len(README.splitlines()) <= 150


@pytest.mark.parametrize("snippet", SNIPPETS, ids=range(len(SNIPPETS)))
def test_a_snippet_prints_its_comments(
    snippet: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    run_snippet(snippet, "README.md", {})


@pytest.mark.long("a map of a quarter of a million motions")
def test_the_picture_is_what_the_sweep_draws(tmp_path: Path) -> None:
    again = Image.open(BytesIO(png(figure(sweep(load_sweep("flips"), tmp_path)))))
    shown = Image.open(ROOT / re.findall(r"!\[.*?\]\((.*?)\)", README)[0])
    assert shown.size == again.size
    difference = np.abs(
        np.asarray(shown.convert("RGB"), int) - np.asarray(again.convert("RGB"), int)
    )
    assert difference.mean() < 1  # fonts may differ


def test_every_link_exists() -> None:
    links = re.findall(r"\]\((?!https?:)(.*?)\)", README)
    assert [link for link in links if not (ROOT / link).exists()] == []
    packages = {
        str(path.relative_to(ROOT))
        for package in ("derive", "solvers")
        for path in (ROOT / package).rglob("README.md")
    }
    assert packages <= {*links}


def test_every_command_exists_and_help_lists_them_all() -> None:
    assert set(re.findall(r"`holonomic (\w+)", README)) <= {*COMMANDS}


def test_the_scene_runs_to_its_accuracy() -> None:
    assert run_scene(scene("my_scene", tomllib.loads(SCENE), load_module)).is_met


def test_the_number_of_systems_and_operations_are_those_of_the_modules() -> None:
    ones = ("", *(f"-{digit}" for digit in "one two three four five six seven eight nine".split()))
    words = dict(enumerate((f"Twenty{digit}" for digit in ones), 20))
    assert f"{words[len(generated.__all__)]} systems ship" in README
    assert f"{dp.OPERATIONS['rhs'][0]} operations for the double pendulum" in README
