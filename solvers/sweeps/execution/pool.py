"""Execution of chunks: threads of this process, or another executor."""

import os
from collections.abc import Callable, Collection, Generator, Iterable, Iterator, Mapping
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ThreadPoolExecutor,
    wait,
)
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from itertools import islice
from typing import Any, TypeAlias
from warnings import warn

import numpy as np
from numpy.typing import NDArray

from solvers.equations.signature_checks import checked
from solvers.integration.problem import validation
from solvers.integration.problem.status import StopFlag
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.process_arithmetic import first_motions, run_equal_chunk

#: Index of the first motion of a chunk, and of the one after its last.
Span: TypeAlias = tuple[int, int]
#: Seconds without a result after which a pool checks that there are workers.
PATIENCE = 3.0
LOST = "the workers are gone: completed chunks are kept, and the same call resumes the sweep"


class LostWorkersError(OSError):
    """An executor failed or lost its connection."""


@checked
@dataclass(frozen=True)
class Pool:
    """An executor of chunks.

    Parameters
    ----------
    executor : concurrent.futures.Executor, optional
        A pool of processes, ``dask.distributed``'s ``Client.get_executor()``,
        ``mpi4py.futures.MPIPoolExecutor``; threads of this process by default.
    workers : int, optional
        Number of chunks that are computed at the same time; by default that of the threads.
    threads : callable, optional
        Returns the current number of threads of the executor, which may change. A warning reports
        that there are none. By default one for each processor of this machine.

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
    threads: Callable[[], int] | None = None

    def __post_init__(self) -> None:
        if self.workers is not None:
            validation.count("workers", self.workers, 1)

    @property
    def size(self) -> int:
        """Number of chunks that are computed at the same time."""
        if self.workers is None and self.threads:
            return max(self._current_threads(), 1)
        return self.workers or len(os.sched_getaffinity(0))

    def first_motions(
        self, sweep: Sweep, sample: Mapping[str, Array]
    ) -> tuple[float, dict[str, str]]:
        """The result of `first_motions`, computed by a worker."""
        with self._running() as executor:
            future = executor.submit(first_motions, _outline(sweep), sample)
            self._wait([future])
            return future.result()

    def completed(
        self,
        sweep: Sweep,
        spans: Iterable[Span],
        sample: Mapping[str, Array],
        arithmetic: Mapping[str, str],
    ) -> Generator[tuple[Span, NDArray[np.void]]]:
        """Spans and their chunks in the order of completion; each worker gets two at a time.

        Every worker must have this arithmetic, which a sample of the motions shows.
        """
        outline, waiting, stop = _outline(sweep), iter(spans), StopFlag()
        submitted: dict[Future[NDArray[np.void]], Span] = {}
        with self._running() as executor:
            try:
                while True:
                    for span in islice(waiting, max(2 * self.size - len(submitted), 0)):
                        job = outline, sweep.axes.columns(*span), sample, arithmetic, stop
                        submitted[executor.submit(run_equal_chunk, *job)] = span
                    if not submitted:
                        return
                    for future in self._wait(submitted):
                        yield submitted.pop(future), future.result()
            finally:
                for future in submitted:
                    future.cancel()
                if submitted:
                    stop.set()  # for threads of this process

    @contextmanager
    def _running(self) -> Iterator[Executor]:
        """The executor; `LostWorkersError` if it fails."""
        given, own = self.executor, ThreadPoolExecutor
        context: AbstractContextManager[Executor] = nullcontext(given) if given else own(self.size)
        try:
            with context as executor:
                yield executor
        except (BrokenExecutor, CancelledError) as error:
            raise LostWorkersError(LOST) from error

    def _current_threads(self) -> int:
        assert self.threads is not None
        try:
            return self.threads()
        except (OSError, RuntimeError) as error:  # no connection, or a closed one
            raise LostWorkersError(LOST) from error

    def _wait(self, futures: Collection[Future[Any]]) -> Collection[Future[Any]]:
        """The futures that are done, at least one; a warning if there are no workers."""
        while True:
            done, _ = wait(futures, PATIENCE if self.threads else None, FIRST_COMPLETED)
            if done:
                return done
            if not self._current_threads():
                warn(
                    "there are no workers: the sweep waits until one is started; where holonomic "
                    "is not installed workers end at once",
                    stacklevel=2,
                )


def _outline(sweep: Sweep) -> Sweep:
    """A sweep whose axes take little memory."""
    return sweep.unchecked(axes=sweep.axes.outline)
