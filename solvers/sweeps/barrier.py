"""Energy barriers: a motion with less energy than a barrier cannot cross it."""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np
import scipy
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.sweeps.definition.axes import Array

Positions: TypeAlias = Sequence[Mapping[str, float]]

#: Energies are equal if their relative difference is smaller.
ROUNDING = 1e-12
#: Starts of the search for lower positions, and the relative difference of energy that counts.
STARTS, LOWER = 16, 1e-9


def energies(module: GeneratedModule, state: Array, params: Sequence[Array]) -> Array:
    """Energies in J of states in rows, at the start."""
    zero = np.zeros(len(state))
    return np.asarray(module.energy_many(zero, state.T, params)) + zero


def barrier(
    module: GeneratedModule, positions: Positions, params: Sequence[Array], n: int
) -> Array:
    """The energy in J of the lowest of some positions at rest, for each of `n` motions."""
    tops = []
    for position in positions:
        state = np.zeros((n, len(module.STATE)))
        for name, value in position.items():
            state[:, module.STATE.index(name)] = value
        tops.append(energies(module, state, params))
    return np.asarray(np.min(tops, axis=0))


def is_below(
    module: GeneratedModule, positions: Positions, state: Array, params: Sequence[Array]
) -> NDArray[np.bool_]:
    """Whether states have less energy than the lowest of the positions, by more than rounding."""
    top, own = barrier(module, positions, params, len(state)), energies(module, state, params)
    return np.asarray(own < top - ROUNDING * (np.abs(top) + np.abs(own)))


def lower_position(
    module: GeneratedModule,
    watched: Mapping[str, Sequence[float]],
    positions: Positions,
    params: Sequence[float],
) -> dict[str, float]:
    """A position below all of `positions` with a watched coordinate at its value, or no entry."""
    own = [np.array([p]) for p in params]
    top = float(barrier(module, positions, own, 1)[0])
    random, n = np.random.default_rng(0), len(module.COORDINATES)
    for name, values in watched.items():
        k = module.COORDINATES.index(name)
        for value in values:

            def energy(others: Array, k: int = k, value: float = value) -> float:
                state = np.zeros((1, 2 * n))
                state[0, :n] = np.insert(others, k, value)
                return float(energies(module, state, own)[0])

            starts = [np.delete([p.get(q, 0.0) for q in module.COORDINATES], k) for p in positions]
            for start in (*starts, *random.uniform(-np.pi, np.pi, (STARTS, n - 1))):
                others = scipy.optimize.minimize(energy, start).x if n > 1 else start
                if energy(others) < top - LOWER * max(abs(top), 1.0):
                    position = np.insert(others, k, value)
                    return dict(zip(module.COORDINATES, map(float, position), strict=True))
    return {}
