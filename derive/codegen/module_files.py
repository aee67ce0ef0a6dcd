"""The generated files of a system, and the folder that they are compared with or written to."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import unified_diff
from hashlib import sha256
from os import PathLike
from pathlib import Path
from typing import Literal

import sympy as sp

from derive.codegen.backend import DIGEST, find_backends
from derive.codegen.module_functions import Contents, contents
from derive.mechanics.derivation import Derivation
from derive.mechanics.reduced_coordinates import reduced
from derive.system.system import System
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


#: Digits of the digest of generated files.
DIGITS = 16

FUNCTIONS = ("outputs", "outputs_jacobian", "outputs_parameter_jacobian")


def texts(derivation: Derivation, only: Sequence[str] | None = None) -> dict[str, str]:
    """The generated files of a system by name, with all functions or `only` some."""
    return files(contents(derivation, only))


def files(generated: Contents) -> dict[str, str]:
    """The texts of the generated files by name, in every target language, with their digest."""
    parts = {
        name: text for backend in find_backends() for name, text in backend.files(generated).items()
    }
    digest = sha256("".join(parts.values()).encode()).hexdigest()[:DIGITS]
    return {file: text.replace(DIGEST, digest) for file, text in parts.items()}


def write(system: System, folder: str | PathLike[str]) -> Path:
    """Write the module of a system, its derivatives and the C header, each whole or not at all.

    Coordinates that constraints determine are eliminated before (`reduced`).

    Parameters
    ----------
    system : System
        The system to derive.
    folder : path
        The folder, created if it is missing; ``import`` finds the module if the folder is on
        Python's path.

    Returns
    -------
    Path
        The path of the module.

    Raises
    ------
    SystemDefinitionError
        When a coordinate moves no mass, or moves the masses only as others do; when the
        system's equilibrium is not one.
    UnsupportedFunctionError
        When an expression has no counterpart in generated code.
    OSError
        When the folder cannot be written to.

    Examples
    --------
    >>> from derive import load
    >>> print(write(load("chain_2"), "build"))
    build/chain_2.py
    """
    GeneratedFiles(Path(folder), texts(Derivation(reduced(system))), complete=False).write()
    return Path(folder) / f"{system.name}.py"


def output_texts(derivation: Derivation, outputs: Sequence[sp.Expr]) -> dict[str, str]:
    """The generated files of functions of measured quantities alone."""
    named = {f"output_{k}": formula for k, formula in enumerate(outputs)}
    return texts(Derivation(replace(derivation.system, outputs=named)), FUNCTIONS)
