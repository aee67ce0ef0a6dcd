"""A folder of generated files: compared with the generator's texts, and written atomically."""

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import unified_diff
from pathlib import Path
from typing import Literal

from solvers.io.atomic_write import is_temporary, remove_abandoned, write_texts


@dataclass(frozen=True)
class FileDifference:
    """A file that differs from the generator's text."""

    path: Path
    reason: Literal["missing", "differs", "orphan"]  # nothing generates an orphan
    diff: str = ""  # unified, from the file to the generator's text


@dataclass(frozen=True)
class GeneratedFiles:
    """The generated texts for the files of a folder."""

    folder: Path
    texts: Mapping[str, str]  # by name or path of the file in the folder
    complete: bool  # whether every other file in the folder is an orphan

    def differences(self) -> list[FileDifference]:
        """Files that are missing, that differ or that nothing generates, by name."""
        texts = self.texts.items()
        compared = (self._difference(self.folder / name, text) for name, text in texts)
        orphans = (FileDifference(path, "orphan") for path in self.orphans())
        return sorted([*filter(None, compared), *orphans], key=lambda each: each.path)

    def orphans(self) -> list[Path]:
        """Files and folders that nothing generates, except caches and temporary folders."""
        if not self.complete or not self.folder.is_dir():
            return []
        return sorted(
            path
            for path in self.folder.iterdir()
            if path.name not in self.texts and path.name != "__pycache__" and not is_temporary(path)
        )

    def write(self) -> list[Path]:
        """Replace every file that differs by one rename, and return the paths of these files."""
        # all files are complete before the first rename
        for folder in {(self.folder / name).parent for name in self.texts}:
            folder.mkdir(parents=True, exist_ok=True)
            remove_abandoned(folder)
        changed = [d.path for d in self.differences() if d.reason != "orphan"]
        by_path = {self.folder / name: name for name in self.texts}
        write_texts(self.folder, {by_path[path]: self.texts[by_path[path]] for path in changed})
        return changed

    @staticmethod
    def _difference(path: Path, text: str) -> FileDifference | None:
        if not path.is_file():
            return FileDifference(path, "missing")
        present = path.read_bytes()
        if present == text.encode():
            return None
        before = present.decode(errors="backslashreplace").splitlines(keepends=True)
        after = text.splitlines(keepends=True)
        diff = "".join(unified_diff(before, after, f"{path.name} as it is", "as generated", n=1))
        return FileDifference(
            path, "differs", diff or "only line ends or the final newline differ\n"
        )
