"""What varies from motion to motion: a grid, random numbers, or a table; any part of it at once."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from solvers.integration import validation

Array: TypeAlias = NDArray[np.float64]

#: Random numbers are drawn so many motions at a time, so that any part can be drawn by itself.
BLOCK = 4096


@dataclass(frozen=True)
class _Listed:
    """Values that are listed by name."""

    values: Mapping[str, Array]

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", _columns(self.values))

    @property
    def smallest(self) -> dict[str, float]:
        """The smallest value of each."""
        return {name: float(values.min()) for name, values in self.values.items()}

    @property
    def asked(self) -> dict[str, Any]:
        """What it is, for a manifest."""
        axes = [_described(name, values) for name, values in self.values.items()]
        return {"kind": type(self).__name__.lower(), "axes": axes}


@dataclass(frozen=True)
class Grid(_Listed):
    """Every combination of the values on some axes; the last one varies fastest.

    Parameters
    ----------
    values : mapping of str to array_like of shape (count,)
        Values in the unit of the coordinate, velocity or parameter of this name; or of the
        energy in J.

    Raises
    ------
    ValueError
        When there is no axis, one has no values or some that are not finite, or there are more
        than 2**53 combinations.

    Examples
    --------
    >>> grid = Grid({"theta1": [0.0, 0.1, 0.2], "m2": [1.0, 2.0]})
    >>> grid.shape
    (3, 2)
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        validation.count("the number of motions", prod(self.shape), 1)

    @property
    def shape(self) -> tuple[int, ...]:
        """How many values each axis has."""
        return tuple(map(len, self.values.values()))

    def columns(self, begin: int, end: int) -> dict[str, Array]:
        """The values of the motions from `begin` on, before `end`, by name."""
        places = np.unravel_index(np.arange(begin, end), self.shape)
        return {
            name: values[k] for (name, values), k in zip(self.values.items(), places, strict=True)
        }


@dataclass(frozen=True)
class Table(_Listed):
    """One motion for each row of a table.

    Parameters
    ----------
    values : mapping of str to array_like
        Columns of equal length, in units as those of `Grid`.

    Raises
    ------
    ValueError
        When columns differ in length, or have values that are not finite.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        lengths = {name: len(column) for name, column in self.values.items()}
        if len({*lengths.values()}) > 1:
            raise ValueError(f"columns of a table have different lengths: {lengths}")

    @property
    def shape(self) -> tuple[int, ...]:
        """How many rows there are."""
        return (len(next(iter(self.values.values()))),)

    def columns(self, begin: int, end: int) -> dict[str, Array]:
        """The values of the motions from `begin` on, before `end`, by name."""
        return {name: column[begin:end] for name, column in self.values.items()}


@dataclass(frozen=True)
class Random:
    """Values that are drawn evenly between two limits each.

    Parameters
    ----------
    limits : mapping of str to pair of float
        Smallest and largest value, in units as those of `Grid`.
    count, seed : int
        How many motions, and where the random numbers begin.

    Raises
    ------
    ValueError
        When a number makes no sense.
    """

    limits: Mapping[str, tuple[float, float]]
    count: int
    seed: int

    def __post_init__(self) -> None:
        validation.count("count", self.count, 1)
        validation.count("seed", self.seed, 0)
        limits = {name: (float(low), float(high)) for name, (low, high) in self.limits.items()}
        _columns(limits)
        object.__setattr__(self, "limits", limits)

    @property
    def shape(self) -> tuple[int, ...]:
        """How many motions there are."""
        return (self.count,)

    def columns(self, begin: int, end: int) -> dict[str, Array]:
        """The values of the motions from `begin` on, before `end`, by name."""
        first = begin // BLOCK
        drawn = np.concatenate([
            np.random.default_rng([self.seed, block]).random((BLOCK, len(self.limits)))
            for block in range(first, max(end - 1, begin) // BLOCK + 1)
        ])[begin - first * BLOCK : end - first * BLOCK]  # fmt: skip
        return {
            name: low + (high - low) * column
            for (name, (low, high)), column in zip(self.limits.items(), drawn.T, strict=True)
        }

    @property
    def smallest(self) -> dict[str, float]:
        """The smallest value of each."""
        return {name: min(ends) for name, ends in self.limits.items()}

    @property
    def asked(self) -> dict[str, Any]:
        """What it is, for a manifest."""
        axes = [
            {"name": name, "from": low, "to": high} for name, (low, high) in self.limits.items()
        ]
        return {"kind": "random", "axes": axes, "count": self.count, "seed": self.seed}


Axes: TypeAlias = Grid | Table | Random


def motions(axes: Axes) -> int:
    """How many motions there are."""
    return prod(axes.shape)


def some(axes: Axes, count: int) -> dict[str, Array]:
    """The values of about so many motions from all over a sweep, always the same."""
    places = np.unique(np.random.default_rng(0).integers(0, motions(axes), count))
    rows = [axes.columns(place, place + 1) for place in places]
    return {name: np.concatenate([row[name] for row in rows]) for name in rows[0]}


def _columns(values: Mapping[str, Any]) -> dict[str, Array]:
    if not values:
        raise ValueError("nothing varies: name at least one coordinate, velocity or parameter")
    columns = {name: np.array(column, float, ndmin=1) for name, column in values.items()}
    for name, column in columns.items():
        if column.ndim != 1 or not len(column) or not np.isfinite(column).all():
            raise ValueError(f"{name} must be a list of finite numbers, one at least")
    return columns


def _described(name: str, values: Array) -> dict[str, Any]:
    digest = hashlib.sha256(np.ascontiguousarray(values, "<f8").tobytes()).hexdigest()
    return {
        "name": name, "count": len(values), "first": float(values[0]), "last": float(values[-1]),
        "sha256": digest,
    }  # fmt: skip
