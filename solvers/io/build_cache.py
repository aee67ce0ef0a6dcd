"""A cache of built folders that can be trusted.

A folder is built in a private place, sealed with its name and the digests of its files, and then
renamed into place. Concurrent processes share one result, and damaged, incomplete or foreign
folders are never used. There are no locks. Notes inform other processes for some minutes that a
build is in vain.
"""

import atexit
import hashlib
import os
import shutil
import stat
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from errno import EACCES, ENOENT
from functools import cache, partial
from pathlib import Path

from solvers.io.atomic_write import write_text
from solvers.io.suggestion import warn_caller

#: The seal of a complete folder, and the beginning of the names of folders being built.
DIGESTS, BUILD_PREFIX = "digests.sha256", "build-"
#: Bytes of the longest seal and of the largest file.
MAX_SEAL, MAX_BYTES = 10_000, 1 << 28
#: Seconds after which the remains of a killed process are removed.
ABANDONED = 600.0
#: Seconds for which a note is valid, and bytes of the longest.
VALID, MAX_NOTE = 300.0, 1000
#: Where folders are built if neither the cache nor the usual folder of temporary files can be used.
TEMPORARY_FOLDERS = ("/var/tmp", "/dev/shm")
#: The way out for messages.
HINT = "set XDG_CACHE_HOME to a folder in which only you can write"


class NoPlaceError(OSError):
    """No folder can be built anywhere; the message lists the places tried and the reasons."""


def built_folder(
    name: str, build: Callable[[Path], None], *, mark: bytes = b"", is_loaded: bool = False
) -> Path:
    """The complete folder of this name, from the cache or filled by ``build(folder)``.

    Where the cache cannot be used it is built in a temporary folder, with a warning.

    Parameters
    ----------
    name : str
        Name of the folder, which determines its content.
    build : callable
        Writes the files. An `OSError` leads to the next place, other errors are passed on.
    mark : bytes, optional
        What one of the files must contain.
    is_loaded : bool, optional
        Whether the files are machine code, which no folder mounted noexec can hold.

    Raises
    ------
    NoPlaceError
        When it can be built nowhere.
    """
    reasons: list[str] = []
    places: list[Callable[[], Path]] = [cache_folder]
    places += [partial(_temporary_folder, root) for root in (None, *TEMPORARY_FOLDERS)]
    for place in places:
        where: Path | str = ""
        try:
            where = place()
            folder = where / name
            if is_loaded and os.statvfs(where).f_flag & getattr(os, "ST_NOEXEC", 0):
                raise OSError(EACCES, "mounted noexec")
            if not is_intact(folder, mark):
                with _in_place(folder, mark) as ready:
                    build(ready)
        except OSError as error:
            where = where or error.filename or "no folder of temporary files"
            reasons.append(f"{where}: {error.strerror or error}")
            continue
        if reasons:
            warn_caller(f"building in {where} ({'; '.join(reasons)}): {HINT}")
        return folder
    raise NoPlaceError(f"nothing can be built ({'; '.join(reasons)}): {HINT}")


def temporary_folder() -> Path:
    """A folder until this process ends; `NoPlaceError` where there can be none."""
    reasons = []
    for root in (None, *TEMPORARY_FOLDERS):
        try:
            return _temporary_folder(root)
        except OSError as error:
            reasons.append(f"{error.filename or 'no folder of temporary files'}: {error.strerror}")
    raise NoPlaceError("; ".join(reasons))


def cache_folder() -> Path:
    """The user's cache, which may be read-only; `OSError` if others can write to it."""
    root = os.environ.get("XDG_CACHE_HOME", "")
    if not os.path.isabs(root):
        root = os.path.join(os.path.expanduser("~"), ".cache")
    if not os.path.isabs(root):
        raise OSError(ENOENT, "there is no home folder", root)
    folder = Path(os.path.realpath(root)) / "holonomic"
    for part in (*reversed(folder.parents), folder):
        part.mkdir(mode=0o700, exist_ok=True)
    _check_private(folder)
    return folder


@cache
def _temporary_folder(root: str | None) -> Path:
    """A folder in `root` or the usual folder of temporary files, until this process ends."""
    root = os.path.realpath(root or tempfile.gettempdir())
    try:
        folder = Path(tempfile.mkdtemp(prefix="holonomic-", dir=root))
    except OSError as error:  # without the random name: equal warnings are shown once
        raise OSError(error.errno, error.strerror, root) from error
    atexit.register(_remove_own, folder, os.getpid())
    _check_private(folder)
    return folder


