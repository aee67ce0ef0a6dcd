"""What is asked of an integration, refused before anything runs if it makes no sense."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

#: The shortest step, in parts of the time's last digit: below it a shorter step rounds to itself.
SHORTEST = 10


def numbers(name: str, values: ArrayLike, expected: Sequence[str]) -> Array:
    """`values` as a new array of finite floats, one for each name in `expected`."""
    array = _floats(name, values)
    if array.shape != (len(expected),):
        raise ValueError(
            f"{name} has shape {array.shape}: give {len(expected)} numbers, {', '.join(expected)}"
        )
    _finite(name, array)
    return array


def time_span(values: ArrayLike) -> tuple[float, float]:
    """Beginning and end."""
    array = numbers("t_span", values, ("t_start", "t_end"))
    return float(array[0]), float(array[1])


def times(values: ArrayLike, span: tuple[float, float]) -> Array:
    """Times within `span`, each further from its beginning than the one before."""
    array = _floats("t_eval", values)
    if array.ndim != 1:
        raise ValueError(f"t_eval has shape {array.shape}: give a list of times")
    _finite("t_eval", array)
    low, high = sorted(span)
    outside = array[(array < low) | (array > high)]
    if outside.size:
        raise ValueError(f"t_eval has {outside[0]}, outside of t_span = {span}")
    if np.any(np.diff(array) * np.sign(span[1] - span[0]) <= 0):
        raise ValueError("t_eval must go from t_span's beginning to its end, no time twice")
    return array


def tolerances(rtol: float, atol: ArrayLike, size: int) -> tuple[float, Array]:
    """Tolerances, of which one at least is positive in every component."""
    array = _floats("atol", atol)
    relative = _floats("rtol", rtol)
    for name, value in (("rtol", relative), ("atol", array)):
        _finite(name, value)
        if np.any(value < 0):
            raise ValueError(f"{name} = {value} must not be negative")
    if relative.ndim or array.shape not in ((), (size,)):
        raise ValueError(f"rtol must be a number, atol a number or {size} of them")
    if relative == 0 and np.any(array == 0):
        raise ValueError("rtol and atol are both 0: no step is short enough; make one positive")
    if 0 < relative < 4 * np.finfo(float).eps:
        raise ValueError(f"rtol = {relative} is below the resolution of numbers, 9e-16")
    return float(relative), array


def step(h: float, span: tuple[float, float]) -> float:
    """A fixed step: positive, and large enough to change the time."""
    array = _floats("h", h)
    if array.ndim or not np.isfinite(array) or array <= 0:
        raise ValueError(f"h = {h} must be a positive number (the direction follows from t_span)")
    resolution = SHORTEST * float(np.spacing(np.abs(span).max()))
    if array < resolution and span[0] != span[1]:
        raise ValueError(f"h = {h} is below the resolution {resolution} of times in {span}")
    return float(array)


def count(max_steps: int) -> int:
    """A number of steps."""
    if not isinstance(max_steps, int) or isinstance(max_steps, bool) or max_steps < 0:
        raise ValueError(f"max_steps = {max_steps!r} must be a whole number, 0 or more")
    return max_steps


def callables(events: object) -> list[Callable[..., float]]:
    """Events as a list."""
    found: list[Any] = list(events) if isinstance(events, Sequence) else [events]
    if not all(map(callable, found)):
        raise ValueError(f"events = {events!r} must be functions event(t, y), one or a list")
    return found


def parameters(module: ModuleType, params: ArrayLike) -> Array:
    """Parameters in the order of the module."""
    return numbers("params", params, module.PARAMETERS)


def _floats(name: str, values: ArrayLike) -> Array:
    array = np.asarray(values)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{name} = {str(values)[:60]} must be real numbers")
    return np.array(array, dtype=float)


def _finite(name: str, array: Array) -> None:
    if not np.isfinite(array).all():
        raise ValueError(f"{name} = {array} must be finite")
