"""Scenes by name: those that ship with holonomic, and those in other files."""

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


def find(name: str, load: Callable[[str], GeneratedModule]) -> Scene:
    """The scene of a name, or in a file.

    Parameters
    ----------
    name : str
        Name of a scene that ships, or path of a file that ends in ``.toml``.
    load : callable
        Returns the generated module of a name; raises `LookupError` for an unknown one.

    Returns
    -------
    Scene
        With the scenes beside it.

    Raises
    ------
    solvers.io.toml_input.InputError
        When there is no such scene, or it is not valid.
    OSError
        When the file cannot be read.

    Warns
    -----
    solvers.scenes.checks.MassMatrixWarning
        When the mass matrix is nearly singular.
    UserWarning
        When an initial angle without a unit exceeds a whole turn, so that degrees may be meant.
    """
    return read(toml_input.path("scene", name, FILES), load)
