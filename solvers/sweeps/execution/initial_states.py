"""Initial states, and motions that need no integration."""

from collections.abc import Callable, Mapping, Set
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from solvers.equations.assembly import Assembly
from solvers.equations.consistent_start import guesses
from solvers.equations.module import GeneratedModule, has_constraints
from solvers.sweeps.barrier import energies, is_below
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.definition.sweep_checks import ENERGY, FROM_ENERGY
from solvers.sweeps.results import NO_CONFIGURATION, NO_SUCH_ENERGY, PROVED

#: Completes states in rows, and returns whether each satisfies the constraints.
Completion: TypeAlias = Callable[[Array], tuple[Array, NDArray[np.bool_]]]


def initial_states(
    sweep: Sweep, columns: Mapping[str, Array]
) -> tuple[Array, list[Array], NDArray[np.int8]]:
    """States in rows, parameters, and the status of motions that are not integrated, else 0."""
    module, n = sweep.module, len(next(iter(columns.values())))
    free = [name for name, value in sweep.values.items() if value == FROM_ENERGY]  # one at most
    defaults = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
    start = guesses(module) if has_constraints(module) else {}
    given = {**defaults, **start, **sweep.values, **columns, **dict.fromkeys(free, 0.0)}

    def column(name: str) -> Array:
        return np.broadcast_to(np.asarray(given.get(name, 0.0), float), n).copy()

    params = [column(name) for name in module.PARAMETERS]
    state = np.stack([column(name) for name in module.STATE], axis=1)
    status = np.zeros(n, np.int8)
    complete = _completion(module, params, {*sweep.values, *columns})
    for index in map(module.STATE.index, free):
        state[:, index] = _velocity(module, state, params, index, column(ENERGY), complete)
        status[np.isnan(state[:, index])] = NO_SUCH_ENERGY
        state[status != 0, index] = 0.0
    state, result = complete(state)
    status[~result] = NO_CONFIGURATION
    if sweep.barrier:
        status[(status == 0) & is_below(module, sweep.barrier, state, params)] = PROVED
    if sweep.form == "variational":
        size = len(module.STATE)
        state = np.hstack([state, np.full((n, size), size**-0.5)])
    return state, params, status


def _completion(module: GeneratedModule, params: list[Array], given: Set[str]) -> Completion:
    """A function that completes states by the constraints, if the system has any."""
    if not has_constraints(module):
        return lambda state: (state, np.ones(len(state), bool))
    assembly = Assembly(module, np.stack(params, axis=1))
    are_given = np.array([name in given for name in module.STATE])
    return lambda state: assembly.assembled(state, are_given)


def _velocity(
    module: GeneratedModule,
    state: Array,
    params: list[Array],
    index: int,
    energy: Array,
    complete: Completion,
) -> Array:
    """The velocity of 0 or more that gives states an energy; NaN where there is none."""
    at = {}
    for value in (-1.0, 0.0, 1.0):
        trial = state.copy()
        trial[:, index] = value
        at[value] = energies(module, complete(trial)[0], params)
    a, b = (at[1.0] + at[-1.0]) / 2 - at[0.0], (at[1.0] - at[-1.0]) / 2
    with np.errstate(invalid="ignore"):
        root = np.sqrt(b * b - 4 * a * (at[0.0] - energy))
    larger = (root - b) / (2 * a)
    return np.where(larger >= 0, larger, np.nan)
