"""Files that are there whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path


def written(path: Path, text: str | bytes) -> Path:
    """Write a file beside its name first, then move it into place.

    Raises
    ------
    OSError
        When it cannot be written; then nothing has changed.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    passage = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with open(passage, "wb") as file:
            file.write(text.encode() if isinstance(text, str) else text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(passage, path)
    finally:
        passage.unlink(missing_ok=True)
    return path