def _remove_own(folder: Path, process: int) -> None:
    if os.getpid() == process:  # not a fork of the process that made it
        shutil.rmtree(folder, ignore_errors=True)


def _check_private(folder: Path) -> None:
    """Refuse a folder that others can write to or, in one of the folders above it, replace."""
    root_users = {0, os.stat("/").st_uid}  # the latter in containers, where it has another number
    for part in (folder, *folder.parents):
        status = part.lstat()
        owners = {os.getuid()} if part == folder else {os.getuid(), *root_users}
        if not stat.S_ISDIR(status.st_mode):
            raise OSError(EACCES, "not a folder", str(part))
        if status.st_uid not in owners:
            raise OSError(EACCES, "belongs to another user", str(part))
        # in a folder with the sticky bit, such as /tmp, only owners rename their files
        is_sticky = part != folder and status.st_mode & stat.S_ISVTX
        if status.st_mode & (stat.S_IWGRP | stat.S_IWOTH) and not is_sticky:
            raise OSError(EACCES, "others can write to it (chmod go-w)", str(part))


def is_intact(folder: Path, mark: bytes = b"") -> bool:
    """Whether a folder is complete, unchanged, and the one that was built under its name.

    One of its files contains `mark`, and only this user can write to it.
    """
    try:
        status = folder.lstat()
        is_own = stat.S_ISDIR(status.st_mode) and status.st_uid == os.getuid()
        seal = _content(folder / DIGESTS, MAX_SEAL).decode("ascii")
        lines = (line.split("  ", 2) for line in seal.splitlines()[1:])
        sizes = {name: min(int(size), MAX_BYTES) for _, size, name in lines}
        files = {name: _content(folder / name, size) for name, size in sizes.items()}
        is_marked = any(mark in content for content in files.values())
        is_closed = not status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
        return is_own and is_closed and is_marked and seal == _seal(folder.name, files)
    except (OSError, ValueError):
        return False


def _content(path: Path, size: int) -> bytes:
    """The content of a regular file of at most `size` bytes; nothing else is read."""
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)  # a pipe would block
    with open(descriptor, "rb") as file:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode) or status.st_size > size:
            raise OSError(EACCES, "not a regular file of the expected size", str(path))
        return file.read(size)


def leave_note(place: Path, name: str, text: str) -> None:
    """Leave a note for other processes, if the folder can be written to."""
    with suppress(OSError):
        write_text(place / name, text[:MAX_NOTE].encode("ascii", "replace"))


def note(place: Path, name: str) -> str | None:
    """The note of this name, if there is one that is valid."""
    path = place / name
    try:
        if abs(time.time() - path.lstat().st_mtime) < VALID:
            return _content(path, MAX_NOTE).decode("ascii")
        path.unlink()
    except (OSError, ValueError):
        pass
    return None


def _seal(name: str, files: Mapping[str, bytes]) -> str:
    """The name of a folder, then digest, size and name of each file."""
    digests = {file: hashlib.sha256(content).hexdigest() for file, content in files.items()}
    lines = (f"{digests[file]}  {len(files[file])}  {file}" for file in sorted(files))
    return "".join(f"{line}\n" for line in (name, *lines))


@contextmanager
def _in_place(folder: Path, mark: bytes) -> Iterator[Path]:
    """A private folder to build files in, then moved to `folder` with its seal."""
    _remove_abandoned(folder.parent)
    with tempfile.TemporaryDirectory(prefix=BUILD_PREFIX, dir=folder.parent) as name:
        ready = Path(name) / "ready"
        ready.mkdir(mode=0o700)
        yield ready
        files = {path.name: path.read_bytes() for path in ready.iterdir()}
        (ready / DIGESTS).write_text(_seal(folder.name, files), encoding="ascii")
        _move(ready, folder, mark)


def _move(ready: Path, folder: Path, mark: bytes) -> None:
    """Move a complete folder into place, unless another process was faster."""
    for attempt in range(3):
        try:
            os.rename(ready, folder)
            return
        except OSError:
            if is_intact(folder, mark):
                return
            with suppress(OSError):  # damaged or foreign: removed with the build folder
                os.rename(folder, ready.parent / f"damaged-{attempt}")
    raise OSError(EACCES, "a finished folder cannot be moved there", str(folder))


def _remove_abandoned(folder: Path) -> None:
    """Remove build folders that killed processes left."""
    for build in folder.glob(f"{BUILD_PREFIX}*"):
        with suppress(OSError):  # removed by its own process
            if time.time() - build.stat().st_mtime > ABANDONED:
                shutil.rmtree(build, ignore_errors=True)
