"""C code to shared libraries, by the first compiler that works, built once."""

import ctypes
import hashlib
import os
import platform
import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache, partial
from importlib.util import find_spec
from pathlib import Path

from solvers.integration.compiled.compilation import (
    LIBRARY,
    CommandError,
    Compilation,
    FailedCompilations,
    identity,
)
from solvers.io.build_cache import NoPlaceError, built_folder
from solvers.io.suggestion import warn_caller

#: ``-ffast-math`` would switch the whole process to flushing small numbers to zero.
#: Vectors are explicit in the source: loops over a small state are slower when vectorised.
FLAGS = (
    *("-std=c99", "-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-fPIC"),
    *("-fno-tree-vectorize", "-Wno-psabi"),
)
_attempts = FailedCompilations()


class NoCompilerError(OSError):
    """No compiler built the library; the message lists those tried and their errors."""


@dataclass(frozen=True)
class Library:
    """A shared library that was loaded; its digest and its key have been checked."""

    path: Path
    compiler: str  # the command that built it
    functions: ctypes.CDLL = field(compare=False, repr=False)


def build(source: str, *, reproducible: bool = False) -> Library:
    """The library of a complete C99 program, from the cache or by the first of `compilers`.

    If the program has a function ``void probe(void)``, it is called once, in another process,
    before a new library is used.

    Parameters
    ----------
    source : str
        The program.
    reproducible : bool, optional
        Whether no products and sums are fused: every compiler gives the same bits then, at some
        cost of speed.

    Raises
    ------
    NoCompilerError
        When no compiler builds a library that works.
    """
    contraction = "-ffp-contract=off" if reproducible else "-ffp-contract=fast"
    errors: list[str] = []
    for compiler in compilers():
        flags = (*FLAGS, *_tuning(compiler), contraction)
        try:
            library = _library(Compilation(source, compiler, flags, _key(source, compiler, flags)))
        except CommandError as error:
            errors.append(f"{compiler[0]}: {error}")
        except NoPlaceError as error:
            raise NoCompilerError(str(error)) from error
        else:
            if errors:
                warn_caller(f"compiling with {library.compiler}: {'; '.join(errors)}")
            return library
    tried = "; ".join(errors) or "none was found"
    raise NoCompilerError(
        f"no C compiler built the library ({tried}): install one as `cc`, or the package ziglang"
    )


def _library(compilation: Compilation) -> Library:
    """A library from the cache or built, and loaded."""
    key, fill = compilation.key, partial(_attempts.run, compilation)
    path = built_folder(key, fill, mark=key.encode(), is_loaded=True) / LIBRARY
    try:
        return Library(path, " ".join(compilation.command), ctypes.CDLL(str(path)))
    except OSError as error:
        raise CommandError(f"its library cannot be loaded: {error}") from error


def compilers() -> Iterator[tuple[str, ...]]:
    """Commands that compile C: the system's compiler, then that of the package ziglang."""
    path = shutil.which("cc")
    if path:
        yield (os.path.abspath(path),)
    package = find_spec("ziglang")
    if package and package.origin:
        yield (str(Path(package.origin).with_name("zig")), "cc")


def _key(source: str, compiler: Sequence[str], flags: Sequence[str]) -> str:
    """A digest of the source, the compiler, the flags and the processor."""
    parts = (source, *identity(compiler), *flags, _processor())
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]


def _tuning(compiler: Sequence[str]) -> tuple[str, ...]:
    """A flag with which GCC copies vectors of 32 bytes as a whole; Zig refuses it."""
    features = _processor().split()
    is_needed = "avx" in features and "avx512f" not in features and len(compiler) == 1
    return ("-mtune=skylake-avx512",) if is_needed else ()


@cache
def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    features = next((line for line in lines if line.startswith(("flags", "Features"))), "")
    return f"{platform.system()} {platform.machine()} {platform.processor()} {features}"
