"""One file adds a model: to selection, scene files, error messages and documentation."""

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import generated.rotating_hoop as hoop
import generated.single_pendulum as sp
from solvers.app.modules import load as load_module
from solvers.integration.accuracy.checked_motion import OutsideDomainError
from solvers.scenes import models
from solvers.scenes.models import model_catalogue
from solvers.scenes.scene import Scene
from solvers.scenes.scene_reading import find
from solvers.scenes.scene_run import run_scene

MODEL = '''
"""The first terms of a Taylor polynomial in time."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from solvers.scenes.models.model_catalogue import ClosedForm
from solvers.integration.accuracy.checked_motion import OutsideDomainError


@dataclass(frozen=True)
class Polynomial(ClosedForm):
    """q + t q' + t²/2 q''."""

    name: ClassVar[str] = "polynomial"
    complexity: ClassVar[int] = 15
    applies_to: ClassVar[str] = "motions of less than 10 ms"
    error_source: ClassVar[str] = "the next term"

    y0: tuple
    rates: np.ndarray

    @classmethod
    def not_applicable(cls, module):
        on_hoop = "R" in module.PARAMETERS
        return super().not_applicable(module) or ("it is a hoop" if on_hoop else "")

    @classmethod
    def of(cls, motion):
        if motion.duration > 0.01:
            raise OutsideDomainError("the motion is long")
        rates = np.array(motion.module.rhs(0.0, motion.y0, motion.params))
        error = 10 * motion.duration**2
        return cls(motion.y0, rates, error_estimate=error, why="the motion is short")

    def states(self, t):
        n = len(self.y0) // 2
        states = self.y0 + np.multiply.outer(t, self.rates)
        states[:, :n] += np.multiply.outer(t**2 / 2, self.rates[n:])
        return states
'''

SHORT = Scene(sp, sp.DEFAULTS, (1.0, 0.0), 0.005, accuracy=1e-3)


@pytest.fixture
def extended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The models with one file more."""
    (tmp_path / "polynomial.py").write_text(MODEL)
    monkeypatch.setattr(models, "__path__", [*models.__path__, str(tmp_path)])
    yield
    sys.modules.pop("solvers.scenes.models.polynomial", None)


@pytest.mark.usefixtures("extended")
def test_it_is_selected_by_its_error_before_more_complex_models() -> None:
    result = run_scene(SHORT)
    assert result.selection.model.name == "polynomial"
    assert [*result.selection.declined] == ["rest"]
    exact = run_scene(replace(SHORT, model="pendulum"))
    assert 0 < np.abs(result.y - exact.y).max() < result.selection.model.error_estimate
    other = run_scene(replace(SHORT, accuracy=1e-6)).selection
    assert (other.model.name, other.declined["polynomial"]) == (
        "pendulum",
        "its error may reach 0.0003",
    )
    declined = run_scene(replace(SHORT, duration=0.02, accuracy=1e-6)).selection.declined
    assert declined["polynomial"] == "the motion is long"


@pytest.mark.usefixtures("extended")
def test_scene_files_name_it_and_messages_list_it(tmp_path: Path) -> None:
    text = 'system = "single_pendulum"\nduration = "5 ms"\ninitial = { theta = 1 }\nmodel = '
    path = tmp_path / "scene.toml"
    path.write_text(text + '"polynomial"\n')
    result = run_scene(find(str(path), load_module))
    assert (result.selection.model.name, result.is_met) == ("polynomial", False)
    path.write_text(text + '"polynom"\n')
    with pytest.raises(ValueError, match="'rest' or 'polynomial' or 'normal modes' or"):
        find(str(path), load_module)
    on_hoop = Scene(hoop, hoop.DEFAULTS, (1.0, 0.0), 0.005, model="polynomial")
    with pytest.raises(OutsideDomainError, match="it is a hoop"):
        run_scene(on_hoop)


def test_the_table_of_models_lists_it(extended: None) -> None:
    rows = model_catalogue.markdown_table().splitlines()
    assert rows[3] == '| `"polynomial"` | motions of less than 10 ms | the next term |'
    assert len(rows) == 2 + len(model_catalogue.load())


def test_it_is_gone_without_its_file() -> None:
    assert "polynomial" not in model_catalogue.load()
    with pytest.raises(ValueError, match="must be 'rest' or 'normal modes' or"):
        replace(SHORT, model="polynomial")
