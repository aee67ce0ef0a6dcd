"""A part of a sweep, done anywhere: in a thread, another process, or on another machine.

What travels is small: names and numbers, and the text of a module that does not ship. Each
worker loads or builds the compiled loop once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from solvers.ensemble import ensemble
from solvers.horizon import beyond_horizon
from solvers.made import made
from solvers.native import header
from solvers.solution import Ensemble, Status
from solvers.sweeps.axes import Grid
from solvers.sweeps.barrier import energies, is_below
from solvers.sweeps.checks import ENERGY, FROM_ENERGY
from solvers.sweeps.map import Found, Map
from solvers.sweeps.maps import First
from solvers.sweeps.sweep import Sweep

Array: TypeAlias = NDArray[np.float64]

#: How a motion ended, by the number that stands in a map; the first is not done yet.
STATUSES = (
    "not done yet", *(status.name.lower().replace("_", " ") for status in Status), "proved",
    "no such energy",
)  # fmt: skip
PROVED, NO_SUCH_ENERGY = STATUSES.index("proved"), STATUSES.index("no such energy")
CODES = {status: STATUSES.index(status.name.lower().replace("_", " ")) for status in Status}


@dataclass(frozen=True)
class Source:
    """Where a worker finds a module: under its name, or as texts by file name."""

    name: str
    texts: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of(cls, module: ModuleType) -> Source:
        """The source of a module that is loaded here."""
        if module.__name__.startswith("generated."):
            return cls(module.__name__)
        files = filter(None, (Path(str(module.__file__)), header(module)))
        texts = tuple((path.name, path.read_text(encoding="utf-8")) for path in files)
        return cls(module.__name__.rpartition(".")[2], texts)


@lru_cache
def _loaded(source: Source) -> ModuleType:
    if not source.texts:
        return import_module(source.name)
    return made(source.name, repr(source.texts), lambda: dict(source.texts))


@dataclass(frozen=True)
class Job:
    """What is done with every motion of a sweep; a few kilobytes."""

    source: Source
    values: Mapping[str, float | str]
    duration: float
    method: str
    form: str
    rtol: float
    atol: float
    max_steps: int
    samples: int
    maps: Mapping[str, Map]
    columns: tuple[str, ...]

    @classmethod
    def of(cls, sweep: Sweep) -> Job:
        """The job of a sweep."""
        return cls(
            Source.of(sweep.module), dict(sweep.values), sweep.duration, sweep.method, sweep.form,
            sweep.rtol, sweep.atol, sweep.max_steps, sweep.samples, dict(sweep.maps),
            () if isinstance(sweep.axes, Grid) else tuple(sweep.axes.smallest),
        )  # fmt: skip

    @property
    def dtype(self) -> np.dtype[np.void]:
        """What is kept of one motion."""
        fields = [(name, "<f8", one.shape) for name, one in self.maps.items()]
        # what varies on no grid stands beside what came of it
        columns = [(name, "<f8") for name in self.columns]
        return np.dtype([("status", "i1"), *columns, *fields])


def work(job: Job, columns: Mapping[str, Array]) -> NDArray[np.void]:
    """Integrate the motions whose varying values are `columns`, and keep what is asked.

    Returns
    -------
    structured ndarray of shape (n,)
        With the fields of ``job.dtype``.
    """
    module = _loaded(job.source)
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


def begun(
    job: Job, module: ModuleType, columns: Mapping[str, Array]
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
    for one in job.maps.values():
        if isinstance(one, First) and one.barrier and len(job.maps) == 1:
            status[(status == 0) & is_below(module, one.barrier, state, params)] = PROVED
    if job.form == "variational":
        size = len(module.STATE)
        state = np.hstack([state, np.full((n, size), size**-0.5)])
    return state, params, status


def rate(module: ModuleType, state: Array, params: list[Array], place: int, energy: Array) -> Array:
    """The positive velocity at `place` with which states have an energy; NaN where none has.

    The energy is a polynomial of the second degree in the velocity.
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


def watched(job: Job, module: ModuleType) -> list[tuple[str, Map, slice]]:
    """The maps, with their names and which of all events are theirs."""
    found, first = [], 0
    for name, one in job.maps.items():
        count = len(one.events(module))
        found.append((name, one, slice(first, first + count)))
        first += count
    return found


def integrated(job: Job, module: ModuleType, starts: Array, params: list[Array]) -> Ensemble:
    """The motions, in one thread."""
    maps = job.maps.values()
    # where only the first event is asked for, nothing is asked of a motion after it
    is_over = all(isinstance(one, First) for one in maps) and len(maps) == 1
    events = [replace(event, terminal=is_over) for one in maps for event in one.events(module)]
    with beyond_horizon():
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
