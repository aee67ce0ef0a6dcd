"""The methods that ship with holonomic, found by their files' names."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from solvers import methods
from solvers.near import near
from solvers.tableau import Tableau


class UnknownMethodError(ValueError):
    """No method has this name; the message lists those that exist."""


def names() -> tuple[str, ...]:
    """Names of all methods, in alphabetical order."""
    return tuple(sorted(module.name for module in iter_modules(methods.__path__)))


@cache
def load(name: str) -> Tableau:
    """The method called `name`.

    Parameters
    ----------
    name : str
        One of `names`, such as ``verner87``; SciPy's methods are none of them.

    Returns
    -------
    Tableau

    Raises
    ------
    UnknownMethodError
        When no file is called so.
    """
    if name not in names():
        raise UnknownMethodError(
            f"no method is called {name[:50]!r}{near(name, names())}; known are: "
            f"{', '.join(names())}"
        )
    tableau: Tableau = import_module(f"solvers.methods.{name}").tableau
    return tableau
