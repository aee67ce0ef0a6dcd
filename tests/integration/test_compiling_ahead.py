"""Loops that measure predictability or errors are compiled while that of the motion is."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from folders import ROOT

MOTION = """
import generated.double_pendulum as dp
from solvers import integrate
print(integrate(dp, (0, 1), (1.0, 0.5, 0.0, 0.0), {}).run)
"""
SCENE = """
from solvers.app.cli import main
main(["run", "report", "--output", "{folder}"])
print("compiled by the scene")
"""
#: A compiler that waits until another one runs, for the time of 100 short pauses at most.
WAITING = """#!/bin/sh
grep -q trial source.c && exec '{cc}' "$@"
touch {folder}/running-$$
for i in $(seq 100); do
    [ -e {folder}/together ] && break
    [ $(ls {folder} | grep -c running) -ge 2 ] && touch {folder}/together && break
    sleep 0.1
done
rm {folder}/running-$$
[ -e {folder}/together ] || touch {folder}/alone
exec '{cc}' "$@"
"""

pytestmark = [
    pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler"),
    pytest.mark.usefixtures("predictable_times"),
]


def run(folder: Path, script: str, code: str = MOTION) -> subprocess.CompletedProcess[str]:
    """A process that integrates a motion with an empty cache and this compiler."""
    (folder / "bin").mkdir()
    compiler = folder / "bin" / "cc"
    compiler.write_text(script.format(cc=shutil.which("cc"), folder=folder))
    compiler.chmod(0o755)
    return subprocess.run(
        [sys.executable, "-c", code.replace("{folder}", str(folder))],
        cwd=ROOT,
        env={"PATH": f"{compiler.parent}:/usr/bin:/bin", "XDG_CACHE_HOME": str(folder / "cache")},
        capture_output=True,
        text=True,
        check=True,
    )


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("code", [MOTION, MOTION.replace("{})", "{}, accuracy=1e-6)"), SCENE])
def test_loops_are_compiled_at_the_same_time(code: str, tmp_path: Path) -> None:
    process = run(tmp_path, WAITING, code)
    assert "compiled by" in process.stdout
    assert process.stderr == ""
    assert (tmp_path / "together").exists()
    assert not (tmp_path / "alone").exists()  # no compiler waited for another one in vain


def test_a_broken_compiler_is_reported_once(tmp_path: Path) -> None:
    process = run(tmp_path, "#!/bin/sh\necho it is broken >&2\nexit 1\n")
    assert "python" in process.stdout or "zig" in process.stdout
    assert process.stderr.count("it is broken") == 1
    assert "Traceback" not in process.stderr
