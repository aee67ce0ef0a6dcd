"""The systems that ship with holonomic, found by their files' names."""

from __future__ import annotations

from difflib import get_close_matches
from importlib import import_module
from pkgutil import iter_modules

from derive import systems
from derive.system import System, SystemDefinitionError


class UnknownSystemError(ValueError):
    """No system has this name; the message lists those that exist."""


def names() -> tuple[str, ...]:
    """Names of all systems, in alphabetical order."""
    return tuple(sorted(module.name for module in iter_modules(systems.__path__)))


def load(name: str) -> System:
    """The system called `name`.

    Raises
    ------
    UnknownSystemError
        When no file is called so.
    SystemDefinitionError
        When its file is wrong: what it says, or that its name and the system's differ.
    """
    if name not in names():
        close = get_close_matches(name, names(), n=1)
        hint = f" (did you mean {close[0]!r}?)" if close else ""
        raise UnknownSystemError(
            f"no system is called {name[:50]!r}{hint}; known are: {', '.join(names())}"
        )
    try:
        system = import_module(f"derive.systems.{name}").system
    except Exception as error:
        raise SystemDefinitionError(
            f"{name}.py does not define a system: {type(error).__name__}: {error}"
        ) from error
    if not isinstance(system, System) or system.name != name:
        raise SystemDefinitionError(
            f"in {name}.py, `system` must be a System with the file's name, "
            f"not {getattr(system, 'name', system)!r}"
        )
    return system
