"""Loops compiled with less optimisation, as in most tests, move as those of users."""

import os
import shutil
from pathlib import Path

import cheap_compiler
import numpy as np
import pytest

import generated.double_pendulum as dp
import generated.elastic_pendulum as ep
from solvers import ensemble, integrate
from solvers.equations.module import GeneratedModule

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")


def libraries(cache: Path) -> set[bytes]:
    return {path.read_bytes() for path in cache.rglob("*.so")}


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize(("method", "module"), [("verner853", dp), ("gauss8", ep), ("radau5", dp)])
def test_levels_of_optimisation_agree_to_rounding(
    method: str, module: GeneratedModule, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    start = (1.2, 0.5, 0.3, 0.0)
    options = {"method": method, "rtol": 1e-9, "atol": 1e-9, "backend": "compiled"}

    def ends(cache: str) -> list[np.ndarray]:
        monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / cache))
        starts = np.stack([start, start], axis=-1)
        return [
            integrate(module, (0, 2), start, {}, **options).y[:, -1],
            ensemble(module, (0, 2), starts, {}, **options).y[..., -1].ravel(),
        ]

    less = ends("less")
    with cheap_compiler.compiling():
        more = ends("more")
    for one, other in zip(less, more, strict=True):
        assert np.abs(one - other).max() < 1e-11
    assert not libraries(tmp_path / "less") & libraries(tmp_path / "more")


def test_libraries_that_another_process_renames_meanwhile_are_no_obstacle(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A link without its file stands in the folder and has no time, as a name that is gone."""
    monkeypatch.setattr(cheap_compiler, "PLACE", tmp_path)
    monkeypatch.setenv("PATH", os.environ["PATH"])
    (tmp_path / "long" / "libraries").mkdir(parents=True)
    (tmp_path / "long" / "libraries" / "name.123").symlink_to(tmp_path / "gone")
    cheap_compiler.install(cheap_compiler.LONG)
    assert (tmp_path / "long" / "cc").is_file()
