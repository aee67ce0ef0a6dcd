"""Interval arithmetic over arrays: the range of a generated function over boxes."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
TURN = 2 * np.pi


@dataclass(frozen=True)
class Interval:
    """Intervals [low, high], one of each of many boxes; results contain every value.

    Bounds are rounded outwards by two units in the last place, which covers the errors of NumPy's
    functions.
    """

    low: Array
    high: Array

    def __add__(self, other: "Interval | float") -> "Interval":
        low, high = bounds_of(other)
        return _outward(self.low + low, self.high + high)

    def __neg__(self) -> "Interval":
        return Interval(-self.high, -self.low)

    def __sub__(self, other: "Interval | float") -> "Interval":
        return self + -_interval(other)

    def __rsub__(self, other: float) -> "Interval":
        return -self + other

    def __mul__(self, other: "Interval | float") -> "Interval":
        low, high = bounds_of(other)
        products = [a * b for a in (self.low, self.high) for b in (low, high)]
        # 0 times infinity, where a bound is not known
        products = [np.nan_to_num(x, nan=0.0, posinf=np.inf, neginf=-np.inf) for x in products]
        return _outward(np.minimum.reduce(products), np.maximum.reduce(products))

    def __truediv__(self, other: "Interval | float") -> "Interval":
        low, high = bounds_of(other)
        unknown = (low <= 0) & (high >= 0)
        inverse = Interval(
            np.where(unknown, -np.inf, 1 / np.where(unknown, 1.0, high)),
            np.where(unknown, np.inf, 1 / np.where(unknown, 1.0, low)),
        )
        return self * _outward(inverse.low, inverse.high)

    def __rtruediv__(self, other: float) -> "Interval":
        return _interval(other) / self

    __radd__ = __add__
    __rmul__ = __mul__


def _interval(value: "Interval | float") -> Interval:
    return value if isinstance(value, Interval) else Interval(np.array(value), np.array(value))


def bounds_of(value: "Interval | float") -> tuple[Array, Array]:
    """Lower and upper bounds."""
    interval = _interval(value)
    return interval.low, interval.high


def _outward(low: Array, high: Array) -> Interval:
    for _ in range(2):
        low, high = np.nextafter(low, -np.inf), np.nextafter(high, np.inf)
    return Interval(low, high)


def _cos(x: "Interval | float") -> Interval:
    low, high = bounds_of(x)
    with np.errstate(invalid="ignore"):
        a, b = np.cos(low), np.cos(high)
        result = _outward(np.fmin(a, b), np.fmax(a, b))
        # an extremum is in the interval where a multiple of π is
        wide = ~(high - low < TURN)
        top = wide | (np.ceil(low / TURN - 1e-15) * TURN <= high)
        bottom = wide | ((np.ceil(low / TURN - 0.5 - 1e-15) + 0.5) * TURN <= high)
    return Interval(np.where(bottom, -1.0, result.low), np.where(top, 1.0, result.high))


def _sin(x: "Interval | float") -> Interval:
    return _cos(_interval(x) - Interval(np.array(1.5707963267948966), np.array(1.5707963267948968)))


def _tan(x: "Interval | float") -> Interval:
    return _sin(x) / _cos(x)


def _increasing(function: Callable[[Array], Array]) -> Callable[[Interval | float], Interval]:
    """A function that does not decrease, infinite outside of its domain."""

    def bounded(x: Interval | float) -> Interval:
        with np.errstate(all="ignore"):
            low, high = (np.asarray(function(bound)) for bound in bounds_of(x))
        low, high = np.where(np.isnan(low), -np.inf, low), np.where(np.isnan(high), np.inf, high)
        return _outward(low, high)

    return bounded


def _cosh(x: "Interval | float") -> Interval:
    low, high = bounds_of(x)
    ends = np.cosh(low), np.cosh(high)
    result = _outward(np.minimum(*ends), np.maximum(*ends))
    return Interval(np.where((low <= 0) & (high >= 0), 1.0, result.low), result.high)


def select(
    condition: "Interval | float", chosen: "Interval | float", other: "Interval | float"
) -> Interval:
    """`chosen` where the condition is positive, `other` where it is negative, else both."""
    low, high = bounds_of(condition)
    (a, b), (c, d) = bounds_of(chosen), bounds_of(other)
    least = np.where(low > 0, a, np.where(high < 0, c, np.minimum(a, c)))
    return Interval(least, np.where(low > 0, b, np.where(high < 0, d, np.maximum(b, d))))


#: NumPy's names where they differ.
NAMES = {"atan": "arctan"}
#: Functions of generated code, by name.
FUNCTIONS: dict[str, Callable[[Any], Interval]] = {
    "sin": _sin,
    "cos": _cos,
    "tan": _tan,
    "cosh": _cosh,
    **{
        name: _increasing(getattr(np, NAMES.get(name, name)))
        for name in ("exp", "log", "sqrt", "sinh", "tanh", "atan")
    },
}
