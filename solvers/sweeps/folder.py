"""The folder of a sweep: what was asked, and what is done of it, whatever happens in between.

``sweep.json`` says exactly what was asked. Each finished chunk of motions is a NumPy file whose
name ends with the beginning of its SHA-256 digest: it is written beside its name, flushed and
moved into place, so that a file of that name is whole, or is found to be damaged and done again.
When all chunks are there, one NumPy file for each map is put together from them.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import re
from collections.abc import Callable, Iterator, Mapping
from errno import ENOSPC
from functools import cached_property
from io import BytesIO
from pathlib import Path
from shutil import disk_usage
from types import TracebackType
from typing import IO, Any

import numpy as np
from numpy.lib.format import dtype_to_descr, write_array_header_1_0
from numpy.typing import NDArray

from solvers.io.atomic_write import replacing, write_text

MANIFEST, CHUNKS, FORMAT = "sweep.json", "chunks", 1
#: Hexadecimal digits of a digest in a file's name.
DIGITS = 16
#: Names of chunks, and of files that are being written.
CHUNK = re.compile(rf"\d+-[0-9a-f]{{{DIGITS}}}\.npy")
PASSAGE = re.compile(r"\.\w[\w-]*\.(npy|json|png)\.\d+")


class FolderError(ValueError):
    """The folder is another sweep's, or another process works in it."""


