"""A cache of shared libraries that can be trusted.

A library is built in a private folder inside the cache, and the whole folder is
then renamed into place, with a digest beside the library: whoever comes second
finds it there, and nothing that is damaged, half-written or somebody else's is
ever loaded. There are no locks.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import stat
import tempfile
import time
from functools import cache
from pathlib import Path

LIBRARY, DIGEST = "library.so", "library.sha256"
#: Names of the folders in which libraries are built begin so.
PASSAGE = "build-"


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
    """Whether a finished library stands there, as it was built, and only we could change it."""
    try:
        expected = (place / DIGEST).read_text(encoding="ascii")
        is_file = stat.S_ISREG((place / LIBRARY).lstat().st_mode)
        return is_file and _is_private(place) and digest(place / LIBRARY) == expected
    except (OSError, UnicodeDecodeError):
        return False


def digest(path: Path) -> str:
    """What a file holds, in short."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def placed(ready: Path, place: Path, passage: Path) -> str:
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
    """Remove what killed builds left behind more than `age` seconds ago."""
    for passage in folder.glob(f"{PASSAGE}*"):
        try:
            if time.time() - passage.stat().st_mtime > age:
                shutil.rmtree(passage, ignore_errors=True)
        except OSError:
            continue  # its own process was faster
