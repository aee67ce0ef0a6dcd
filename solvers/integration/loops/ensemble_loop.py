"""The integration of many motions: in vector lanes over all cores, or one by one in Python."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.integration.compiled.kernel import Batch, Kernel
from solvers.integration.compiled.memory_layout import STATUSES
from solvers.integration.loops import python_loop
from solvers.integration.loops.singular_passage import rerun
from solvers.integration.problem.events import Extremum
from solvers.integration.problem.inputs import History
from solvers.integration.problem.problem import EventFunction, Problem
from solvers.integration.problem.status import Status, StopFlag
from solvers.integration.results.ensemble_solution import Ensemble, EnsembleTimes
from solvers.integration.results.recorder import Outcome
from solvers.runge_kutta.stepper import Array

#: Rows whose states are computed at once.
BLOCK = 100_000


@dataclass(frozen=True)
class EnsembleRun:
    """A run of many motions; its problem stands for all, without their states and parameters."""

    problem: Problem
    states: Array  # of shape (n, state)
    params: Array  # of shape (n or 1, parameters)
    times: EnsembleTimes
    skip: Sequence[int]  # occurrences of each event that are not stored
    result: Ensemble
    stop: StopFlag

    def run_compiled(self, program: Kernel, workers: int) -> None:
        """Integrate all motions by a compiled loop in threads."""
        result, states = self.result, self.states
        problem = self.problem.with_params(list(self.params.T))
        capacity, occurrences = self.times.samples.shape[1], result.t_events.shape[-1]
        batch = Batch(program, problem, states, capacity=capacity, occurrences=occurrences)
        batch.set_times(self.times.ends, self.times.samples)
        batch.skip(self.skip)
        batch.task.stop = self.stop.array.ctypes.data

        def reached() -> Array:
            return batch.ordinary(batch.motions).T

        try:
            table = problem.held_table(History())
            if table:
                batch.resume(problem.with_inputs(table[1][0]))
                batch.hold(*table)
                self._run_threads(batch, workers)
            for part in [] if table else problem.segments(reached, History()):
                if problem.schedule:
                    batch.resume(part)
                self._run_threads(batch, workers)
                if self.stop.is_set:
                    break
        finally:
            self._collect(batch)
            # as given, not as sine and cosine return them
            result.y[:, result.steps == 0] = states[result.steps == 0].T
            if capacity:
                first = self.times.samples[:, 0] == self.times.begin
                result.samples[:, :, 0] = np.where(first, states.T, result.samples[:, :, 0])

    def _run_threads(self, batch: Batch, workers: int) -> None:
        """Run the batch; C releases Python's lock, this thread receives interruptions."""
        from concurrent.futures import ThreadPoolExecutor  # takes time to load

        batch.restart()
        with ThreadPoolExecutor(workers) as pool:
            try:
                for thread in [pool.submit(batch.run) for _ in range(workers)]:
                    thread.result()
            except KeyboardInterrupt:
                self.stop.set()
                raise

    def _collect(self, batch: Batch) -> None:
        """Copy the results of the batch."""
        result, motions, events = self.result, batch.motions, len(self.problem.events)
        result.t[:], result.y.T[:] = motions["t"], batch.ordinary(motions)
        if motions["scale"].size:
            changes = motions["z"][:, -(len(result.units) // 2) :]
            self._set_growth(changes, motions["scale"][:, 0])
        result.status[:] = np.array(STATUSES, object)[motions["status"]]
        result.status[motions["status"] < STATUSES.index(Status.FINISHED)] = Status.INTERRUPTED
        at_limit = motions["occurred"][:, events : events + len(self.problem.limits)].any(axis=1)
        result.status[at_limit & (result.status == Status.EVENT)] = Status.OUTSIDE_DOMAIN
        result.steps[:], result.rejected[:] = motions["steps"], motions["rejected"]
        result.nfev[:] = batch.nfev
        for motion, k, rows in _blocks(batch.rows, motions["rows"]):
            result.samples[:, motion, k] = batch.ordinary(rows, motion).T
        result.occurred[:] = motions["occurred"][:, :events]
        extremes = batch.extremes_only[:events]
        recorded = np.maximum(result.occurred - np.array(self.skip, np.int64), 0)
        stored = np.where(extremes, np.minimum(recorded, 2), recorded)
        for event in range(events):
            for motion, k, rows in _blocks(batch.event_rows[:, event], stored[:, event]):
                result.t_events[motion, event, k] = rows["t"]
                result.y_events[:, motion, event, k] = batch.ordinary(rows, motion).T

    def run_one_by_one(self) -> None:
        """Integrate the motions in Python."""
        try:
            for k in range(len(self.states)):
                if self.stop.is_set:
                    return
                problem = self._motion(k)
                outcome = Outcome.at_start(problem)
                try:
                    python_loop.run(problem, outcome, self.stop)
                finally:
                    self._store(outcome, k)
        finally:
            if self.problem.form.name == "variational":
                self._set_growth(self.result.y.T[:, len(self.result.units) // 2 :])

    def pass_singularities(self) -> None:
        """Repeat motions that reach singular configurations, one by one through these."""
        for k in np.flatnonzero(self.result.status == Status.SINGULAR).tolist():
            if not self.stop.is_set:
                self._store(rerun(self._motion(k)), k)

    def _motion(self, k: int) -> Problem:
        """The problem of motion `k`."""
        span, samples = (self.times.begin, self.times.end(k)), self.times.samples_of(k)
        problem = self.problem.motion(k, self.states, self.params)
        return replace(problem, span=span, samples=samples)

    def _store(self, outcome: Outcome, k: int) -> None:
        """Copy the results of motion `k`."""
        result = self.result
        result.t[k], result.y[:, k] = outcome.end
        result.status[k], result.nfev[k] = outcome.status, outcome.nfev
        result.steps[k], result.rejected[k] = outcome.steps, outcome.rejected
        _, rows = outcome.rows()
        result.samples[:, k, : len(rows)] = rows.T
        for i, event in enumerate(self.problem.events):
            times, states = outcome.t_events[i], outcome.y_events[i]
            result.occurred[k, i] = len(times)
            skip = self.skip[i]
            stored = [skip + n for n in _stored(event, states[skip:])]
            stored = stored[: result.t_events.shape[-1]]
            for column, occurrence in enumerate(stored):
                result.t_events[k, i, column] = times[occurrence]
                result.y_events[:, k, i, column] = states[occurrence]

    def _set_growth(self, changes: Array, scale: ArrayLike = 0.0) -> None:
        before = self.states[:, len(self.result.units) // 2 :]
        self.result.growth[:] = _log_length(changes, scale) - _log_length(before)


def _blocks(
    rows: NDArray[np.void], counts: NDArray[np.int64]
) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.void]]]:
    """Motions, numbers and content of the first `counts` rows of each motion, in blocks."""
    width = max(BLOCK // len(rows), 1) if len(rows) else 1
    end = min(rows.shape[1], int(counts.max(initial=0)))
    for first in range(0, end, width):
        numbers = np.arange(first, min(first + width, end))
        motion, k = np.nonzero(numbers < counts[:, np.newaxis])
        yield motion, first + k, rows[motion, first + k]


def _stored(event: EventFunction, states: Sequence[Array]) -> Sequence[int]:
    """The occurrences of an event to store: those of the extremes, or all."""
    if not states or not isinstance(event, Extremum):
        return range(len(states))
    values = [y[event.module.STATE.index(event.coordinate)] for y in states]
    return int(np.argmin(values)), int(np.argmax(values))


def _log_length(changes: Array, scale: ArrayLike = 0.0) -> Array:
    """Natural logarithms of the lengths of perturbations in rows, times powers of two."""
    largest = np.abs(changes).max(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        length = np.log(largest) + np.log(np.linalg.norm(changes.T / largest, axis=0))
    return np.asarray(length + np.log(2) * np.asarray(scale))
