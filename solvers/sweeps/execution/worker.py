"""Chunks of a sweep: their length, and their computation in a thread or on another machine.

In a continuation along an axis, each motion starts where its neighbour ended.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.equations.singularities import checked_before
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.ensemble import ensemble
from solvers.integration.problem.status import Status, StopFlag
from solvers.integration.results.ensemble_solution import Ensemble
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.initial_states import initial_states
from solvers.sweeps.maps import Motions
from solvers.sweeps.results import CODES


def after_transient(
    sweep: Sweep, starts: Array, params: list[Array], stop: StopFlag | None
) -> tuple[Array, Ensemble]:
    """States at `sweep.skip`, and the motions up to there; those that fail keep their start."""
    module, form = sweep.module, sweep.unchecked(maps={}).form
    n = len(module.STATE)
    options = sweep.options | {"form": form}
    span = 0.0, sweep.skip
    motions = integrate_all(sweep, span, starts[:, :n], params, stop, options)
    return np.hstack([np.where(motions.success, motions.y, starts.T[:n]).T, starts[:, n:]]), motions


def integrated(
    sweep: Sweep, starts: Array, params: list[Array], stop: StopFlag | None = None
) -> Ensemble:
    """The motions after `sweep.skip`, in one thread."""
    maps = sweep.maps.values()
    events = [(event, one.skip) for one in maps for event in one.events(sweep.module)]
    ends, samples = sweep.times(params)
    options = sweep.options | {
        "events": [replace(event, terminal=sweep.ends_at_event) for event, _ in events],
        "skip": [skip for _, skip in events],
        "occurrences": max(one.occurrences for one in maps),
        "t_eval": samples if samples.size else None,
    }
    return integrate_all(sweep, (sweep.skip, ends), starts, params, stop, options)


def integrate_all(
    sweep: Sweep,
    span: tuple[float, float | Array],
    starts: Array,
    params: list[Array],
    stop: StopFlag | None,
    options: Mapping[str, Any],
) -> Ensemble:
    """Motions with these options, in one thread; `InterruptedError` once `stop` is set."""
    constants = np.stack(params) if params else ()
    with ignore_predictability(), checked_before():
        motions = ensemble(sweep.module, span, starts.T, constants, workers=1, stop=stop, **options)
    if (motions.status == Status.INTERRUPTED).any():
        raise InterruptedError("the sweep was stopped")
    return motions


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


#: Longest duration of a chunk in s, approximately, and its overhead.
CHUNK, COST = 1.0, 0.004
#: Seconds for each evaluation of a right-hand side of n components: this times n^1.5.
EVALUATION = 0.25e-9
#: Largest number of bytes for the states of a chunk; its working memory is about ten times as much.
MAX_BYTES = 8e6


def run_chunk(
    sweep: Sweep, columns: Mapping[str, Array], stop: StopFlag | None = None
) -> NDArray[np.void]:
    """Integrate motions and compute their maps; NaN for motions that fail."""
    return computed(sweep, columns, stop)[0]


def computed(
    sweep: Sweep, columns: Mapping[str, Array], stop: StopFlag | None = None
) -> tuple[NDArray[np.void], list[Ensemble]]:
    """A chunk with the maps of all motions, and the motions that were integrated."""
    if sweep.continued_along:
        return continued(sweep, columns, stop)
    module, maps = sweep.module, sweep.maps
    starts, params, status = initial_states(sweep, columns)
    chunk = np.zeros(len(status), sweep.dtype)
    for name in sweep.dtype.names or ():
        chunk[name] = status if name == "status" else columns.get(name, np.nan)
    runs = np.flatnonzero(status == 0)
    ensembles = []
    if len(runs):
        starts, params = starts[runs], [column[runs] for column in params]
        if sweep.skip:
            starts, transient = after_transient(sweep, starts, params, stop)
            ensembles.append(transient)
        motions = integrated(sweep, starts, params, stop)
        ensembles.append(motions)
        first = 0
        for name, one in maps.items():
            events = slice(first, first + len(one.events(module)))
            first = events.stop
            chunk[name][runs] = one.values(
                Motions(module, sweep.skip, starts, params, motions, events, sweep.rtol)
            )
        ends, success = motions.status, motions.success
        for transient in ensembles[:-1]:
            ends = np.where(transient.success, ends, transient.status)
            success &= transient.success
        for end, code in CODES.items():
            chunk["status"][runs[ends == end]] = code
        for name in maps:
            chunk[name][runs[~success]] = np.nan
    return chunk, ensembles


def mean_evaluations(sweep: Sweep, columns: Mapping[str, Array]) -> float:
    """Mean number of evaluations of the right-hand side for each of some motions."""
    chunk, ensembles = computed(sweep, columns)
    return (1 + sum(int(motions.nfev.sum()) for motions in ensembles)) / len(chunk)


def chunk_length(sweep: Sweep, evaluations: float) -> int:
    """Number of motions in a chunk: about a second of work, less in short sweeps.

    `evaluations` is the mean number for each motion.
    """
    # in short sweeps chunks cost as much as waiting for the last of them; time follows from the
    # number of evaluations, not from the clock, so that a sweep is always divided in the same way
    size = len(sweep.module.STATE) * (2 if sweep.form == "variational" else 1)
    each = evaluations * EVALUATION * size**1.5
    events = sum(one.occurrences * len(one.events(sweep.module)) for one in sweep.maps.values())
    most = MAX_BYTES / (8 * size * (1 + sweep.samples + events))
    seconds = min(CHUNK, (COST * each * sweep.motions) ** 0.5)
    length = max(1, int(min(seconds / each, most)))
    return -(-length // sweep.branch_length) * sweep.branch_length
