"""Attractors: equilibria and periodic orbits that motions approach, from states at equal times."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, depends_on_time
from solvers.sweeps.definition.axes import Array

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
