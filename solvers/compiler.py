"""C code to shared libraries, built once and kept in a cache that can be trusted.

A library is built in a private folder inside the cache, and the whole folder is
then renamed into place, with a digest beside the library: whoever comes second
finds it there, and nothing that is damaged, half-written or somebody else's is
ever loaded. There are no locks.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import platform
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

#: ``-ffast-math`` would switch the whole process to flushing small numbers to zero.
FLAGS = ("-std=c99", "-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-fPIC")
#: Seconds that a compiler may take.
PATIENCE = 120

LIBRARY, DIGEST = "library.so", "library.sha256"
#: Names of the folders in which libraries are built begin so.
PASSAGE = "build-"


class NoCompilerError(RuntimeError):
    """No compiler made a library; the message says which were tried and what each said."""


@dataclass(frozen=True)
class Library:
    """A shared library on disk.

    Attributes
    ----------
    path : Path
        The file, whose digest has just been checked.
    compiler : str
        What built it.
    """

    path: Path
    compiler: str


def build(source: str, *, reproducible: bool = False) -> Library:
    """The library of the C program `source`, from the cache or newly built.

    Parameters
    ----------
    source : str
        A complete C99 program text.
    reproducible : bool
        Whether products and sums must not be fused: then every compiler gives the
        same bits, and some speed is lost.

    Raises
    ------
    NoCompilerError
        When no compiler is there, or none of those there could build it.
    """
    flags = (*FLAGS, "-ffp-contract=off" if reproducible else "-ffp-contract=fast")
    folder, complaints = cache_folder(), []
    for compiler in compilers():
        place = folder / _key(source, compiler, flags)
        if not _is_intact(place):
            complaint = _built(source, compiler, flags, place)
            if complaint:
                complaints.append(f"{compiler[0]}: {complaint}")
                continue
        return Library(place / LIBRARY, " ".join(compiler))
    tried = "; ".join(complaints) or "none was found"
    raise NoCompilerError(
        f"no C compiler built the library ({tried}): install one as `cc`, or the package ziglang"
    )


def compilers() -> Iterator[tuple[str, ...]]:
    """Commands that compile C: the system's own, then the one that comes as a Python package."""
    found = shutil.which("cc")
    if found:
        yield (found,)
    if find_spec("ziglang"):
        yield (sys.executable, "-m", "ziglang", "cc")


def cache_folder() -> Path:
    """A folder that only this user can write to: the usual cache, or one until the process ends."""
    home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    folder = Path(home) / "holonomic"
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError:
        return _private_folder()
    return folder if folder.is_absolute() and _is_private(folder) else _private_folder()


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


def _key(source: str, compiler: Sequence[str], flags: Sequence[str]) -> str:
    """A name for what is built: of what, by what, how, and for which processor."""
    status = Path(compiler[0]).stat()
    parts = (source, *compiler, str(status.st_mtime_ns), str(status.st_size), *flags, _processor())
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]


@cache
def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    features = next((line for line in lines if line.startswith(("flags", "Features"))), "")
    return f"{platform.system()} {platform.machine()} {platform.processor()} {features}"


def _is_intact(place: Path) -> bool:
    try:
        expected = (place / DIGEST).read_text(encoding="ascii")
        return _is_private(place) and _digest(place / LIBRARY) == expected
    except (OSError, UnicodeDecodeError):
        return False


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _built(source: str, compiler: Sequence[str], flags: Sequence[str], place: Path) -> str:
    """Build into `place`; return what went wrong, if anything did."""
    _remove_abandoned(place.parent)
    with tempfile.TemporaryDirectory(prefix=PASSAGE, dir=place.parent) as name:
        passage = Path(name)
        (passage / "source.c").write_text(source, encoding="utf-8")
        command = [*compiler, *flags, "-shared", "-o", LIBRARY, "source.c", "-lm"]
        complaint = _run(command, passage)
        if complaint:
            return complaint
        if not (passage / LIBRARY).is_file() or not (passage / LIBRARY).stat().st_size:
            return "wrote no library"
        (passage / DIGEST).write_text(_digest(passage / LIBRARY), encoding="ascii")
        ready = passage / "ready"
        ready.mkdir(mode=0o700)
        for part in (LIBRARY, DIGEST):
            os.replace(passage / part, ready / part)
        return _placed(ready, place, passage)


def _run(command: Sequence[str], folder: Path) -> str:
    """Run a compiler; return what went wrong. One that hangs is ended with all its children."""
    try:
        process = subprocess.Popen(
            command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE, start_new_session=True,
        )  # fmt: skip
    except OSError as error:
        return f"cannot be run: {error.strerror}"
    try:
        _, words = process.communicate(timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return f"did not end within {PATIENCE} s"
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
    if process.returncode:
        return words.decode(errors="replace").strip()[-300:] or f"exit {process.returncode}"
    return ""


def _remove_abandoned(folder: Path) -> None:
    """Remove what builds left behind that were killed."""
    for passage in folder.glob(f"{PASSAGE}*"):
        try:
            if time.time() - passage.stat().st_mtime > 10 * PATIENCE:
                shutil.rmtree(passage, ignore_errors=True)
        except OSError:
            continue  # its own process was faster


def _placed(ready: Path, place: Path, passage: Path) -> str:
    """Move a finished folder into place, unless another process was faster."""
    for attempt in range(3):
        try:
            os.rename(ready, place)
            return ""
        except OSError:
            if _is_intact(place):
                return ""
            # what stands there is damaged or not ours: take it away, and with it when we leave
            try:
                os.rename(place, passage / f"damaged-{attempt}")
            except OSError:
                continue
    return f"cannot move it to {place}"
