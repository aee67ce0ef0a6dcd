"""Run a sweep: its chunks go to whoever executes them, and into its folder as they come back."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers import request
from solvers.ensemble import stop
from solvers.horizon import beyond_horizon
from solvers.progress import Rate
from solvers.sweeps.axes import Grid
from solvers.sweeps.folder import Folder
from solvers.sweeps.results import Results
from solvers.sweeps.sweep import Sweep
from solvers.sweeps.work import Job, begun, integrated, work
from solvers.written import written

#: Seconds that a chunk takes at most, about, and what it costs beside its motions.
CHUNK, COST = 1.0, 0.004
#: Motions that are tried to see how long they take.
TRIED = 64
#: Seconds for each evaluation of a right-hand side with n numbers: this times n^1.5.
EVALUATION = 0.25e-9
#: Largest number of bytes that a chunk's states may take; all that it keeps of its motions while
#: they run takes about ten times as much.
ROOM = 8e6


@dataclass(frozen=True)
class Pool:
    """Who does the work.

    Parameters
    ----------
    executor : concurrent.futures.Executor, optional
        A pool of processes, ``dask.distributed``'s ``Client.get_executor()``,
        ``mpi4py.futures.MPIPoolExecutor``; threads of this process by default.
    workers : int, optional
        How many chunks are done at the same time; by default one for each processor here.

    Raises
    ------
    ValueError
        When `workers` is no positive number.
    """

    executor: Executor | None = None
    workers: int | None = None

    def __post_init__(self) -> None:
        if self.workers is not None:
            request.count("workers", self.workers, 1)

    @property
    def size(self) -> int:
        """How many chunks are done at the same time."""
        return self.workers or len(os.sched_getaffinity(0))

    def opened(self) -> AbstractContextManager[Executor]:
        """The executor; our own is closed again."""
        return nullcontext(self.executor) if self.executor else ThreadPoolExecutor(self.size)


def sweep(
    asked: Sweep,
    folder: str | Path,
    *,
    pool: Pool = Pool(),
    tell: Callable[[str], None] = lambda _: None,
) -> Results:
    """Run a sweep, or what is left of it, and put its maps together.

    Parameters
    ----------
    asked : Sweep
        What is to be done.
    folder : path
        Where it is kept. What is there of the same sweep is not done again.
    pool : Pool
        Who does it.
    tell : callable
        Is told how far it is.

    Returns
    -------
    Results
        The maps. They are the same to the last bit however the work was shared out, on
        processors of one kind.

    Raises
    ------
    solvers.sweeps.folder.FolderError
        When another sweep is in the folder, or another process works there.
    OSError
        When something cannot be written.
    """
    job = Job.of(asked)
    with _folder(asked, job, folder) as kept:
        left = [number for number in range(kept.chunks) if number not in kept.done]
        rate = Rate(asked.motions, sum(end - begin for begin, end in map(kept.span, left)))
        with pool.opened() as executor, closing(
            _completed(executor, asked, job, kept, left, 2 * pool.size)
        ) as completed:  # fmt: skip
            for number, found in completed:
                kept.keep(number, found)
                tell(rate(len(found)))
        gathered(asked, kept)
    return Results.of(asked, Path(folder))


def sofar(asked: Sweep, folder: str | Path) -> Results:
    """What is there of a sweep that is not finished; it may be going on.

    Raises
    ------
    solvers.sweeps.folder.FolderError
        When another sweep is in the folder, or none.
    """
    job = Job.of(asked)
    kept = _folder(asked, job, folder)
    kept.look()

    def whole(name: str) -> NDArray[Any]:
        found = np.concatenate([*kept.rows(name)])
        return found.reshape(*asked.axes.shape, *found.shape[1:])

    varied = asked.axes.columns(0, asked.motions)
    axes = asked.axes.values if isinstance(asked.axes, Grid) else varied
    maps = {name: whole(name) for name in asked.maps}
    return Results(asked, Path(folder), maps, dict(axes), whole("status"))


def _folder(asked: Sweep, job: Job, folder: str | Path) -> Folder:
    return Folder(
        Path(folder), asked.asked, asked.motions, lambda: chunk_length(asked, job), job.dtype
    )


def gathered(asked: Sweep, kept: Folder) -> None:
    """Put together what is there, and write the axes of a grid."""
    kept.gather(asked.axes.shape)
    if isinstance(asked.axes, Grid):
        for name, values in asked.axes.values.items():
            file = BytesIO()
            np.save(file, values, allow_pickle=False)
            written(kept.path / f"{name}.npy", file.getvalue())


def _completed(
    pool: Executor, asked: Sweep, job: Job, kept: Folder, chunks: Sequence[int], most: int
) -> Generator[tuple[int, NDArray[np.void]]]:
    """Chunks as they are done, never more than `most` of them under way."""
    waiting = iter(chunks)
    under_way: dict[Future[NDArray[np.void]], int] = {}
    try:
        while True:
            for number in waiting:
                columns = asked.axes.columns(*kept.span(number))
                under_way[pool.submit(work, job, columns)] = number
                if len(under_way) == most:
                    break
            if not under_way:
                return
            finished, _ = wait(under_way, return_when=FIRST_COMPLETED)
            for future in finished:
                yield under_way.pop(future), future.result()
    finally:
        for future in under_way:
            future.cancel()
        if under_way:
            stop()


def chunk_length(asked: Sweep, job: Job) -> int:
    """How many motions a chunk is to hold: what takes about a second, in short sweeps less.

    There, so much that chunks cost no more than it costs to wait for the last of them. How
    long motions take follows from how often some evaluate their right-hand side, not from
    how fast they happen to be, so that a sweep is always cut alike.
    """
    most = asked.motions
    places = np.unique(np.linspace(0, most - 1, min(TRIED, most)).astype(int))
    rows = [asked.axes.columns(place, place + 1) for place in places]
    columns = {name: np.concatenate([row[name] for row in rows]) for name in rows[0]}
    starts, params, status = begun(job, asked.module, columns)
    there = status == 0
    evaluations = 1
    if there.any():
        with beyond_horizon():
            tried = integrated(job, asked.module, starts[there], [p[there] for p in params])
        evaluations += int(tried.nfev.sum())
    each = evaluations / len(places) * EVALUATION * len(asked.start) ** 1.5
    room = ROOM / (8 * len(asked.start) * (1 + job.samples + sum(
        one.occurrences * len(one.events(asked.module)) for one in job.maps.values()
    )))  # fmt: skip
    seconds = min(CHUNK, (COST * each * most) ** 0.5)
    return max(1, int(min(seconds / each, room)))
