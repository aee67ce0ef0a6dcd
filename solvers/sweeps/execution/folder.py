"""The folder of a sweep: its definition and the chunks that are completed.

``sweep.json`` is the manifest. Each completed chunk of motions is a NumPy file whose name ends
with the first digits of its SHA-256 digest: it is written under another name, flushed and moved
into place, so that a file of that name is complete, or recognised as damaged and repeated. From
all chunks one NumPy file for each map is written.
"""

import fcntl
import hashlib
import json
import os
import re
import reprlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from errno import ENOSPC
from functools import cached_property
from io import BytesIO
from pathlib import Path
from shutil import disk_usage
from typing import Any

import numpy as np
from numpy.lib.format import dtype_to_descr, write_array_header_1_0
from numpy.typing import NDArray

from solvers.io.atomic_write import is_abandoned, replacing, write_text
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.process_arithmetic import DIGEST
from solvers.sweeps.execution.worker import chunk_length

MANIFEST, CHUNKS, FORMAT = "sweep.json", "chunks", 5
#: Bytes of the largest manifest.
MAX_BYTES = 1_000_000
#: Hexadecimal digits of a digest in a file's name.
DIGITS = 16
#: Names of chunks, and of files that are being written.
CHUNK = re.compile(rf"\d+-[0-9a-f]{{{DIGITS}}}\.npy")
TEMPORARY = re.compile(r"\.\w[\w-]*\.(npy|json|png)\.\d+")


class FolderError(ValueError):
    """The folder contains another sweep, or another process works in it."""


class Folder:
    """The folder of a sweep."""

    def __init__(self, path: Path, sweep: Sweep) -> None:
        self.path, self._sweep = path, sweep
        self._motions, self._dtype, self._length = sweep.motions, sweep.dtype, 0
        self.arithmetic: dict[str, str] = {}  # of the process that began the sweep
        self._own = {"motions": sweep.motions, "definition": json.loads(json.dumps(sweep.as_json))}

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Lock the folder for one process, which may write to it."""
        self._check_new()
        (self.path / CHUNKS).mkdir(parents=True, exist_ok=True)
        # for reading, too: to open a FIFO for writing would wait for a reader
        number = os.open(self.path / CHUNKS / "lock", os.O_RDWR | os.O_CREAT, 0o666)
        with open(number, "rb") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                raise FolderError(
                    f"another process works in {self.path}: wait for it, or give another --output"
                ) from error
            if not self.is_new:
                self.check()
            self._remove_remains()
            yield

    @property
    def is_new(self) -> bool:
        """Whether no sweep was begun in the folder."""
        return not (self.path / MANIFEST).exists()

    def begin(self, evaluations: float, arithmetic: dict[str, str]) -> None:
        """Write the manifest; arguments are the results of `first_motions`."""
        self._length, self.arithmetic = chunk_length(self._sweep, evaluations), arithmetic
        record = {"format": FORMAT, "chunk": self._length, "arithmetic": arithmetic, **self._own}
        text = json.dumps(record, indent=2, ensure_ascii=False) + "\n"
        write_text(self.path / MANIFEST, text)

    def _remove_remains(self) -> None:
        """Remove damaged chunks, and what killed processes have left."""
        for file in [*self.path.iterdir(), *(self.path / CHUNKS).iterdir()]:
            is_damaged = CHUNK.fullmatch(file.name) and file not in self.completed.values()
            is_left = TEMPORARY.fullmatch(file.name) and is_abandoned(file)
            if (is_damaged or is_left) and not file.is_dir():
                file.unlink(missing_ok=True)

    def _check_new(self) -> None:
        """Refuse a new folder that holds other files, or whose disk is too small."""
        if not self.is_new:
            return
        chunks = self.path.glob(f"{CHUNKS}/*.npy")  # of which sweep?
        for file in [*self.path.iterdir(), *chunks] if self.path.is_dir() else ():
            if file.name != CHUNKS and not TEMPORARY.fullmatch(file.name):
                name = file.relative_to(self.path)
                raise FolderError(f"{self.path} holds {name} and no sweep: give another --output")
        above = next(p for p in (self.path, *self.path.absolute().parents) if p.exists())
        needed, free = 2 * self._motions * self._dtype.itemsize, disk_usage(above).free
        if needed > free:
            sizes = f"the maps need {needed / 1e9:.3g} GB, and {free / 1e9:.3g} GB are free"
            raise OSError(ENOSPC, sizes, str(self.path))

    def check(self) -> None:
        """Compare the manifest, and change nothing."""
        manifest = _manifest(self.path / MANIFEST)
        there, here = (
            {"motions": one["motions"], **one["definition"]} for one in (manifest, self._own)
        )
        if different := _difference(there, here):
            raise FolderError(
                f"{self.path} contains another sweep ({different}): "
                "choose another --output, or delete it"
            )
        self._length, self.arithmetic = manifest["chunk"], manifest["arithmetic"]

    @property
    def chunks(self) -> int:
        """Number of chunks."""
        return -(-self._motions // self._length)

    def span(self, chunk: int) -> tuple[int, int]:
        """The first motion of a chunk, and the one after its last."""
        return chunk * self._length, min((chunk + 1) * self._length, self._motions)

    @cached_property
    def completed(self) -> dict[int, Path]:
        """The chunks that are there and undamaged."""
        files = sorted((self.path / CHUNKS).glob("*.npy"))
        return {int(file.name.partition("-")[0]): file for file in files if self._is_chunk(file)}

    def _is_chunk(self, file: Path) -> bool:
        """Whether a file is a chunk of this sweep, and undamaged."""
        if not CHUNK.fullmatch(file.name) or not file.is_file():
            return False
        chunk, _, digest = file.stem.partition("-")
        content = file.read_bytes()
        if int(chunk) >= self.chunks or _digest(content) != digest:
            return False
        start, stop = self.span(int(chunk))
        zeros = _npy(np.zeros(stop - start, self._dtype))
        data = (stop - start) * self._dtype.itemsize
        # headers are compared, not read: readers of NumPy files fail in many ways
        return len(content) == len(zeros) and content[:-data] == zeros[:-data]

    def store(self, chunk: int, motions: NDArray[np.void]) -> None:
        """Write a chunk."""
        start, stop = self.span(chunk)
        if motions.shape != (stop - start,) or motions.dtype != self._dtype:
            raise AssertionError(f"chunk {chunk} has shape {motions.shape}, {motions.dtype}")
        content = _npy(motions)
        name = f"{chunk:0{len(str(self.chunks))}}-{_digest(content)}.npy"
        self.completed[chunk] = write_text(self.path / CHUNKS / name, content)

    def gather(self) -> None:
        """Write a file for each field of the records, and for each axis of a grid."""
        axes, together = self._sweep.axes, self._finished_together
        for name in together:
            numbers, records = self.finished(name)
            write_text(self.path / f"{name}.npy", _npy(numbers))
            text = json.dumps(records, indent=2, ensure_ascii=False) + "\n"
            write_text(records_path(self._sweep, self.path, name), text)
        for name in self._dtype.names or ():
            if name in together:
                continue
            field = self._dtype[name]
            shape = (*axes.shape, *field.shape)
            header = {"descr": dtype_to_descr(field.base), "fortran_order": False, "shape": shape}
            with replacing(self.path / f"{name}.npy") as file:
                write_array_header_1_0(file, header)
                for rows in self.rows(name):
                    file.write(np.ascontiguousarray(rows).tobytes())
        if axes.is_grid:
            for name, values in axes.coordinates().items():
                write_text(self.path / f"{name}.npy", _npy(values))

    @property
    def _finished_together(self) -> list[str]:
        """Maps that need the stored numbers of all motions."""
        return [name for name, one in self._sweep.maps.items() if one.records]

    def finished(self, name: str) -> tuple[NDArray[Any], list[dict[str, Any]]]:
        """One field of all motions, with the shape of the axes first, and the map's records."""
        rows, records = np.concatenate([*self.rows(name)]), list[dict[str, Any]]()
        if name in self._finished_together:
            rows, records = self._sweep.maps[name].finish(self._sweep.module, rows)
        return rows.reshape(*self._sweep.axes.shape, *rows.shape[1:]), records

    def rows(self, name: str) -> Iterator[NDArray[Any]]:
        """One field of all motions by chunks; NaN, or 0 for integers, where it is not done yet."""
        field = self._dtype[name]
        for chunk in range(self.chunks):
            start, stop = self.span(chunk)
            if chunk in self.completed:
                yield np.load(self.completed[chunk])[name]
            else:
                unknown = np.nan if field.base.kind == "f" else 0
                yield np.full((stop - start, *field.shape), unknown, field.base)


