"""Coordinates that a start may leave out: those without effect, and lengths at equilibrium."""

from collections.abc import Collection
from typing import Any

from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, function, has_function, part


def default_coordinates(
    module: GeneratedModule, given: Collection[str], params: NDArray[Any]
) -> dict[str, Any]:
    """Values of coordinates that are not given, of a system without constraints.

    Parameters
    ----------
    module : module
        A generated module.
    given : collection of str
        Names of the components that are given.
    params : ndarray of shape (parameters, ...)
        Parameters, of one motion or of many.

    Returns
    -------
    dict of str to float or ndarray
        0 for coordinates on which no acceleration depends, such as cyclic ones; for lengths, which
        are positive, the value at the equilibrium, if the system has one. Other coordinates are
        missing.
    """
    missing = [name for name in module.COORDINATES if name not in given]
    if not missing:
        return {}
    variables = part(module, "rhs").VARIABLES["accelerations"]
    result: dict[str, Any] = {
        name: 0.0 for name in missing if name not in variables and name not in module.POSITIVE
    }
    lengths = [name for name in missing if name in module.POSITIVE]
    if lengths and has_function(module, "equilibrium"):
        rest = function(module, "equilibrium_many")(params)
        result |= {name: rest[module.COORDINATES.index(name)] for name in lengths}
    return result


def default_words(module: GeneratedModule, values: dict[str, Any]) -> str:
    """Default coordinates of one motion as text; empty if there are none."""
    units = module.UNITS
    lengths = [
        f"{name} = {float(value):.6g} {units[name]}"
        for name, value in values.items()
        if name in module.POSITIVE
    ]
    others = [name for name in values if name not in module.POSITIVE]
    parts = [f"at equilibrium: {', '.join(lengths)}"] if lengths else []
    if others:
        parts.append(f"without effect on accelerations: {', '.join(others)} = 0")
    return "; ".join(parts)
