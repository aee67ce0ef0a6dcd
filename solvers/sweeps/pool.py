"""Execution of chunks: threads of this process, or another executor."""

import os
from collections.abc import Generator, Iterable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import nullcontext
from dataclasses import dataclass
from itertools import islice
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from solvers.integration import validation
from solvers.integration.ensemble_run import StopFlag
from solvers.sweeps.sweep import Sweep
from solvers.sweeps.worker import run_chunk

#: Index of the first motion of a chunk, and of the one after its last.
Span: TypeAlias = tuple[int, int]


@dataclass(frozen=True)
class Pool:
    """An executor of chunks.

    Parameters
    ----------
    executor : concurrent.futures.Executor, optional
        A pool of processes, ``dask.distributed``'s ``Client.get_executor()``,
        ``mpi4py.futures.MPIPoolExecutor``; threads of this process by default.
    workers : int, optional
        Number of chunks that are computed at the same time; by default one for each processor
        of this machine.

    Raises
    ------
    ValueError
        When `workers` is no positive integer.

    Examples
    --------
    >>> from concurrent.futures import ProcessPoolExecutor
    >>> Pool(workers=2).workers
    2
    >>> pool = Pool(ProcessPoolExecutor(4), workers=4)
    """

    executor: Executor | None = None
    workers: int | None = None

    def __post_init__(self) -> None:
        if self.workers is not None:
            validation.count("workers", self.workers, 1)

    @property
    def size(self) -> int:
        """Number of chunks that are computed at the same time."""
        return self.workers or len(os.sched_getaffinity(0))

    def completed(
        self, sweep: Sweep, spans: Iterable[Span]
    ) -> Generator[tuple[Span, NDArray[np.void]]]:
        """Spans and their chunks in the order of completion; each worker gets two at a time."""
        outline = sweep.unchecked(axes=sweep.axes.outline)
        waiting, stop = iter(spans), StopFlag()
        submitted: dict[Future[NDArray[np.void]], Span] = {}
        own = self.executor or ThreadPoolExecutor(self.size)
        with nullcontext(own) if self.executor else own as executor:
            try:
                while True:
                    for span in islice(waiting, 2 * self.size - len(submitted)):
                        columns = sweep.axes.columns(*span)
                        submitted[executor.submit(run_chunk, outline, columns, stop)] = span
                    if not submitted:
                        return
                    finished, _ = wait(submitted, return_when=FIRST_COMPLETED)
                    for future in finished:
                        yield submitted.pop(future), future.result()
            finally:
                for future in submitted:
                    future.cancel()
                if submitted:
                    stop.set()  # for threads of this process
