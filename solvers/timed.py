"""Functions of a generated module that take the time only where they depend on it."""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType
from typing import Any

from numpy.typing import ArrayLike


def evaluated(
    module: ModuleType, function: str, t: ArrayLike, y: ArrayLike, params: Sequence[Any]
) -> Any:
    """The function's value at time `t`, which it is told if it is one of ``module.TIMED``.

    Parameters
    ----------
    module : module
        A generated module.
    function : str
        Such as ``energy``, or ``energy_many`` with arrays.
    t, y, params : array_like
        What the function takes.

    Returns
    -------
    object
        What the function gives: a number, a tuple or an array.
    """
    timed = function.removesuffix("_many") in getattr(module, "TIMED", ())
    call = getattr(module, function)
    return call(t, y, params) if timed else call(y, params)


def depends_on_time(module: ModuleType) -> bool:
    """Whether the equations of motion do."""
    return "rhs" in getattr(module, "TIMED", ())
