"""The scenes that ship with holonomic, found by their files' names; and those of anybody else."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from solvers.equations.module import GeneratedModule
from solvers.io import toml_input
from solvers.scenes.reading import read
from solvers.scenes.scene import Scene

FILES = Path(__file__).parent / "files"


def names() -> tuple[str, ...]:
    """Names of all scenes that ship, in alphabetical order."""
    return toml_input.names(FILES)


def find(name: str, module: Callable[[str], GeneratedModule]) -> Scene:
    """The scene of this name, or in this file.

    Parameters
    ----------
    name : str
        Of a scene that ships, or the path of a file that ends in ``.toml``.
    module : callable
        Gives a generated module by its name; raises `LookupError` for an unknown one.

    Returns
    -------
    Scene
        With the scenes beside it.

    Raises
    ------
    solvers.io.toml_input.InputError
        When there is none, or it makes no sense.
    OSError
        When the file cannot be read.

    Warns
    -----
    solvers.scenes.checks.MassMatrixWarning
        When the mass matrix is nearly singular.
    UserWarning
        When an initial angle without a unit is more than a turn, so that degrees may be meant.
    """
    return read(toml_input.path("scene", name, FILES), module)
