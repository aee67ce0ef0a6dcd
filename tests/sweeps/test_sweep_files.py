"""Files in a sweep's folder that are not what they should be: repeated, refused or kept."""

import hashlib
import json
import os
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sweep_file import write_sweep

import generated.double_pendulum as dp
from solvers.app.modules import load as load_module
from solvers.io.toml_input import InputError
from solvers.sweeps.definition.axes import Grid
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.definition.sweep_reading import find
from solvers.sweeps.execution import worker
from solvers.sweeps.execution.folder import DIGITS, FORMAT, FolderError
from solvers.sweeps.execution.sweep_run import partial_results, sweep
from solvers.sweeps.maps.final import Final

ANGLES = np.linspace(-3, 3, 8)
DEFINITION = Sweep(dp, Grid({"theta1": ANGLES, "theta2": ANGLES}), {"end": Final(("theta1",))}, 0.1)


@pytest.fixture(autouse=True)
def some_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker, "COST", 1e-7)


def npy(array: np.ndarray) -> bytes:
    file = BytesIO()
    np.save(file, array)
    return file.getvalue()


def npz(array: np.ndarray) -> bytes:
    file = BytesIO()
    np.savez(file, array)
    return file.getvalue()


@pytest.mark.parametrize("change", [
    lambda chunk: npy(np.stack([chunk["status"] * 1.0, chunk["end"][:, 0]])),
    lambda chunk: npy(chunk["status"]),
    lambda chunk: npy(chunk.astype([("status", "i1"), ("end", ">f8", (1,))])),
    lambda chunk: npy(chunk.astype([("status", "i1"), ("end", "<f4", (1,))])),
    lambda chunk: npy(chunk[1:]),
    npz,
    lambda _: b"",
    lambda _: b"\x93NUMPY\x01\x00\x08\x00((((((((",
], ids=["shape", "field", "bytes", "type", "length", "archive", "empty", "header"])  # fmt: skip
def test_a_chunk_with_the_right_digest_of_wrong_content_is_repeated(
    change: Callable[[np.ndarray], bytes], tmp_path: Path
) -> None:
    expected = sweep(DEFINITION, tmp_path).maps["end"].tobytes()
    chunk = sorted((tmp_path / "chunks").glob("*.npy"))[2]
    content = change(np.load(chunk))
    name = f"{chunk.name.partition('-')[0]}-{hashlib.sha256(content).hexdigest()[:DIGITS]}.npy"
    chunk.unlink()
    (chunk.parent / name).write_bytes(content)
    partial = partial_results(DEFINITION, tmp_path)
    assert partial.count["not done yet"] == (partial.status == 0).sum() > 0
    assert sweep(DEFINITION, tmp_path).maps["end"].tobytes() == expected
    assert not (chunk.parent / name).exists()


def fifo(path: Path) -> None:
    os.mkfifo(path)


def endless(path: Path) -> None:
    path.symlink_to("/dev/zero")


def brackets(path: Path) -> None:
    path.write_text("[" * 200_000)


def without_a_digest(path: Path) -> None:
    keys = {"format": FORMAT, "chunk": 1, "motions": 1, "definition": {}, "arithmetic": {}}
    path.write_text(json.dumps(keys))


@pytest.mark.parametrize("plant", [fifo, endless, brackets, without_a_digest, Path.mkdir])
def test_a_manifest_that_is_no_file_or_too_deep_is_refused(
    plant: Callable[[Path], Any], tmp_path: Path
) -> None:
    plant(tmp_path / "sweep.json")
    for run in (sweep, partial_results):
        with pytest.raises(FolderError, match=r"sweep.json is no manifest of a sweep"):
            run(DEFINITION, tmp_path)


@pytest.mark.parametrize("depth", [10, 300, 900, 980])
def test_a_deep_value_in_a_manifest_is_quoted_in_part(depth: int, tmp_path: Path) -> None:
    sweep(DEFINITION, tmp_path)
    path = tmp_path / "sweep.json"
    deep = "[" * depth + "]" * depth
    path.write_text(path.read_text().replace('"duration": 0.1', f'"duration": {deep}'))
    with pytest.raises(FolderError, match=r"duration \[|is no manifest") as error:
        sweep(DEFINITION, tmp_path)
    assert len(str(error.value)) < 400


@pytest.mark.parametrize("plant", [fifo, endless, Path.mkdir])
@pytest.mark.parametrize("name", ["lock", f"0-{'0' * DIGITS}.npy"])
def test_what_is_no_file_among_the_chunks_does_no_harm(
    name: str, plant: Callable[[Path], Any], tmp_path: Path
) -> None:
    sweep(DEFINITION, tmp_path)
    path = tmp_path / "chunks" / name
    path.unlink(missing_ok=True)
    plant(path)
    if name == "lock" and plant is Path.mkdir:
        with pytest.raises(OSError, match="lock"):
            sweep(DEFINITION, tmp_path)
    else:
        assert sweep(DEFINITION, tmp_path).count == {"finished": 64}


def test_chunks_without_a_manifest_are_refused(tmp_path: Path) -> None:
    sweep(DEFINITION, tmp_path)
    for path in (*tmp_path.glob("*.npy"), tmp_path / "sweep.json"):
        path.unlink()
    # they have the length and type of this sweep's, which has another duration
    other = Sweep(dp, DEFINITION.axes, DEFINITION.maps, 0.11)
    with pytest.raises(FolderError, match=r"holds chunks/.*npy and no sweep: give another"):
        sweep(other, tmp_path)


@pytest.mark.parametrize("plant", [fifo, endless, Path.mkdir])
def test_a_table_that_is_no_file_is_refused(plant: Callable[[Path], Any], tmp_path: Path) -> None:
    plant(tmp_path / "starts.csv")
    text = 'system = "double_pendulum"\nduration = 1\naxes = "starts.csv"\n'
    path = write_sweep(tmp_path, f'{text}[maps.end]\nkind = "final"\nof = ["theta1"]\n')
    with pytest.raises(InputError, match=r"axes = 'starts.csv' is no file"):
        find(str(path), load_module)


def test_the_temporary_file_of_a_live_process_is_kept(tmp_path: Path) -> None:
    sweep(DEFINITION, tmp_path)
    # as `holonomic sweep --draw` leaves its picture for a moment
    picture = tmp_path / f".flips.png.{os.getppid()}"
    picture.write_bytes(b"half a picture")
    sweep(DEFINITION, tmp_path)
    assert picture.read_bytes() == b"half a picture"
