"""Output of commands, and their exit codes."""

import re
from pathlib import Path

import numpy as np
import pytest
from folders import ROOT
from recording import Record
from valid_files import BEAD, HAND, SWEEP

from solvers.app.cli import main

WRONG = HAND.replace("g*sin(phi) = 0", "g*cos(phi) = 0").replace('cos(phi)"', 'cos(phi)/2"', 1)
DOCUMENT = r"""
# A pendulum
$$x = l\sin\theta, \quad y = -l\cos\theta$$
$$T = \frac12 m l^2\dot\theta^2, \quad V = -m g l\sin\theta$$
$$\ddot\theta = -\frac gl\sin\theta$$
"""
PROGRAM = """
from numpy import sin

def rhs(t, y, g, l):
    theta, omega = y
    return [omega, -g/l*sin(2*theta)]
"""
COMMANDS = """
systems single_pendulum slider_crank
derive --check single_pendulum
derive bead.toml --output out
derive bead.toml --output out
derive bead.toml --document bead.html --exercises blank
verify swinging_atwood
verify right.toml wrong.toml
verify page.md program.py
export single --to julia --event theta=1
export bead.toml --to matlab
export single --to jax
export bead.toml --to opencl --event x=1
run rest one_bob
run small.toml
sweep sweep.toml --workers 1
sweep sweep.toml --draw
fit single swing.csv --unknown l
fit single swing.csv --unknown l,g
fit single swing.csv --unknown l --test swing.csv --compare g=9
"""
#: Times, and roundings.
MEASURED = re.compile(
    r"(?<=cost: ).*|(?<=took ).*|(?<=less than )[\d.]+e-1\d|(?<=at most )[\d.]+e-1\d|"
    r"(?<=error estimate )\d.\de-1\d"
)


def test_output_of_commands_is_as_recorded(
    record: Record,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    t = np.linspace(0, 3, 31)
    rows = zip(t, np.round(0.2 * np.cos(2.2 * t) + 1e-3 * np.sin(99 * t), 4), strict=True)
    swing = "t [s],theta [rad]\n" + "".join(f"{a:.1f},{b}\n" for a, b in rows)
    files = {"bead.toml": BEAD, "right.toml": HAND, "wrong.toml": WRONG, "page.md": DOCUMENT,
        "program.py": PROGRAM, "sweep.toml": SWEEP, "swing.csv": swing}  # fmt: skip
    for name, text in files.items():
        Path(name).write_text(text, encoding="utf-8")
    texts = []
    for line in COMMANDS.strip().splitlines():
        code = main(line.split())
        out, err = capsys.readouterr()
        texts.append(f"$ holonomic {line}\n{out}{err}[{code}]\n")
    record.check(MEASURED.sub("…", "\n".join(texts).replace(str(ROOT), "")))
