"""Continuation: motions along an axis, each of which starts where its neighbour ended."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from solvers.integration.loops.stop_flag import StopFlag
from solvers.integration.problem.status import Status
from solvers.integration.results.ensemble_solution import Ensemble
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.chunk_motions import integrate_all
from solvers.sweeps.execution.initial_states import initial_states
from solvers.sweeps.maps import Motions
from solvers.sweeps.results import CODES


def continued(
    sweep: Sweep, columns: Mapping[str, Array], stop: StopFlag | None = None
) -> tuple[NDArray[np.void], list[Ensemble]]:
    """A chunk of whole branches, each followed upwards and downwards, and the motions.

    All branches move together from value to value. Every motion is integrated from t = 0, so that
    the drive, whose period is that of the map, has the same phase at its start and at its end.
    """
    ((name, one),) = sweep.maps.items()
    module, sampling = sweep.module, one.sampling
    assert sampling is not None
    starts, params, _ = initial_states(sweep, columns)
    chunk = np.zeros(len(starts), sweep.dtype)
    chunk[name] = np.nan
    branches = _branches(columns, one.continued_along)
    state, codes = starts[branches[:, 0]], np.full(len(branches), CODES[Status.FINISHED])
    ensembles = []
    for k in range(branches.shape[1]):
        here = np.flatnonzero(branches[:, k] >= 0)
        alive = here[codes[here] == CODES[Status.FINISHED]]
        if len(alive):
            motions = branches[alive, k]
            own = [column[motions] for column in params]
            times = sampling.times(module, own)
            options = sweep.options
            before = integrate_all(sweep, (0.0, times[:, 0]), state[alive], own, stop, options)
            begins = np.where(before.success, before.y, state[alive].T).T
            duration = times[:, -1] - times[:, 0]
            options |= {"events": one.events(module), "occurrences": one.occurrences}
            if one.sample_count:
                options["t_eval"] = times - times[:, :1]
            after = integrate_all(sweep, (0.0, duration), begins, own, stop, options)
            ensembles += [before, after]
            ends = np.where(before.success, after.status, before.status)
            codes[alive] = [CODES[end] for end in ends]
            good = codes[alive] == CODES[Status.FINISHED]
            values = one.values(Motions(module, 0.0, begins, own, after, slice(None)))
            chunk[name][motions[good], ..., alive[good] % 2] = values[good]
            state[alive] = after.y.T
        status = chunk["status"]  # that of a failure in one direction, if any
        np.maximum.at(status, branches[here, k], codes[here].astype(status.dtype))
    return chunk, ensembles


def _branches(columns: Mapping[str, Array], along: str) -> NDArray[np.intp]:
    """Indices of motions: a row for each branch upwards and one downwards, then -1 if shorter.

    Neighbours with equal values of all other quantities are on one branch.
    """
    others = [column for name, column in columns.items() if name != along]
    n = len(columns[along])
    differ = [np.flatnonzero(np.diff(column)) + 1 for column in others]
    bounds = np.unique(np.concatenate([[0, n], *differ]).astype(int))
    branches = [np.arange(*ends) for ends in pairwise(bounds)]
    rows = np.full((2 * len(branches), max(map(len, branches))), -1)
    for k, branch in enumerate(branches):
        up = branch[np.argsort(columns[along][branch], kind="stable")]
        rows[2 * k, : len(up)], rows[2 * k + 1, : len(up)] = up, up[::-1]
    return rows