def records_path(sweep: Sweep, folder: Path, name: str) -> Path:
    """The file of the records of a map."""
    return folder / f"{name}_{sweep.maps[name].records}.json"


def _npy(array: NDArray[Any]) -> bytes:
    """The content of a NumPy file."""
    file = BytesIO()
    np.save(file, array, allow_pickle=False)
    return file.getvalue()


def _manifest(path: Path) -> dict[str, Any]:
    """The manifest in a file."""
    manifest: dict[str, Any] = {}
    with suppress(OSError, ValueError, TypeError, RecursionError):
        if path.is_file() and path.stat().st_size <= MAX_BYTES:
            manifest = dict(json.loads(path.read_bytes()))
    counts = [manifest.get(key) for key in ("format", "chunk", "motions")]
    if all(type(n) is int and n > 0 for n in counts):
        if counts[0] != FORMAT:
            raise FolderError(
                f"{path.parent} holds a sweep in format {counts[0]}, and this version reads format "
                f"{FORMAT}: give another --output, or remove it"
            )
        arithmetic = manifest.get("arithmetic")
        has_digest = isinstance(arithmetic, dict) and isinstance(arithmetic.get(DIGEST), str)
        if isinstance(manifest.get("definition"), dict) and has_digest:
            return manifest
    problem = "is no manifest of a sweep" if path.exists() else "does not exist"
    raise FolderError(f"{path} {problem}: give the --output of a sweep, or a new folder")


def _digest(content: bytes) -> str:
    """The first digits of the digest of a chunk."""
    return hashlib.sha256(content).hexdigest()[:DIGITS]


def _difference(other: Any, own: Any, path: str = "") -> str:
    """The first difference of two manifests, as key and values; empty if they are equal."""
    if isinstance(other, list) and isinstance(own, list) and len(other) == len(own):
        other, own = dict(enumerate(other)), dict(enumerate(own))
    if isinstance(other, dict) and isinstance(own, dict):
        for key in {**own, **other}:
            if key not in other or key not in own:
                side = "in the folder" if key in other else "in the definition"
                return f"{path}{key} is {side} only"
            if inner := _difference(other[key], own[key], f"{path}{key}."):
                return inner
        return ""
    values = f"{reprlib.repr(other)}, not {reprlib.repr(own)}"
    return "" if other == own else f"{path.rstrip('.')} {values}"
