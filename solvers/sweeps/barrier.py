"""Events that energy forbids: a motion that cannot climb to where one occurs need not be run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from solvers.equations.module import GeneratedModule

Array: TypeAlias = NDArray[np.float64]
Places: TypeAlias = Sequence[Mapping[str, float]]

#: Energies that differ by less than this part of them are not told apart.
ROUNDING = 1e-12
#: Lower places are looked for from so many starts, and count if they are lower by this part.
STARTS, LOWER = 16, 1e-9


def energies(module: GeneratedModule, state: Array, params: Sequence[Array]) -> Array:
    """Energies in J of states in rows, at the beginning."""
    zero = np.zeros(len(state))
    return np.asarray(module.energy_many(zero, state.T, params)) + zero


def barrier(module: GeneratedModule, places: Places, params: Sequence[Array], n: int) -> Array:
    """The energy in J of the lowest of some places at rest, for each of `n` motions."""
    tops = []
    for place in places:
        state = np.zeros((n, len(module.STATE)))
        for name, value in place.items():
            state[:, module.STATE.index(name)] = value
        tops.append(energies(module, state, params))
    return np.asarray(np.min(tops, axis=0))


def is_below(
    module: GeneratedModule, places: Places, state: Array, params: Sequence[Array]
) -> NDArray[np.bool_]:
    """Which states have less energy than the lowest of the places; rounding decides nothing."""
    top, own = barrier(module, places, params, len(state)), energies(module, state, params)
    return np.asarray(own < top - ROUNDING * (np.abs(top) + np.abs(own)))


def lower_place(
    module: GeneratedModule, watched: Mapping[str, Sequence[float]], places: Places,
    params: Sequence[float],
) -> dict[str, float]:  # fmt: skip
    """A place where a watched coordinate has its value, below all of `places`; empty if none is.

    It is looked for by descent from random places, with numbers that are always the same.

    Parameters
    ----------
    module : module
        A generated module.
    watched : mapping of str to sequence of float
        Values by coordinate, in rad or m.
    places : sequence of mapping of str to float
        Coordinates in rad or m; what is not named is 0.
    params : sequence of float
        In the order of ``module.PARAMETERS``.

    Returns
    -------
    dict of str to float
        All coordinates by name, in rad or m.
    """
    own = [np.array([p]) for p in params]
    top = float(barrier(module, places, own, 1)[0])
    random, n = np.random.default_rng(0), len(module.COORDINATES)
    for name, values in watched.items():
        k = module.COORDINATES.index(name)
        for value in values:

            def energy(rest: Array, k: int = k, value: float = value) -> float:
                state = np.zeros((1, 2 * n))
                state[0, :n] = np.insert(rest, k, value)
                return float(energies(module, state, own)[0])

            starts = [
                np.delete([place.get(q, 0.0) for q in module.COORDINATES], k) for place in places
            ]
            for start in (*starts, *random.uniform(-np.pi, np.pi, (STARTS, n - 1))):
                rest = minimize(energy, start).x if n > 1 else start
                if energy(rest) < top - LOWER * max(abs(top), 1.0):
                    place = np.insert(rest, k, value)
                    return dict(zip(module.COORDINATES, map(float, place), strict=True))
    return {}
