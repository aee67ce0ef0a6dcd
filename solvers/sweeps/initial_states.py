"""Initial states, and motions that need no integration."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.sweeps.barrier import energies, is_below
from solvers.sweeps.checks import ENERGY, FROM_ENERGY
from solvers.sweeps.job import NO_SUCH_ENERGY, PROVED, Job

Array: TypeAlias = NDArray[np.float64]


def initial_states(
    job: Job, module: GeneratedModule, columns: Mapping[str, Array]
) -> tuple[Array, list[Array], NDArray[np.int8]]:
    """States in rows, parameters, and the status of motions that are not integrated, else 0."""
    n = len(next(iter(columns.values())))
    given = {**job.values, **columns}
    free = next((name for name, value in job.values.items() if value == FROM_ENERGY), None)
    defaults = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))

    def column(name: str, default: float) -> Array:
        value = 0.0 if name == free else given.get(name, default)
        return np.broadcast_to(np.asarray(value, float), n).copy()

    params = [column(name, defaults[name]) for name in module.PARAMETERS]
    state = np.stack([column(name, 0.0) for name in module.STATE], axis=1)
    status = np.zeros(n, np.int8)
    if free is not None:
        index = module.STATE.index(free)
        state[:, index] = velocity(module, state, params, index, column(ENERGY, 0.0))
        status[np.isnan(state[:, index])] = NO_SUCH_ENERGY
        state[status != 0, index] = 0.0
    if job.barrier:
        status[(status == 0) & is_below(module, job.barrier, state, params)] = PROVED
    if job.options["form"] == "variational":
        size = len(module.STATE)
        state = np.hstack([state, np.full((n, size), size**-0.5)])
    return state, params, status


def velocity(
    module: GeneratedModule, state: Array, params: list[Array], index: int, energy: Array
) -> Array:
    """The velocity of 0 or more that gives states an energy; NaN where there is none."""
    at = {}
    for value in (-1.0, 0.0, 1.0):
        trial = state.copy()
        trial[:, index] = value
        at[value] = energies(module, trial, params)
    a, b = (at[1.0] + at[-1.0]) / 2 - at[0.0], (at[1.0] - at[-1.0]) / 2
    with np.errstate(invalid="ignore"):
        root = np.sqrt(b * b - 4 * a * (at[0.0] - energy))
    larger = (root - b) / (2 * a)
    return np.where(larger >= 0, larger, np.nan)
