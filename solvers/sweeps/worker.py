"""A part of a sweep, done anywhere: in a thread, another process, or on another machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.integration.ensemble import ensemble
from solvers.integration.predictability import ignore_predictability
from solvers.integration.solution import Ensemble, Status
from solvers.sweeps.initial_states import begun
from solvers.sweeps.job import CODES, Job, loaded
from solvers.sweeps.map import Found, Map

Array: TypeAlias = NDArray[np.float64]


def work(job: Job, columns: Mapping[str, Array]) -> NDArray[np.void]:
    """Integrate the motions whose varying values are `columns`, and keep what is asked.

    Parameters
    ----------
    job : Job
        What is done with each.
    columns : mapping of str to ndarray of shape (n,)
        What varies, in the unit of the coordinate, velocity or parameter, or of the energy in J.

    Returns
    -------
    structured ndarray of shape (n,)
        With the fields of ``job.dtype``.

    Raises
    ------
    InterruptedError
        When `solvers.integration.ensemble.stop` was called meanwhile.
    """
    module = loaded(job.source)
    starts, params, status = begun(job, module, columns)
    kept = np.zeros(len(status), job.dtype)
    for name in job.maps:
        kept[name] = np.nan
    kept["status"] = status
    for name in job.columns:
        kept[name] = columns[name]
    there = np.flatnonzero(status == 0)
    if len(there):
        own = [column[there] for column in params]
        motions = integrated(job, module, starts[there], own)
        for name, one, events in watched(job, module):
            kept[name][there] = one.values(Found(module, starts[there], own, motions, events))
        for ended, code in CODES.items():
            kept["status"][there[motions.status == ended]] = code
        failed = there[~motions.success]
        for name in job.maps:
            kept[name][failed] = np.nan
    return kept


def watched(job: Job, module: GeneratedModule) -> list[tuple[str, Map, slice]]:
    """The maps, with their names and which of all events are theirs."""
    found, first = [], 0
    for name, one in job.maps.items():
        count = len(one.events(module))
        found.append((name, one, slice(first, first + count)))
        first += count
    return found


def integrated(job: Job, module: GeneratedModule, starts: Array, params: list[Array]) -> Ensemble:
    """The motions, in one thread."""
    maps = job.maps.values()
    is_over = job.only_first is not None
    events = [replace(event, terminal=is_over) for one in maps for event in one.events(module)]
    with ignore_predictability():
        motions = ensemble(
            module, (0.0, job.duration), starts,
            np.stack(params, axis=1) if params else np.empty((1, 0)),
            method=job.method, form=job.form, rtol=job.rtol, atol=job.atol,
            t_eval=np.linspace(0, job.duration, job.samples) if job.samples else None,
            events=events, occurrences=max(one.occurrences for one in maps),
            max_steps=job.max_steps, workers=1,
        )  # fmt: skip
    if (motions.status == Status.INTERRUPTED).any():
        raise InterruptedError("a part of the sweep was stopped")
    return motions
