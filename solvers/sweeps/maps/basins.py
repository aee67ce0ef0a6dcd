"""Basins of attraction, and attractors: equilibria and periodic orbits that motions approach."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, depends_on_time
from solvers.equations.number_checks import positive
from solvers.equations.signature_checks import checked
from solvers.sweeps.definition.axes import Array, Axes
from solvers.sweeps.definition.map_table import MapTable
from solvers.sweeps.definition.sampling import Sampling
from solvers.sweeps.maps import Map, Motions

#: Part of the tolerance within which states must recur for a motion to have arrived.
ARRIVED = 0.1


@dataclass(frozen=True)
class Attractor:
    """An equilibrium, or a periodic orbit at multiples of a period.

    Attributes
    ----------
    period : int
        Number of periods after which states recur.
    states : ndarray of shape (period, state)
        The states; angles are between -π and π.
    turns : tuple of int
        Whole turns of each coordinate in this time.
    motions : int
        Number of motions that approach it.
    """

    period: int
    states: Array
    turns: tuple[int, ...]
    motions: int

    def record(self, number: int, module: GeneratedModule) -> dict[str, Any]:
        """The attractor as JSON values, with its number in the map."""
        is_equilibrium = self.period == 1 and not any(self.turns) and not depends_on_time(module)
        return {
            "number": number,
            "kind": "equilibrium" if is_equilibrium else f"period {self.period}",
            "turns": dict(zip(module.COORDINATES, self.turns, strict=True)),
            "motions": self.motions,
            "states": [dict(zip(module.STATE, y, strict=True)) for y in self.states.tolist()],
        }


def classify(
    module: GeneratedModule, states: Array, tolerance: float
) -> tuple[Array, list[Attractor]]:
    """The number of the attractor of each motion, from 1, and all attractors, the commonest first.

    `states`, of shape (motions, state, count), are taken at multiples of a period; the number is 0
    where they do not recur, and NaN where they are unknown.
    """
    known = np.asarray(np.isfinite(states).all(axis=(1, 2)))
    numbers = np.where(known, 0.0, np.nan)
    periods, recurrence = _periods(module, states, known, tolerance)
    groups: list[tuple[NDArray[np.intp], int, Array]] = []
    for period in range(1, states.shape[2] // 2 + 1):
        members = np.flatnonzero(periods == period)
        members = members[np.argsort(recurrence[members], kind="stable")]
        orbits = states[:, :, -period:]
        while len(members):
            reference = orbits[members[0]]  # of the motion that is nearest to its end
            near = _distance(module, orbits[members], reference) <= tolerance
            groups.append((members[near], period, states[members[0]]))
            members = members[~near]
    groups.sort(key=lambda group: (-len(group[0]), group[1], group[0].min()))
    for number, (members, _, _) in enumerate(groups, 1):
        numbers[members] = number
    return numbers, [_attractor(module, *group) for group in groups]


def _periods(
    module: GeneratedModule, states: Array, known: NDArray[np.bool_], tolerance: float
) -> tuple[NDArray[np.int64], Array]:
    """Periods after which states recur, 0 if they do not, and their largest change in a period."""
    periods, recurrence = np.zeros(len(states), np.int64), np.full(len(states), np.inf)
    changes: list[Array] = []
    for period in range(1, states.shape[2] // 2 + 1):
        moves = _difference(module, states[..., period:], states[..., :-period])
        changes.append(np.where(known, np.abs(moves).max(axis=(1, 2)), np.inf))
        arrived = (periods == 0) & (changes[-1] <= ARRIVED * tolerance)
        recurrence[arrived] = changes[-1][arrived]
        # on a spiral, states may return to themselves after several turns before they stop
        for divisor in (d for d in range(1, period + 1) if period % d == 0):
            periods[arrived & (periods == 0) & (changes[divisor - 1] <= tolerance)] = divisor
    return periods, recurrence


def _difference(module: GeneratedModule, x: Array, y: Array) -> Array:
    """Differences of states, components along the second axis; those of angles modulo 2π."""
    change = x - y
    for k, name in enumerate(module.COORDINATES):
        if module.UNITS[name] == "rad":
            change[:, k] = np.remainder(change[:, k] + np.pi, 2 * np.pi) - np.pi
    return change


def _distance(module: GeneratedModule, orbits: Array, reference: Array) -> Array:
    """Largest difference of orbits from one, at the best of all shifts by whole periods."""
    shifted = (np.roll(reference, k, axis=1) for k in range(reference.shape[1]))
    return np.min(
        [np.abs(_difference(module, orbits, one)).max(axis=(1, 2)) for one in shifted], axis=0
    )


def _attractor(
    module: GeneratedModule, members: NDArray[np.intp], period: int, states: Array
) -> Attractor:
    """The attractor of a motion with these states."""
    turns = [
        round((states[k, -1] - states[k, -1 - period]) / (2 * np.pi))
        if module.UNITS[name] == "rad" else 0
        for k, name in enumerate(module.COORDINATES)
    ]  # fmt: skip
    orbit = states[np.newaxis, :, -period:]
    orbit = _difference(module, orbit, np.zeros_like(orbit))[0]
    return Attractor(period, orbit.T.copy(), tuple(turns), len(members))


@checked
@dataclass(frozen=True)
class Basins(Map):
    """Basins of attraction: the number of the attractor that a motion approaches, 0 if none.

    Attractors are equilibria and periodic orbits: the state recurs after 1, 2, … times the period
    `every`, up to half of `count` times, after `skip` periods. Without a drive any time is a period
    of equilibria. States that differ by less than `tolerance` in each component, in SI units and
    radians modulo 2π, are the same. The file `NAME_attractors.json` lists the attractors.

    Parameters
    ----------
    every : str or float
        Period in s, or a formula of parameters.
    skip : int
        Number of periods before the states that are compared.
    count : int
        Number of these states.
    tolerance : float
        Largest difference of equal states.

    Examples
    --------
    >>> Basins("2*pi/Omega", skip=200).shape
    ()
    """

    every: str | float
    skip: int = 0
    count: int = 16
    tolerance: float = 1e-3

    example = 'every = "2*pi/Omega", skip = 200, count = 16, tolerance = 1e-3'
    quantity = "attractor"
    records = "attractors"

    @classmethod
    def read(cls, table: MapTable) -> Self:
        tolerance = table.number("tolerance", "1", cls.tolerance)
        return cls(
            table.period("every"), table.count("skip"), table.count("count", cls.count), tolerance
        )

    @property
    def sample_count(self) -> int:
        return self.count

    @property
    def sampling(self) -> Sampling:
        return Sampling(self.every, self.count, skip=self.skip)

    def stored_shape(self, module: GeneratedModule) -> tuple[int, ...]:
        return len(module.STATE), self.count

    def check(self, module: GeneratedModule, axes: Axes, values: Mapping[str, float | str]) -> None:
        super().check(module, axes, values)
        positive("tolerance", self.tolerance)
        if self.count < 2:
            raise ValueError(f"count = {self.count} must be 2 or more, to compare states")

    def values(self, motions: Motions) -> Array:
        return np.swapaxes(motions.ensemble.samples, 0, 1)

    def finish(self, module: GeneratedModule, stored: Array) -> tuple[Array, list[dict[str, Any]]]:
        numbers, attractors = classify(module, stored, self.tolerance)
        return numbers, [one.record(k, module) for k, one in enumerate(attractors, 1)]
