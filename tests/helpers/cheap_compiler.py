"""The C compiler of the tests: less optimisation, and each library compiled once.

Most of the time of a compilation is optimisation, which only tests of speed would notice. The short
part of the tests compiles some 360 libraries, those of single motions without any; in these, and in
all libraries of the long part, an index outside an array ends the process. In the long part,
``-fexpensive-optimizations`` fuses products and sums as ``-O3`` does.
"""

import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import pytest
from folders import ROOT

from solvers.integration.compiled import extended
from solvers.integration.compiled.kernel import kernel

PLACE = ROOT / "out" / "tests"
CHECKS = "-fsanitize=bounds -fsanitize-undefined-trap-on-error"
#: Flags of the two parts of the tests.
SHORT, LONG = f"-O0 {CHECKS}", f"-O1 -fexpensive-optimizations {CHECKS}"
#: Flags of the short part for loops over many motions, which run longer than the compiler.
LANES = "-Og"
#: Libraries that no test has used for these seconds are removed.
UNUSED = 7 * 86_400.0
SCRIPT = """#!/bin/sh
# {compiler}, with less optimisation; libraries that were compiled before are copied
case "$*" in
*" -shared -o library.so source.c -lm")
    flags='{flags}'
    grep -q '^#define HOLONOMIC_VECTOR' source.c && flags='{lanes}'
    key=$( (echo "$* $flags"; cat source.c) | sha256sum | cut -c1-32)
    if cp '{folder}/libraries/'"$key" library.so 2> /dev/null; then
        touch '{folder}/libraries/'"$key"
        exit 0
    fi
    '{compiler}' "$@" $flags || exit
    cp library.so '{folder}/libraries/'"$key.$$"
    mv '{folder}/libraries/'"$key.$$" '{folder}/libraries/'"$key"
    ;;
*)
    exec '{compiler}' "$@"
    ;;
esac
"""


def install(flags: str) -> None:
    """Put a script before the system's compiler in the path; without a compiler do nothing."""
    os.environ["PATH"] = _without(os.environ["PATH"])
    compiler = shutil.which("cc")
    if compiler is None:
        return
    folder = PLACE / ("short" if flags == SHORT else "long")
    libraries, script = folder / "libraries", folder / "cc"
    libraries.mkdir(parents=True, exist_ok=True)
    for library in libraries.iterdir():
        with suppress(FileNotFoundError):  # another process has renamed or removed it
            if library.stat().st_mtime < time.time() - UNUSED:
                library.unlink()
    lanes = LANES if flags == SHORT else flags
    text = SCRIPT.format(compiler=compiler, folder=folder, flags=flags, lanes=lanes)
    # a script with another time is another compiler, whose libraries are built anew
    if not script.is_file() or script.read_text(encoding="utf-8") != text:
        beside = folder / f"cc.{os.getpid()}"
        beside.write_text(text, encoding="utf-8")
        beside.chmod(0o755)
        beside.replace(script)
    os.environ["PATH"] = os.pathsep.join([str(folder), os.environ["PATH"]])


@contextmanager
def compiling(flags: str = "") -> Iterator[None]:
    """Compile with these flags in this context, without any with the optimisation of users."""
    loops = kernel, extended.kernel  # those of this process
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PATH", _without(os.environ["PATH"]))
        if flags:
            install(flags)
        for loop in loops:
            loop.cache_clear()
        yield
        for loop in loops:
            loop.cache_clear()


def _without(path: str) -> str:
    """A path without the scripts."""
    folders = path.split(os.pathsep)
    return os.pathsep.join(one for one in folders if not one.startswith(str(PLACE)))
