"""A sweep as a file, for tests that change it or run it."""

from pathlib import Path

FILE = """
system = "double_pendulum"
duration = 30
[axes]
theta1 = { from = -3, to = 3, count = 120 }
theta2 = { from = -3, to = 3, count = 120 }
[maps.end]
kind = "final"
of = ["theta1", "theta2"]
"""


def write_sweep(folder: Path, text: str = FILE) -> Path:
    path = folder / "mine.toml"
    path.write_text(text)
    return path
