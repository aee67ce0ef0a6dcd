"""Where motions begin, and which of them need not be run."""

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


def begun(
    job: Job, module: GeneratedModule, columns: Mapping[str, Array]
) -> tuple[Array, list[Array], NDArray[np.int8]]:
    """Starts in rows, parameters, and the status of motions that need not be integrated, or 0."""
    n = len(next(iter(columns.values())))
    whole = {**job.values, **columns}
    free = next((name for name, value in job.values.items() if value == FROM_ENERGY), None)
    defaults = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))

    def column(name: str, usual: float) -> Array:
        value = 0.0 if name == free else whole.get(name, usual)
        return np.broadcast_to(np.asarray(value, float), n).copy()

    params = [column(name, defaults[name]) for name in module.PARAMETERS]
    state = np.stack([column(name, 0.0) for name in module.STATE], axis=1)
    status = np.zeros(n, np.int8)
    if free is not None:
        place = module.STATE.index(free)
        state[:, place] = rate(module, state, params, place, column(ENERGY, 0.0))
        status[np.isnan(state[:, place])] = NO_SUCH_ENERGY
        state[status != 0, place] = 0.0
    if job.only_first and job.only_first.barrier:
        low = is_below(module, job.only_first.barrier, state, params)
        status[(status == 0) & low] = PROVED
    if job.form == "variational":
        size = len(module.STATE)
        state = np.hstack([state, np.full((n, size), size**-0.5)])
    return state, params, status


def rate(
    module: GeneratedModule, state: Array, params: list[Array], place: int, energy: Array
) -> Array:
    """The velocity of 0 or more with which states have an energy; NaN where there is none.

    The energy is a polynomial of the second degree in the velocity.

    Parameters
    ----------
    module : module
        A generated module.
    state : ndarray of shape (n, state)
        States, in which this velocity may be anything.
    params : list of ndarray of shape (n,)
        In the order of ``module.PARAMETERS``.
    place : int
        Which component of the state it is.
    energy : ndarray of shape (n,)
        In J.

    Returns
    -------
    ndarray of shape (n,)
        In rad/s or m/s.
    """
    at = {}
    for value in (-1.0, 0.0, 1.0):
        there = state.copy()
        there[:, place] = value
        at[value] = energies(module, there, params)
    a, b = (at[1.0] + at[-1.0]) / 2 - at[0.0], (at[1.0] - at[-1.0]) / 2
    with np.errstate(invalid="ignore"):
        root = np.sqrt(b * b - 4 * a * (at[0.0] - energy))
    found = (root - b) / (2 * a)
    return np.where(found >= 0, found, np.nan)
