"""Files that are there whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO


def write_text(path: Path, text: str | bytes) -> Path:
    """Write a file beside its name first, then move it into place.

    Parameters
    ----------
    path : Path
        Its name; missing folders are made, and what stands there is replaced.
    text : str or bytes
        What it is to hold; text becomes UTF-8.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    OSError
        When it cannot be written; then nothing has changed.
    """
    with replacing(path) as file:
        file.write(text.encode() if isinstance(text, str) else text)
    return path


@contextmanager
def replacing(path: Path) -> Iterator[IO[bytes]]:
    """A file to write to, which is moved into place when it is whole.

    Parameters
    ----------
    path : Path
        Its name; missing folders are made, and what stands there is replaced.

    Yields
    ------
    binary file
        Open for writing, beside `path`.

    Raises
    ------
    OSError
        When it cannot be written; then nothing has changed.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    passage = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with open(passage, "wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        os.replace(passage, path)
    except OSError as error:
        error.filename = error.filename or str(path)  # a full disk does not say where it is
        raise
    finally:
        passage.unlink(missing_ok=True)
