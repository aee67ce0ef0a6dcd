"""The catalogue of methods: every file of the package `methods` is one."""

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from solvers.io.suggestion import did_you_mean
from solvers.runge_kutta import methods
from solvers.runge_kutta.tableau import Tableau

#: Methods of SciPy's ``solve_ivp``.
SCIPY = ("RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA")


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
        One of `names`, such as ``verner853``; SciPy's methods are not among them.

    Returns
    -------
    Tableau

    Raises
    ------
    UnknownMethodError
        When no method has this name.
    """
    if name not in names():
        raise UnknownMethodError(
            f"no method is called {name[:50]!r}{did_you_mean(name, names())}; known are: "
            f"{', '.join(names())}"
        )
    tableau: Tableau = import_module(f"{methods.__name__}.{name}").tableau
    return tableau
