"""The systems that ship with holonomic, found by their files' names.

A file whose name ends in ``_n`` holds a family: its ``system`` is a function of n, and
``chain_5`` is its member of five.
"""

from __future__ import annotations

import re
from importlib import import_module
from pkgutil import iter_modules

from derive import systems
from derive.system.parts import SystemDefinitionError
from derive.system.system import System
from solvers.io.suggestion import did_you_mean

#: The member of a family that is listed and shipped, and the largest that is derived.
USUAL, LARGEST = 3, 100


class UnknownSystemError(ValueError):
    """No system has this name; the message lists those that exist."""


def names() -> tuple[str, ...]:
    """Names of all systems, in alphabetical order; of a family its usual member."""
    stems = (module.name for module in iter_modules(systems.__path__))
    return tuple(sorted(re.sub(r"_n\Z", f"_{USUAL}", stem) for stem in stems))


def load(name: str) -> System:
    """The system called `name`.

    Parameters
    ----------
    name : str
        Such as ``double_pendulum``; of a family any member, such as ``chain_5``, up to `LARGEST`.

    Returns
    -------
    System

    Raises
    ------
    UnknownSystemError
        When no file is called so.
    SystemDefinitionError
        When its file is wrong: what it says, or that its name and the system's differ.

    Examples
    --------
    >>> from derive import load
    >>> load("double_pendulum").title
    'Double pendulum: two point masses on rigid massless rods in a vertical plane'
    >>> len(load("chain_7").coordinates)
    7
    """
    stem, count = _file(name)
    try:
        system = import_module(f"derive.systems.{stem}").system
        if count:
            system = system(count)
    except Exception as error:
        raise SystemDefinitionError(
            f"{stem}.py does not define a system: {type(error).__name__}: {error}"
        ) from error
    if not isinstance(system, System) or system.name != name:
        raise SystemDefinitionError(
            f"in {stem}.py, `system` must be a System with the file's name, "
            f"not {getattr(system, 'name', system)!r}"
        )
    return system


def drawing(name: str) -> str:
    """What a system looks like and where its equations are published: its file's docstring."""
    stem, _ = _file(name)
    return (import_module(f"derive.systems.{stem}").__doc__ or "").rstrip()


def _file(name: str) -> tuple[str, int]:
    """The file of a system, and which member of a family it is, 0 for none."""
    family = re.match(r"(\w+)_([1-9]\d{0,2})\Z", name)
    stems = {module.name for module in iter_modules(systems.__path__)}
    if family and f"{family[1]}_n" in stems and int(family[2]) <= LARGEST:
        return f"{family[1]}_n", int(family[2])
    if name not in stems or name.endswith("_n"):
        raise UnknownSystemError(
            f"no system is called {name[:50]!r}{did_you_mean(name, names())}; "
            f"known are: {', '.join(names())}, "
            f"and instead of {USUAL} any number up to {LARGEST}"
        )
    return name, 0
