"""A cache of built files that can be trusted.

Files are built in a private folder, which is then renamed into place with digests of its files.
Concurrent processes share one result, and damaged, incomplete or foreign files are never loaded.
There are no locks.
"""

import atexit
import hashlib
import os
import shutil
import stat
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

#: The file with the digests of a complete folder, one a line; and where files are built.
DIGESTS, BUILD_PREFIX = "digests.sha256", "build-"


class NotMovedError(OSError):
    """A complete folder could not be moved into place."""


def cache_folder() -> Path:
    """A folder that only this user can write to: the usual cache, or one for this process."""
    home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    folder = Path(home) / "holonomic"
    with suppress(OSError):
        if folder.is_absolute():
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
            if _is_private(folder):
                return folder
    return _private_folder()


def _is_private(folder: Path) -> bool:
    status = folder.lstat()
    is_own = stat.S_ISDIR(status.st_mode) and status.st_uid == os.getuid()
    return is_own and not status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


@cache
def _private_folder() -> Path:
    folder = Path(tempfile.mkdtemp(prefix="holonomic-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def is_intact(folder: Path) -> bool:
    """Whether a complete folder exists, unchanged, and only this user can write to it."""
    try:
        lines = (folder / DIGESTS).read_text(encoding="ascii").splitlines()
        expected = [tuple(line.split("  ", 1)) for line in lines]
        names = [name for _, name in expected]
        are_files = all(stat.S_ISREG((folder / name).lstat().st_mode) for name in names)
        is_complete = bool(names) and are_files and _is_private(folder)
        return is_complete and expected == _digests(folder, names)
    except (OSError, ValueError):
        return False


@contextmanager
def folder_in_place(folder: Path, abandoned: float) -> Iterator[Path]:
    """A private folder to build files in, then moved to `folder` with their digests.

    Build folders that killed processes left more than `abandoned` seconds ago are removed.
    """
    _remove_abandoned(folder.parent, abandoned)
    with tempfile.TemporaryDirectory(prefix=BUILD_PREFIX, dir=folder.parent) as name:
        ready = Path(name) / "ready"
        ready.mkdir(mode=0o700)
        yield ready
        files = sorted(path.name for path in ready.iterdir())
        text = "".join(f"{digest}  {file}\n" for digest, file in _digests(ready, files))
        (ready / DIGESTS).write_text(text, encoding="ascii")
        _move(ready, folder, Path(name))


def _digests(folder: Path, names: Sequence[str]) -> list[tuple[str, ...]]:
    return [(hashlib.sha256((folder / name).read_bytes()).hexdigest(), name) for name in names]


def _move(ready: Path, folder: Path, build: Path) -> None:
    """Move a complete folder into place, unless another process was faster."""
    for attempt in range(3):
        try:
            os.rename(ready, folder)
            return
        except OSError:
            if is_intact(folder):
                return
            with suppress(OSError):  # damaged or foreign: removed with the build folder
                os.rename(folder, build / f"damaged-{attempt}")
    raise NotMovedError(f"cannot move it to {folder}")


def _remove_abandoned(folder: Path, age: float) -> None:
    """Remove build folders of killed processes that are older than `age` seconds."""
    for build in folder.glob(f"{BUILD_PREFIX}*"):
        with suppress(OSError):  # removed by its own process
            if time.time() - build.stat().st_mtime > age:
                shutil.rmtree(build, ignore_errors=True)
