"""The C compiler of the tests: less optimisation, and each library compiled once.

Most of the time of a compilation is optimisation, which only tests of speed would notice.
``-fexpensive-optimizations`` fuses products and sums as ``-O3`` does, so that rounding errors are
the same in nearly all places.
"""

import os
import shutil
import time

import pytest
from folders import ROOT

FOLDER = ROOT / "out" / "tests" / "cc"
#: Libraries that no test has used for these seconds are removed.
UNUSED = 7 * 86_400.0
SCRIPT = """#!/bin/sh
# {compiler}, with less optimisation; libraries that were compiled before are copied
case "$*" in
*" -shared -o library.so source.c -lm")
    key=$( (echo "$*"; cat source.c) | sha256sum | cut -c1-32)
    if cp '{folder}/libraries/'"$key" library.so 2> /dev/null; then
        touch '{folder}/libraries/'"$key"
        exit 0
    fi
    '{compiler}' "$@" -O1 -fexpensive-optimizations || exit
    cp library.so '{folder}/libraries/'"$key.$$"
    mv '{folder}/libraries/'"$key.$$" '{folder}/libraries/'"$key"
    ;;
*)
    exec '{compiler}' "$@"
    ;;
esac
"""


def install() -> None:
    """Put the script before the system's compiler in the path; without a compiler do nothing."""
    paths = os.environ["PATH"].split(os.pathsep)
    compiler = shutil.which("cc", path=os.pathsep.join(p for p in paths if p != str(FOLDER)))
    if compiler is None or paths[0] == str(FOLDER):
        return
    libraries, script = FOLDER / "libraries", FOLDER / "cc"
    libraries.mkdir(parents=True, exist_ok=True)
    for library in libraries.iterdir():
        if library.stat().st_mtime < time.time() - UNUSED:
            library.unlink(missing_ok=True)
    text = SCRIPT.format(compiler=compiler, folder=FOLDER)
    # a script with another time is another compiler, whose libraries are built anew
    if not script.is_file() or script.read_text(encoding="utf-8") != text:
        beside = FOLDER / f"cc.{os.getpid()}"
        beside.write_text(text, encoding="utf-8")
        beside.chmod(0o755)
        beside.replace(script)
    os.environ["PATH"] = os.pathsep.join([str(FOLDER), *paths])


def remove(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a test compile as users do."""
    monkeypatch.setenv("PATH", os.environ["PATH"].removeprefix(f"{FOLDER}{os.pathsep}"))
