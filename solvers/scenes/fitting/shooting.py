"""Segments of motions from nodes of their own, and how they depend on nodes and parameters."""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.equations.quantities import Array
from solvers.integration import compiled_loop, python_loop, validation
from solvers.integration.compiled.kernel import Batch
from solvers.integration.compiled.layout import STATUSES
from solvers.integration.prepare import NotFinishedError
from solvers.integration.problem import Options, Outcome
from solvers.integration.solution import Status

#: Method and tolerances.
METHOD, RTOL, ATOL = "verner853", 1e-10, 1e-10
FINISHED = STATUSES.index(Status.FINISHED)


@dataclass(frozen=True)
class Segment:
    """A part of a run between two nodes."""

    run: int
    begin: float
    end: float
    first: int  # index of its first sample in the run
    times: Array  # of its samples


def segments(run: int, t: Array, cuts: Sequence[int]) -> list[Segment]:
    """The parts of a run with sample times `t`, which begin at the samples `cuts`."""
    ends = [*cuts[1:], len(t)]
    return [
        Segment(run, t[first], t[min(end, len(t) - 1)], first, t[first:end])
        for first, end in zip(cuts, ends, strict=True)
    ]


@dataclass(frozen=True)
class Arc:
    """The motion of a segment, with derivatives by its node and by the unknown parameters.

    Attributes
    ----------
    y : ndarray of shape (state, times)
        States at the samples.
    by : ndarray of shape (state, state + unknown, times)
        Their derivatives.
    end, end_by : ndarray of shape (state,) and (state, state + unknown)
        The same at the end.
    """

    y: Array
    by: Array
    end: Array
    end_by: Array


class Shooting:
    """Motions of all segments from their nodes, one lane of a compiled loop for each derivative.

    `ValueError` where `module` has no variational equations, or forces with kinks, at which these
    do not hold.
    """

    def __init__(
        self, module: GeneratedModule, unknown: Sequence[int], segments: Sequence[Segment]
    ) -> None:
        self._unknown, self._segments, self._n = [*unknown], segments, len(module.STATE)
        times = [time for segment in segments for time in (segment.begin, segment.end)]
        options = Options(METHOD, "sensitivity", RTOL, ATOL)
        problem = validation.problem_at_rest(module, (min(times), max(times)), options)
        if problem.form.switching_count:
            raise ValueError(
                f"forces of {module.SYSTEM} have kinks or jumps, where variational equations do "
                "not hold: replace abs, sign, min, max and Piecewise by smooth functions, such as "
                "sign(v) by tanh(v/w)"
            )
        self._problem, self._program = compiled_loop.select(problem, lanes=True)
        self._directions = self._n + len(self._unknown)
        self._samples = np.full((len(segments), max(len(s.times) for s in segments)), np.inf)
        for row, segment in zip(self._samples, segments, strict=True):
            row[: len(segment.times)] = segment.times

    def __call__(self, nodes: Array, params: Array) -> list[Arc]:
        """The arcs from nodes of shape (segments, state); `NotFinishedError` if one has no end."""
        lanes, n = self._directions, self._n
        sizes = np.abs(params[self._unknown])
        sizes[sizes == 0] = 1.0
        starts = np.zeros((len(nodes), lanes, 2 * n))
        starts[:, :, :n] = nodes[:, np.newaxis]
        starts[:, range(n), range(n, 2 * n)] = 1.0
        changes = np.zeros((len(params), lanes))
        changes[self._unknown, range(n, lanes)] = sizes
        columns = [*np.tile(changes, len(nodes)), *params]
        run = self._compiled if self._program else self._in_python
        states, ends = run(starts.reshape(-1, 2 * n), columns)
        scale = np.concatenate([np.ones(n), 1 / sizes])[:, np.newaxis]
        arcs = []
        for k, segment in enumerate(self._segments):
            own, count = slice(k * lanes, (k + 1) * lanes), len(segment.times)
            part, end = states[own, :count], ends[own]
            by = np.moveaxis(part[:, :, n:], 2, 0) * scale
            arcs.append(Arc(part[0, :, :n].T, by, end[0, :n], end[:, n:].T * scale[:, 0]))
        return arcs

    def _compiled(self, starts: Array, columns: list[Array]) -> tuple[Array, Array]:
        """States at samples, shape (motions, times, 2 state), and at ends, (motions, 2 state)."""
        assert self._program is not None
        problem, lanes = self._problem.with_params(columns), self._directions
        capacity = self._samples.shape[1]
        batch = Batch(self._program, problem, starts, capacity=capacity)
        batch.motions["t"] = np.repeat([s.begin for s in self._segments], lanes)
        ends = np.repeat([s.end for s in self._segments], lanes)
        batch.set_times(ends, np.repeat(self._samples, lanes, axis=0))
        batch.restart()
        with ThreadPoolExecutor(workers := processors()) as pool:
            for thread in [pool.submit(batch.run) for _ in range(workers)]:
                thread.result()
        for motion in batch.motions[batch.motions["status"] != FINISHED]:
            raise failure(STATUSES[motion["status"]], float(motion["t"]))
        motions = np.repeat(np.arange(len(starts)), capacity)
        rows = batch.ordinary(batch.rows.ravel(), motions).reshape(len(starts), capacity, -1)
        return rows, batch.ordinary(batch.motions)

    def _in_python(self, starts: Array, columns: list[Array]) -> tuple[Array, Array]:
        states = np.full((len(starts), self._samples.shape[1], starts.shape[1]), np.nan)
        ends = np.empty_like(starts)
        for k, start in enumerate(starts):
            segment = self._segments[k // self._directions]
            values = [float(np.broadcast_to(column, len(starts))[k]) for column in columns]
            span = (segment.begin, segment.end)
            problem = self._problem.with_params(values)
            problem = replace(problem, start=start, span=span, samples=segment.times)
            outcome = Outcome.at_start(problem)
            python_loop.run(problem, outcome)
            if outcome.status is not Status.FINISHED:
                raise failure(outcome.status, outcome.end[0])
            states[k, : len(segment.times)], ends[k] = outcome.rows()[1], outcome.end[1]
        return states, ends


def processors() -> int:
    """Number of processors that this process may use."""
    return len(os.sched_getaffinity(0))


def failure(status: Status | None, t: float) -> NotFinishedError:
    """The error of a segment that does not reach its end."""
    return NotFinishedError(status or Status.INTERRUPTED, t, ())
