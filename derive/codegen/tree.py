"""A folder of generated files: written whole or not at all, and compared with what it should be."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import unified_diff
from pathlib import Path

#: Names of the folders that hold files on their way; the number of the process follows.
PASSAGE = ".holonomic-"


@dataclass(frozen=True)
class Difference:
    """A file that is not what the generator makes.

    Attributes
    ----------
    path : Path
        The file.
    reason : {"missing", "differs", "orphan"}
        What is wrong; nothing generates an orphan.
    diff : str
        Unified diff from the file to what it should be.
    """

    path: Path
    reason: str
    diff: str = ""


@dataclass(frozen=True)
class Tree:
    """What a folder should hold.

    Attributes
    ----------
    folder : Path
        Where the files are.
    texts : mapping of str to str
        The files' texts, by name.
    complete : bool
        Whether any other source file in the folder is an orphan.
    """

    folder: Path
    texts: Mapping[str, str]
    complete: bool

    def differences(self) -> list[Difference]:
        """Files that are missing, that differ or that nothing generates, by name."""
        found = [
            difference
            for name, text in self.texts.items()
            if (difference := self._difference(self.folder / name, text))
        ]
        found += [Difference(path, "orphan") for path in self.orphans()]
        return sorted(found, key=lambda difference: difference.path)

    def orphans(self) -> list[Path]:
        """Files and folders that nothing generates; caches and files on their way aside."""
        if not self.complete or not self.folder.is_dir():
            return []
        return sorted(
            path
            for path in self.folder.iterdir()
            if path.name not in self.texts
            and path.name != "__pycache__"
            and not path.name.startswith(PASSAGE)
        )

    def write(self) -> list[Path]:
        """Put every file that differs into place, each by one rename; return their paths.

        All files are complete before the first one moves. What an interrupted run
        left behind is removed.

        Returns
        -------
        list of Path
            Of the files that were written, by name; empty if all were up to date.

        Raises
        ------
        OSError
            When the folder cannot be written to.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        _remove_abandoned(self.folder)
        changed = [d.path.name for d in self.differences() if d.reason != "orphan"]
        if not changed:
            return []
        passage = Path(tempfile.mkdtemp(prefix=f"{PASSAGE}{os.getpid()}-", dir=self.folder))
        try:
            for name in changed:
                with open(passage / name, "w", encoding="utf-8", newline="\n") as file:
                    file.write(self.texts[name])
                    file.flush()
                    os.fsync(file.fileno())
            for name in changed:
                os.replace(passage / name, self.folder / name)
        finally:
            shutil.rmtree(passage, ignore_errors=True)
        return [self.folder / name for name in changed]

    @staticmethod
    def _difference(path: Path, text: str) -> Difference | None:
        if not path.is_file():
            return Difference(path, "missing")
        present = path.read_bytes()
        if present == text.encode():
            return None
        before = present.decode(errors="backslashreplace").splitlines(keepends=True)
        after = text.splitlines(keepends=True)
        diff = "".join(unified_diff(before, after, f"{path.name} as it is", "as generated", n=1))
        return Difference(path, "differs", diff or "only line ends or the final newline differ\n")


def _remove_abandoned(folder: Path) -> None:
    for passage in folder.glob(f"{PASSAGE}*"):
        if passage.is_dir() and not _is_alive(passage.name):
            shutil.rmtree(passage, ignore_errors=True)


def _is_alive(passage: str) -> bool:
    number = passage.removeprefix(PASSAGE).partition("-")[0]
    try:
        os.kill(int(number), 0)
    except (ProcessLookupError, ValueError):
        return False
    except PermissionError:
        return True
    return True
