"""One file adds a map kind: to sweep files, runs, summaries, figures and documentation."""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solvers.app.cli import main
from solvers.app.modules import load as load_module
from solvers.io.toml_input import InputError
from solvers.sweeps import maps
from solvers.sweeps.definition import map_kinds
from solvers.sweeps.definition.map_table import MapTable
from solvers.sweeps.definition.sweep_reading import find
from solvers.sweeps.execution.sweep_run import sweep

KIND = '''
"""Mean speeds."""

from dataclasses import dataclass

import numpy as np

from solvers.sweeps.maps import CountedMap


@dataclass(frozen=True)
class MeanSpeed(CountedMap):
    """Displacement of components divided by the duration, times `factor`.

    Parameters
    ----------
    factor : float
        A factor.
    """

    factor: float = 1.0

    example = 'of = ["theta1"], count = 2, factor = 3'
    quantity = "mean speed"
    colour_map = "cividis"

    @classmethod
    def read(cls, table):
        return cls(table.components("of"), table.count("count"), table.number("factor", "1", 1.0))

    def unit(self, module, component=""):
        return "rad/s"

    @property
    def sample_count(self):
        return 2

    def values(self, motions):
        samples = np.swapaxes(motions.ensemble.samples[motions.indices(self.of)], 0, 1)
        speed = (samples[..., -1] - samples[..., 0]) / motions.ensemble.t[:, None]
        return np.repeat(self.factor * speed[..., None], self.count, axis=-1)
'''

FILE = """
system = "double_pendulum"
duration = 2
[axes]
theta1 = { from = -1, to = 1, count = 5 }
theta2 = { from = -1, to = 1, count = 4 }
[maps.speed]
kind = "mean speed"
of = ["theta2", "theta1"]
count = 1
factor = 2
[maps.end]
kind = "final"
of = ["theta1"]
"""


@pytest.fixture
def kind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A kind in a file outside the package."""
    folder = tmp_path / "kinds"
    folder.mkdir()
    (folder / "mean_speed.py").write_text(KIND)
    monkeypatch.setattr(maps, "__path__", [*maps.__path__, str(folder)])
    yield "mean speed"
    sys.modules.pop("solvers.sweeps.maps.mean_speed", None)


def test_a_file_is_a_kind(kind: str) -> None:
    assert kind in map_kinds.names()
    (row,) = [line for line in map_kinds.markdown_table().splitlines() if f"`{kind}`" in line]
    assert row == (
        "| `mean speed` | Displacement of components divided by the duration, times `factor`. "
        '| `of = ["theta1"], count = 2, factor = 3` | component, number |'
    )


def test_its_sweep_is_read_run_and_opened(kind: str, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(FILE)
    results = sweep(find(str(tmp_path / "mine.toml"), load_module), tmp_path / "out")
    assert results.maps["speed"].shape == (5, 4, 2, 1)
    start, end = np.linspace(-1, 1, 5)[:, None], results.maps["end"][..., 0]
    assert_allclose(results.maps["speed"][..., 1, 0], 2 * (end - start) / 2, rtol=1e-12)


def test_its_sweep_is_summarised_and_drawn(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.toml").write_text(FILE)
    assert main(["sweep", str(tmp_path / "mine.toml"), "--output", str(tmp_path / "out")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("speed, theta2: ") and " rad/s, median" in line for line in lines)
    repeated = re.compile(r"speed: of \d+ motions repeated with rtol = 5e-10, .* rad/s, 90 % ")
    assert any(map(repeated.match, lines))
    assert (tmp_path / "out" / "mine.png").read_bytes().startswith(b"\x89PNG")


def test_its_keys_are_checked_and_an_unknown_kind_lists_it(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    for change, words in (
        (
            ('"mean speed"', '"mean sped"'),
            "did you mean 'mean speed'.*'lyapunov spectrum', 'mean speed'",
        ),
        (("factor = 2", "fator = 2"), "no key 'fator' .did you mean 'factor'"),
        (("factor = 2", 'factor = "2 kg"'), "maps.speed.factor: '2 kg' has another unit"),
    ):
        path.write_text(FILE.replace(*change))
        with pytest.raises(InputError, match=words):
            find(str(path), load_module)


DRIVEN = """
system = "duffing"
initial = { x = 0.0 }
axes.Omega = { from = 1, to = 2, count = 3 }
"""


@pytest.mark.parametrize("name", map_kinds.names())
def test_the_example_of_a_kind_is_valid(name: str, tmp_path: Path) -> None:
    example = map_kinds.load(name).example
    comma = ", " if example else ""
    is_driven = "every" in example
    head = DRIVEN if is_driven else FILE.partition("[maps.speed]")[0]
    path = tmp_path / "mine.toml"
    path.write_text(f'{head}[maps]\nexample = {{ kind = "{name}"{comma}{example} }}\n')
    definition = find(str(path), load_module)
    assert type(definition.maps["example"]) is map_kinds.load(name)


def test_a_kind_without_keys_takes_none() -> None:
    kind = map_kinds.load("energy error")
    assert kind.read(MapTable("maps.a", load_module("double_pendulum"), {})) == kind()