class Folder:
    """Where a sweep is kept; only one process at a time may work in it.

    Parameters
    ----------
    path : Path
        The folder; it is made.
    asked : mapping
        All that decides what comes out.
    motions : int
        How many there are.
    chunk : callable
        How many of them a chunk is to hold; called where nothing is there yet.
    dtype : numpy.dtype
        What is kept of a motion.

    Raises
    ------
    FolderError
        When another sweep is there, or another process is at work.
    OSError
        When it cannot be written.
    """

    def __init__(
        self, path: Path, asked: Mapping[str, Any], motions: int, chunk: Callable[[], int],
        dtype: np.dtype[np.void],
    ) -> None:  # fmt: skip
        self.path, self._dtype, self._motions = path, dtype, motions
        self._asked, self._chunk = json.loads(json.dumps(asked)), chunk
        self._length = 0
        self._lock: IO[bytes] | None = None

    def __enter__(self) -> Folder:
        self._check_room()
        (self.path / CHUNKS).mkdir(parents=True, exist_ok=True)
        self._lock = open(self.path / CHUNKS / "lock", "wb")
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            self._lock.close()
            raise FolderError(
                f"another process is at work in {self.path}: wait for it, or give another --output"
            ) from error
        try:
            self._claim()
        except BaseException:
            self._lock.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:  # fmt: skip
        assert self._lock is not None
        self._lock.close()

    def _claim(self) -> None:
        """Write the manifest, or see that it is the same; sweep up what killed processes left."""
        place = self.path / MANIFEST
        if place.exists():
            self.look()
        else:
            self._length = self._chunk()
            manifest = {
                "format": FORMAT, "chunk": self._length, "motions": self._motions,
                "asked": self._asked,
            }  # fmt: skip
            write_text(place, json.dumps(manifest, indent=2, ensure_ascii=False) + "\n")
        for place in [*self.path.iterdir(), *(self.path / CHUNKS).iterdir()]:
            is_damaged = CHUNK.fullmatch(place.name) and place not in self.done.values()
            if is_damaged or PASSAGE.fullmatch(place.name):
                place.unlink()

    def _check_room(self) -> None:
        """Refuse a folder that is somebody else's, and maps that do not fit."""
        if self.path.is_dir() and not (self.path / MANIFEST).exists():
            for place in self.path.iterdir():
                if place.name != CHUNKS and not PASSAGE.fullmatch(place.name):
                    raise FolderError(
                        f"{self.path} holds {place.name}, and no sweep: give another --output"
                    )
        above = next(p for p in (self.path, *self.path.absolute().parents) if p.exists())
        needed, free = 2 * self._motions * self._dtype.itemsize, disk_usage(above).free
        if not (self.path / MANIFEST).exists() and needed > free:
            raise OSError(
                ENOSPC, f"the maps take {needed / 1e9:.3g} GB, and {free / 1e9:.3g} GB are free",
                str(self.path),
            )  # fmt: skip

    def look(self) -> None:
        """See what is there, and change nothing.

        Raises
        ------
        FolderError
            When another sweep is there, or none.
        """
        found = _read(self.path / MANIFEST)
        asked = {"format": FORMAT, "motions": self._motions, **self._asked}
        there = {"format": found["format"], "motions": found["motions"], **found["asked"]}
        if different := difference(there, asked):
            raise FolderError(
                f"{self.path} holds another sweep: {different}; give another --output, or remove it"
            )
        self._length = found["chunk"]

    @property
    def chunks(self) -> int:
        """How many chunks there are."""
        return -(-self._motions // self._length)

    def span(self, chunk: int) -> tuple[int, int]:
        """The first motion of a chunk, and the one after its last."""
        return chunk * self._length, min((chunk + 1) * self._length, self._motions)

    @cached_property
    def done(self) -> dict[int, Path]:
        """The chunks that are there, and whole."""
        found = {}
        for place in sorted((self.path / CHUNKS).glob("*.npy")):
            if CHUNK.fullmatch(place.name) and is_whole(place):
                chunk = int(place.stem.partition("-")[0])
                begin, end = self.span(chunk)
                if np.load(place, mmap_mode="r").shape == (end - begin,):
                    found[chunk] = place
        return found

    def keep(self, chunk: int, motions: NDArray[np.void]) -> None:
        """Write a chunk."""
        begin, end = self.span(chunk)
        if motions.shape != (end - begin,) or motions.dtype != self._dtype:
            raise AssertionError(f"chunk {chunk} has shape {motions.shape}, {motions.dtype}")
        file = BytesIO()
        np.save(file, motions, allow_pickle=False)
        digest = hashlib.sha256(file.getbuffer()).hexdigest()[:DIGITS]
        name = f"{chunk:0{len(str(self.chunks))}}-{digest}.npy"
        self.done[chunk] = write_text(self.path / CHUNKS / name, file.getvalue())

    def gather(self, shape: tuple[int, ...]) -> None:
        """Put the maps together, a file each, of a sweep of this shape."""
        for name in self._dtype.names or ():
            field = self._dtype[name]
            header = {
                "descr": dtype_to_descr(field.base), "fortran_order": False,
                "shape": (*shape, *field.shape),
            }  # fmt: skip
            with replacing(self.path / f"{name}.npy") as file:
                write_array_header_1_0(file, header)
                for rows in self.rows(name):
                    file.write(np.ascontiguousarray(rows).tobytes())

    def rows(self, name: str) -> Iterator[NDArray[Any]]:
        """One field of all motions, chunk by chunk; of those not done NaN, or 0 if whole."""
        field = self._dtype[name]
        for chunk in range(self.chunks):
            begin, end = self.span(chunk)
            if chunk in self.done:
                yield np.load(self.done[chunk])[name]
            else:
                unknown = np.nan if field.base.kind == "f" else 0
                yield np.full((end - begin, *field.shape), unknown, field.base)


def _read(place: Path) -> dict[str, Any]:
    """The manifest in a file."""
    try:
        found = json.loads(place.read_bytes())
        counts = [found[key] for key in ("format", "chunk", "motions")]
        if all(type(n) is int and n > 0 for n in counts) and isinstance(found["asked"], dict):
            return dict(found)
    except (OSError, ValueError, KeyError, TypeError):
        pass
    what = "is no manifest of a sweep" if place.exists() else "is not there"
    raise FolderError(f"{place} {what}: give the --output of a sweep, or of none")


def is_whole(place: Path) -> bool:
    """Whether a chunk is what it was when it was written."""
    digest = place.stem.partition("-")[2]
    return hashlib.sha256(place.read_bytes()).hexdigest()[:DIGITS] == digest


def difference(found: Any, asked: Any, where: str = "") -> str:
    """The first key at which two manifests differ, and what stands there; empty if none does."""
    if isinstance(found, list) and isinstance(asked, list) and len(found) == len(asked):
        found, asked = dict(enumerate(found)), dict(enumerate(asked))
    if isinstance(found, dict) and isinstance(asked, dict):
        for key in {**asked, **found}:
            if key not in found or key not in asked:
                side = "here" if key in found else "asked"
                return f"{where}{key} is {side} only"
            if inner := difference(found[key], asked[key], f"{where}{key}."):
                return inner
        return ""
    return "" if found == asked else f"{where.rstrip('.')} is {found!r} there, {asked!r} asked"
