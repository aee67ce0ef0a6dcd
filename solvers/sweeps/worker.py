"""A chunk of a sweep, computed in a thread, another process, or on another machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.integration.ensemble import ensemble
from solvers.integration.ensemble_run import StopFlag
from solvers.integration.ensemble_solution import Ensemble
from solvers.integration.predictability import ignore_predictability
from solvers.integration.solution import Status
from solvers.sweeps.initial_states import initial_states
from solvers.sweeps.job import CODES, Job, loaded
from solvers.sweeps.maps import Motions

Array: TypeAlias = NDArray[np.float64]


def run_chunk(
    job: Job, columns: Mapping[str, Array], stop: StopFlag | None = None
) -> NDArray[np.void]:
    """Integrate motions and compute their maps."""
    module = loaded(job.source)
    starts, params, status = initial_states(job, module, columns)
    chunk = np.zeros(len(status), job.dtype)
    for name in job.maps:
        chunk[name] = np.nan
    chunk["status"] = status
    for name in job.columns:
        chunk[name] = columns[name]
    runs = np.flatnonzero(status == 0)
    if len(runs):
        starts, params = starts[runs], [column[runs] for column in params]
        motions = integrated(job, module, starts, params, stop)
        first = 0
        for name, one in job.maps.items():
            events = slice(first, first + len(one.events(module)))
            first = events.stop
            chunk[name][runs] = one.values(Motions(module, starts, params, motions, events))
        for end, code in CODES.items():
            chunk["status"][runs[motions.status == end]] = code
        failed = runs[~motions.success]
        for name in job.maps:
            chunk[name][failed] = np.nan
    return chunk


def integrated(
    job: Job,
    module: GeneratedModule,
    starts: Array,
    params: list[Array],
    stop: StopFlag | None = None,
) -> Ensemble:
    """The motions, in one thread."""
    maps = job.maps.values()
    events = [event for one in maps for event in one.events(module)]
    events = [replace(event, terminal=job.ends_at_event) for event in events]
    times = np.linspace(0, job.duration, job.samples) if job.samples else None
    constants = np.stack(params) if params else ()
    occurrences = max(one.occurrences for one in maps)
    run = partial(ensemble, module, (0.0, job.duration), starts.T, constants, **job.options)
    with ignore_predictability():
        motions = run(workers=1, stop=stop, t_eval=times, events=events, occurrences=occurrences)
    if (motions.status == Status.INTERRUPTED).any():
        raise InterruptedError("the sweep was stopped")
    return motions
