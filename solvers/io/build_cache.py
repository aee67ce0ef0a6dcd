"""A cache of built files that can be trusted.

Files are made in a private folder inside the cache, and the whole folder is then
renamed into place, with digests beside them: whoever comes second finds them there,
and nothing that is damaged, half-written or somebody else's is ever loaded. There are
no locks.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import stat
import tempfile
import time
from collections.abc import Sequence
from functools import cache
from pathlib import Path

#: What the files of a finished folder hold, a line each.
DIGESTS = "digests.sha256"
#: Names of the folders in which files are made begin so.
BUILD_PREFIX = "build-"


def cache_folder() -> Path:
    """A folder that only this user can write to: the usual cache, or one until the process ends."""
    home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    folder = Path(home) / "holonomic"
    if not folder.is_absolute():
        return _private_folder()
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError:
        return _private_folder()
    return folder if _is_private(folder) else _private_folder()


def _is_private(folder: Path) -> bool:
    status = folder.lstat()
    return (
        stat.S_ISDIR(status.st_mode)
        and status.st_uid == os.getuid()
        and not status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    )


@cache
def _private_folder() -> Path:
    folder = Path(tempfile.mkdtemp(prefix="holonomic-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def is_intact(place: Path) -> bool:
    """Whether finished files stand there, as they were made, and only we could change them."""
    try:
        lines = (place / DIGESTS).read_text(encoding="ascii").splitlines()
        expected = [tuple(line.split("  ", 1)) for line in lines]
        names = [name for _, name in expected]
        are_files = all(stat.S_ISREG((place / name).lstat().st_mode) for name in names)
        return (
            bool(names) and are_files and _is_private(place) and expected == _digests(place, names)
        )
    except (OSError, ValueError):
        return False


def write_digests(ready: Path) -> None:
    """Write down what the files of a folder hold."""
    names = sorted(path.name for path in ready.iterdir())
    text = "".join(f"{digest}  {name}\n" for digest, name in _digests(ready, names))
    (ready / DIGESTS).write_text(text, encoding="ascii")


def _digests(folder: Path, names: Sequence[str]) -> list[tuple[str, ...]]:
    return [(hashlib.sha256((folder / name).read_bytes()).hexdigest(), name) for name in names]


def move_into_place(ready: Path, place: Path, passage: Path) -> str:
    """Move a finished folder into place, unless another process was faster."""
    for attempt in range(3):
        try:
            os.rename(ready, place)
            return ""
        except OSError:
            if is_intact(place):
                return ""
            # what stands there is damaged or not ours: take it away, and with it when we leave
            try:
                os.rename(place, passage / f"damaged-{attempt}")
            except OSError:
                continue
    return f"cannot move it to {place}"


def remove_abandoned(folder: Path, age: float) -> None:
    """Remove what killed makers left behind more than `age` seconds ago."""
    for passage in folder.glob(f"{BUILD_PREFIX}*"):
        try:
            if time.time() - passage.stat().st_mtime > age:
                shutil.rmtree(passage, ignore_errors=True)
        except OSError:
            continue  # its own process was faster
