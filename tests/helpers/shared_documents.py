"""The folder of public documents with verdicts, which may stand beside the repository."""

import os
from pathlib import Path

import pytest

BESIDE = Path(__file__).parents[3] / "shared"
SHARED = Path(os.environ.get("HOLONOMIC_SHARED", BESIDE))


def shared(name: str) -> Path:
    """A folder of shared test data; the test is skipped where there is none."""
    if not (SHARED / name).is_dir():
        pytest.skip(f"no folder {SHARED / name}")
    return SHARED / name
