"""C code to shared libraries, by whichever compiler is at hand, built once."""

from __future__ import annotations

import hashlib
import os
import platform
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from solvers.io.build_cache import (
    BUILD_PREFIX,
    cache_folder,
    is_intact,
    move_into_place,
    remove_abandoned,
    write_digests,
)

#: ``-ffast-math`` would switch the whole process to flushing small numbers to zero.
#: Vectors of states are written as such; what a compiler makes of loops over a small state is
#: slower than the loops themselves.
FLAGS = (
    *("-std=c99", "-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-fPIC"),
    *("-fno-tree-vectorize", "-Wno-psabi"),
)
#: Seconds that a compiler may take, and what it makes.
PATIENCE, LIBRARY = 120, "library.so"


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

    Returns
    -------
    Library
        By the first of `compilers` that could build it.

    Raises
    ------
    NoCompilerError
        When no compiler is there, or none of those there could build it.
    """
    flags = (*FLAGS, "-ffp-contract=off" if reproducible else "-ffp-contract=fast")
    folder, complaints = cache_folder(), []
    for compiler in compilers():
        place = folder / _key(source, compiler, flags)
        if not is_intact(place):
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
        yield (os.path.abspath(found),)
    if find_spec("ziglang"):
        yield (sys.executable, "-m", "ziglang", "cc")


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


def _built(source: str, compiler: Sequence[str], flags: Sequence[str], place: Path) -> str:
    """Build into `place`; return what went wrong, if anything did."""
    remove_abandoned(place.parent, 10 * PATIENCE)
    with tempfile.TemporaryDirectory(prefix=BUILD_PREFIX, dir=place.parent) as name:
        passage = Path(name)
        (passage / "source.c").write_text(source, encoding="utf-8")
        command = [*compiler, *flags, "-shared", "-o", LIBRARY, "source.c", "-lm"]
        complaint = _run(command, passage)
        if complaint:
            return complaint
        if not (passage / LIBRARY).is_file() or not (passage / LIBRARY).stat().st_size:
            return "wrote no library"
        ready = passage / "ready"
        ready.mkdir(mode=0o700)
        os.replace(passage / LIBRARY, ready / LIBRARY)
        write_digests(ready)
        return move_into_place(ready, place, passage)


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
