"""What a model of a motion is asked, and what it answers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule

Array = NDArray[np.float64]

#: Relative rounding of a number.
EPS = float(np.finfo(float).eps)
#: In so many places of a closed form a number is rounded.
ROUNDINGS = 32
#: So often an error is looked at, at times that follow the golden ratio.
LOOKS, GOLDEN = 128, (5**0.5 - 1) / 2


class OutsideDomainError(ValueError):
    """A model says nothing about this motion; the message says why."""


@dataclass(frozen=True)
class Motion:
    """A motion, and what is wanted of it.

    Attributes
    ----------
    module : module
        A generated module.
    params, y0 : tuple of float
        In the order of ``module.PARAMETERS`` and ``module.STATE``.
    duration : float
        In s.
    wanted : tuple of int
        Which components of the state.
    """

    module: GeneratedModule
    params: tuple[float, ...]
    y0: tuple[float, ...]
    duration: float
    wanted: tuple[int, ...]

    @property
    def coordinates(self) -> int:
        """How many there are."""
        return len(self.module.COORDINATES)

    @cached_property
    def alive(self) -> tuple[int, ...]:
        """Coordinates that move mass; others are there in name only, where something is absent."""
        n = self.coordinates
        places = np.random.default_rng(0).uniform(0.1, 3.0, (n, 8))
        row = np.abs(self.module.mass_matrix_many(0.0, np.vstack([places, places]), self.params))
        return tuple(k for k in range(n) if row[k].max() > 0)

    def require_mass(self) -> None:
        """Refuse to go on where a coordinate moves no mass.

        Raises
        ------
        OutsideDomainError
            Its message names the coordinates.
        """
        idle = [q for k, q in enumerate(self.module.COORDINATES) if k not in self.alive]
        if idle:
            raise OutsideDomainError(f"{', '.join(idle)} moves no mass")

    @property
    def looks(self) -> Array:
        """Times at which errors are looked at: in step with no period, and at both ends."""
        return self.duration * np.unique([*scattered(LOOKS), 1.0])


def scattered(count: int) -> Array:
    """So many parts of 1, 0 among them, evenly scattered and in step with nothing."""
    return np.modf(GOLDEN * np.arange(count))[0]


class Model(Protocol):
    """A motion in closed form, or as good as that.

    Attributes
    ----------
    name : str
        What to call it.
    why : str
        Why it may be used here.
    error_estimate : float
        Largest error of any wanted component at any time, in rad, m, rad/s or m/s.
    """

    @property
    def name(self) -> str: ...  # noqa: D102

    @property
    def why(self) -> str: ...  # noqa: D102

    @property
    def error_estimate(self) -> float: ...  # noqa: D102

    def states(self, t: Array) -> Array:
        """Coordinates and velocities at times from 0 on, shape (n, state)."""
        ...


def rounding_error(
    states: Callable[[Array], Array], y0: Sequence[float], sizes: Sequence[float]
) -> Array:
    """What rounding does to a motion in closed form: so much as changes of its start of that size.

    Parameters
    ----------
    states : callable
        Takes an initial state, returns states at some times, shape (n, state).
    y0 : sequence of float
        The initial state.
    sizes : sequence of float
        For each component the size of what is rounded.

    Returns
    -------
    ndarray of shape (n, state)
    """
    start = np.array(y0, dtype=float)
    found = states(start)
    total = ROUNDINGS * EPS * np.abs(found)
    for k, size in enumerate(sizes):
        # as far as rounding goes and no farther: near a separatrix nothing is linear
        total += np.abs(states(start + ROUNDINGS * EPS * size * np.eye(len(start))[k]) - found)
    return total
