"""Files that are written completely or not at all."""

import os
import re
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from secrets import token_hex
from typing import IO

#: Names of files being written: random digits, the final name, and the number of the process.
TEMPORARY = re.compile(r"\..+\.(\d+)")


def write_text(path: Path, text: str | bytes) -> Path:
    """Write a file under a temporary name, then move it into place; folders are created."""
    with replacing(path) as file:
        file.write(text.encode() if isinstance(text, str) else text)
    return path


def write_texts(folder: Path, texts: Mapping[str, str]) -> None:
    """Write files by name; all are complete on disk before the first is moved into place."""
    with ExitStack() as stack:
        for name, text in texts.items():
            file = stack.enter_context(replacing(folder / name))
            file.write(text.encode())
            _flush(file)


@contextmanager
def replacing(path: Path) -> Iterator[IO[bytes]]:
    """A file to write to, which replaces `path` when it is complete; folders are created."""
    path.parent.mkdir(parents=True, exist_ok=True)
    # threads may write the same file, and so may processes of other machines with this number
    temporary = path.with_name(f".{token_hex(4)}-{path.name}.{os.getpid()}")
    try:
        with open(temporary, "wb") as file:
            yield file
            _flush(file)
        os.replace(temporary, path)
    except OSError as error:
        # a full disk names no file, and a folder in its place the temporary one
        if error.errno and str(error.filename or temporary) == str(temporary):
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise
    finally:
        temporary.unlink(missing_ok=True)


def _flush(file: IO[bytes]) -> None:
    file.flush()
    os.fsync(file.fileno())


def is_temporary(path: Path) -> bool:
    """Whether a name is that of a file being written."""
    return TEMPORARY.fullmatch(path.name) is not None


def is_abandoned(path: Path) -> bool:
    """Whether a name is that of a temporary file of a process that no longer runs."""
    process = TEMPORARY.fullmatch(path.name)
    return process is not None and not _is_running(int(process[1]))


def remove_abandoned(folder: Path) -> None:
    """Remove temporary files of processes that no longer run."""
    for path in filter(is_abandoned, folder.iterdir()):
        path.unlink(missing_ok=True)


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except PermissionError:
        return True
    except (ProcessLookupError, OverflowError):
        return False
    return True
