"""C code to shared libraries, by the first compiler that works, built once."""

import hashlib
import os
import platform
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from solvers.io.build_cache import NotMovedError, cache_folder, folder_in_place, is_intact

#: ``-ffast-math`` would switch the whole process to flushing small numbers to zero.
#: Vectors are explicit in the source: loops over a small state are slower when vectorised.
FLAGS = (
    *("-std=c99", "-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-fPIC"),
    *("-fno-tree-vectorize", "-Wno-psabi"),
)
#: Time limit of a compiler in s, and the file that it writes.
TIME_LIMIT, LIBRARY = 120, "library.so"


class NoCompilerError(RuntimeError):
    """No compiler built the library; the message lists those tried and their errors."""


@dataclass(frozen=True)
class Library:
    """A shared library on disk, whose digest has just been checked."""

    path: Path
    compiler: str  # the command that built it


def build(source: str, *, reproducible: bool = False) -> Library:
    """The library of a complete C99 program, from the cache or by the first of `compilers`.

    Reproducible libraries fuse no products and sums: every compiler gives the same bits, at
    some cost of speed.
    """
    flags = (*FLAGS, "-ffp-contract=off" if reproducible else "-ffp-contract=fast")
    folder, errors = cache_folder(), []
    for compiler in compilers():
        entry = folder / _key(source, compiler, flags)
        try:
            if not is_intact(entry):
                _build(source, compiler, flags, entry)
        except (_CompilerError, NotMovedError) as error:
            errors.append(f"{compiler[0]}: {error}")
            continue
        return Library(entry / LIBRARY, " ".join(compiler))
    tried = "; ".join(errors) or "none was found"
    raise NoCompilerError(
        f"no C compiler built the library ({tried}): install one as `cc`, or the package ziglang"
    )


def compilers() -> Iterator[tuple[str, ...]]:
    """Commands that compile C: the system's compiler, then that of the package ziglang."""
    path = shutil.which("cc")
    if path:
        yield (os.path.abspath(path),)
    if find_spec("ziglang"):
        yield (sys.executable, "-m", "ziglang", "cc")


def _key(source: str, compiler: Sequence[str], flags: Sequence[str]) -> str:
    """A digest of the source, the compiler, the flags and the processor."""
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


class _CompilerError(Exception):
    """A compiler did not build the library."""


def _build(source: str, compiler: Sequence[str], flags: Sequence[str], entry: Path) -> None:
    """Build a library in the cache."""
    with folder_in_place(entry, 10 * TIME_LIMIT) as ready:
        folder = ready.parent
        (folder / "source.c").write_text(source, encoding="utf-8")
        _run([*compiler, *flags, "-shared", "-o", LIBRARY, "source.c", "-lm"], folder)
        if not (folder / LIBRARY).is_file() or not (folder / LIBRARY).stat().st_size:
            raise _CompilerError("wrote no library")
        os.replace(folder / LIBRARY, ready / LIBRARY)


def _run(command: Sequence[str], folder: Path) -> None:
    """Run a compiler, and end it with all its children if it exceeds the time limit."""
    nowhere, pipe = subprocess.DEVNULL, subprocess.PIPE
    options: dict[str, Any] = {"stdin": nowhere, "stdout": nowhere, "stderr": pipe}
    try:
        process = subprocess.Popen(command, cwd=folder, start_new_session=True, **options)
    except OSError as error:
        raise _CompilerError(f"cannot be run: {error.strerror}") from error
    try:
        _, output = process.communicate(timeout=TIME_LIMIT)
    except subprocess.TimeoutExpired as error:
        raise _CompilerError(f"did not end within {TIME_LIMIT} s") from error
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
    if process.returncode:
        message = output.decode(errors="replace").strip()[-300:]
        raise _CompilerError(message or f"exit {process.returncode}")
