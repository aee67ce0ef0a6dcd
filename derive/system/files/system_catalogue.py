"""The systems that ship with holonomic, found by their files' names.

A file whose name ends in ``_n`` holds a family: its ``system`` is a function of n, and
``chain_5`` is its member with n = 5. A file may also define ``PUBLISHED``: published equations of
the system, as TOML text in the format of ``holonomic verify``. The modules of the systems in the
folder ``large`` are too long to ship: they are derived when they are first used.
"""

import re
from importlib import import_module
from os import PathLike, fspath
from types import ModuleType

from derive.system.files.shipped import USUAL, large_names, names, stems
from derive.system.files.system_file import read_system
from derive.system.parts import SystemDefinitionError
from derive.system.system import System
from solvers.io.suggestion import did_you_mean

#: The largest member of a family that is derived.
LARGEST = 100


class UnknownSystemError(ValueError):
    """No system has this name; the message lists the names that exist."""


def load(name: str | PathLike[str]) -> System:
    """The system of this name, or in this TOML file.

    Parameters
    ----------
    name : str or path
        Name of a system, such as ``double_pendulum``; a member of a family, such as ``chain_5``,
        up to `LARGEST`; or the path of a system file that ends in ``.toml``.

    Returns
    -------
    System

    Raises
    ------
    UnknownSystemError
        When no system has this name.
    SystemDefinitionError
        When the file does not define a system, or defines one of another name.

    Examples
    --------
    >>> from derive import load
    >>> load("double_pendulum").title
    'Double pendulum: two point masses on rigid massless rods in a vertical plane'
    >>> len(load("chain_7").coordinates)
    7
    """
    name = fspath(name)
    if name.endswith(".toml"):
        return read_system(name)
    stem, n = _file(name)
    try:
        system = _module(stem).system
        if n:
            system = system(n)
    except Exception as error:
        raise SystemDefinitionError(
            f"{stem}.py does not define a system: {type(error).__name__}: {error}"
        ) from error
    if not isinstance(system, System) or system.name != name:
        raise SystemDefinitionError(
            f"`system` in {stem}.py is {getattr(system, 'name', system)!r}: it must be a System "
            f"with the name {name!r}"
        )
    return system


def drawing(name: str) -> str:
    """The docstring of a system's file: a description, a drawing and a reference."""
    return (_module(_file(name)[0]).__doc__ or "").rstrip()


def published(name: str) -> str:
    """Published equations of a system or of a member of its family, as TOML text; may be empty."""
    stem, n = _file(name)
    text: str = getattr(_module(stem), "PUBLISHED", "")
    return text if n or not text else f'system = "{name}"{text}'


def _module(stem: str) -> ModuleType:
    package = "derive.systems.large" if stem in large_names() else "derive.systems"
    return import_module(f"{package}.{stem}")


def _file(name: str) -> tuple[str, int]:
    """The file of a system, and n of a member of a family, otherwise 0."""
    family = re.match(r"(\w+)_([1-9]\d{0,2})\Z", name)
    if family and f"{family[1]}_n" in stems() and int(family[2]) <= LARGEST:
        return f"{family[1]}_n", int(family[2])
    known = (*names(), *large_names())
    if name not in {*stems(), *large_names()} or name.endswith("_n"):
        raise UnknownSystemError(
            f"no system is called {name[:50]!r}{did_you_mean(name, known)}; known are "
            f"{', '.join(known)}, with any number up to {LARGEST} instead of {USUAL}; the path "
            "of a system file ends in .toml"
        )
    return name, 0
