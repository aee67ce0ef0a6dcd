"""A folder of generated files: written whole or not at all, and compared with what it should be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import unified_diff
from pathlib import Path

from solvers.io.atomic_write import is_temporary, remove_abandoned, write_texts


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
            if path.name not in self.texts and path.name != "__pycache__" and not is_temporary(path)
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
        remove_abandoned(self.folder)
        changed = [d.path.name for d in self.differences() if d.reason != "orphan"]
        write_texts(self.folder, {name: self.texts[name] for name in changed})
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
