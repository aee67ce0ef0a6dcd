"""Who does the work: threads of this process, or whatever executes functions."""

from __future__ import annotations

import os
from collections.abc import Generator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solvers.integration import validation
from solvers.integration.ensemble import stop
from solvers.sweeps.axes import Axes
from solvers.sweeps.job import Job
from solvers.sweeps.worker import work


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
        When `workers` is no positive whole number.

    Examples
    --------
    >>> from concurrent.futures import ProcessPoolExecutor
    >>> Pool(workers=2).workers
    2
    >>> pool = Pool(ProcessPoolExecutor, workers=4)
    """

    executor: Executor | None = None
    workers: int | None = None

    def __post_init__(self) -> None:
        if self.workers is not None:
            validation.count("workers", self.workers, 1)

    @property
    def size(self) -> int:
        """How many chunks are done at the same time."""
        return self.workers or len(os.sched_getaffinity(0))

    def opened(self) -> AbstractContextManager[Executor]:
        """The executor; our own is closed again."""
        return nullcontext(self.executor) if self.executor else ThreadPoolExecutor(self.size)

    def completed(
        self, executor: Executor, job: Job, axes: Axes, spans: Sequence[tuple[int, int]]
    ) -> Generator[tuple[tuple[int, int], NDArray[np.void]]]:
        """What is kept of the motions in each span, as it is done, in any order.

        No more than two spans a worker are under way.

        Parameters
        ----------
        executor : concurrent.futures.Executor
            As `opened` gives it.
        job : Job
            What is done with every motion.
        axes : Grid, Table or Random
            What varies.
        spans : sequence of pairs of int
            The first motion of each part, and the one after its last.

        Yields
        ------
        span : pair of int
            One of `spans`.
        kept : structured ndarray of shape (motions of the span,)
            With the fields of ``job.dtype``.
        """
        waiting = iter(spans)
        under_way: dict[Future[NDArray[np.void]], tuple[int, int]] = {}
        try:
            while True:
                for span in waiting:
                    under_way[executor.submit(work, job, axes.columns(*span))] = span
                    if len(under_way) == 2 * self.size:
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
