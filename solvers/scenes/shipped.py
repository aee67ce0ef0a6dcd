"""The scenes that ship with holonomic, found by their files' names; and those of anybody else."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from solvers.near import near
from solvers.scenes.reading import read
from solvers.scenes.scene import Scene

FILES = Path(__file__).parent / "files"


class UnknownSceneError(ValueError):
    """No scene has this name."""


def names() -> tuple[str, ...]:
    """Names of all scenes that ship, in alphabetical order."""
    return tuple(sorted(path.stem for path in FILES.glob("*.toml")))


def find(name: str, module: Callable[[str], ModuleType]) -> Scene:
    """The scene of this name, or in this file.

    Parameters
    ----------
    name : str
        Of a scene that ships, or the path of a file that ends in ``.toml``.
    module : callable
        Gives a generated module by its name; raises `LookupError` for an unknown one.

    Raises
    ------
    UnknownSceneError
        When there is none.
    solvers.said.InputError
        When it makes no sense.
    OSError
        When the file cannot be read.
    """
    if name in names():
        return read(FILES / f"{name}.toml", module)
    if name.endswith(".toml") and Path(name).is_file():
        return read(Path(name), module)
    if name.endswith(".toml"):
        raise UnknownSceneError(f"scene {name[:80]!r}: there is no such file")
    own = Path(f"{name}.toml")
    hint = f" (did you mean '{own}'?)" if own.is_file() else near(name, names())
    raise UnknownSceneError(
        f"scene {name[:80]!r} is not one of {', '.join(names())}{hint}; your own end in .toml"
    )
