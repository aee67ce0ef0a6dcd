"""Segments of motions from nodes of their own, and how they depend on nodes and parameters."""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.equations.number_checks import Array
from solvers.integration.compiled.kernel import Batch
from solvers.integration.compiled.memory_layout import STATUSES
from solvers.integration.loops import compiled_loop, python_loop
from solvers.integration.problem import validation
from solvers.integration.problem.inputs import Schedule
from solvers.integration.problem.problem import Options
from solvers.integration.problem.status import Status
from solvers.integration.results.recorder import Outcome

#: Method, that with inputs, between changes of which steps are short, and tolerances.
METHOD, METHOD_WITH_INPUTS, RTOL, ATOL = "verner853", "dp54", 1e-9, 1e-9
#: Most steps of a segment: parameters that make a motion wild are not tried for long.
MOST_STEPS = 10_000
#: Samples of all motions below which threads take longer than they save.
FEW = 2000
Flags = NDArray[np.bool_]
FINISHED = STATUSES.index(Status.FINISHED)


class NoResidualsError(ArithmeticError):
    """The motions from some nodes end early, or a measured quantity has no value along them."""


@dataclass(frozen=True)
class Segment:
    """A part of a run between two nodes."""

    run: int
    begin: float
    end: float
    first: int  # index of its first sample in the run
    times: Array  # of its samples
    changes: Array  # times up to which inputs act, if these change
    inputs: Array  # of shape (changes, inputs)


def segments(run: int, t: Array, cuts: Sequence[int], inputs: Array | None = None) -> list[Segment]:
    """The parts of a run with sample times `t`, which begin at the samples `cuts`.

    `inputs`, of shape (inputs, times), act from each sample to the next one.
    """
    parts = []
    for first, stop in zip(cuts, [*cuts[1:], len(t)], strict=True):
        last = min(stop, len(t) - 1)
        changes, values = np.empty(0), np.empty((0, 0))
        if inputs is not None:  # a run of one sample ends at its only change
            changes, values = t[first + 1 : last + 1], inputs.T[first:last]
            if not len(changes):
                changes, values = t[first : first + 1], inputs.T[first : first + 1]
        parts.append(Segment(run, t[first], t[last], first, t[first:stop], changes, values))
    return parts


@dataclass(frozen=True)
class Arcs:
    """The motions of all segments, with derivatives by nodes and by the unknown parameters.

    Segments with fewer samples than others repeat their node.

    Attributes
    ----------
    y : ndarray of shape (segments, state, times)
        States at the samples.
    by : ndarray of shape (segments, state + unknown, times, state)
        Their derivatives.
    ends, ends_by : ndarray of shape (segments, state) and (segments, state, state + unknown)
        The same at the ends.
    """

    y: Array
    by: Array
    ends: Array
    ends_by: Array


class MultipleShooting:
    """Motions of all segments from their nodes, one lane of a compiled loop for each derivative.

    `ValueError` where `module` has no variational equations, or forces with kinks, at which these
    do not hold.
    """

    def __init__(
        self, module: GeneratedModule, unknown: Sequence[int], segments: Sequence[Segment]
    ) -> None:
        self._unknown, self._n = [*unknown], len(module.STATE)
        times = [time for segment in segments for time in (segment.begin, segment.end)]
        changes = max(len(segment.changes) for segment in segments)
        method = METHOD_WITH_INPUTS if changes else METHOD
        options = Options(method, "sensitivity", RTOL, ATOL, max_steps=MOST_STEPS + changes)
        problem = validation.problem_at_rest(module, (min(times), max(times)), options)
        if problem.form.switching_count:
            raise ValueError(
                f"forces of {module.SYSTEM} have kinks or jumps, where variational equations do "
                "not hold: replace abs, sign, min, max and Piecewise by smooth functions, such as "
                "sign(v) by tanh(v/w)"
            )
        self._problem, self._program = compiled_loop.select(problem, lanes=True)
        self._directions = self._n + len(self._unknown)
        counts = np.array([len(segment.times) for segment in segments])
        self.missing: Flags = np.arange(counts.max()) >= counts[:, np.newaxis]
        self._samples: Array = np.full(self.missing.shape, np.inf)
        self._samples[~self.missing] = np.concatenate([segment.times for segment in segments])
        self._begins, self._ends = np.array([(s.begin, s.end) for s in segments]).T
        self._segments, self._has_inputs = [*segments], changes > 0
        self._last: tuple[Array, Array, Arcs] | None = None

    @property
    def times(self) -> Array:
        """Times of the samples, shape (segments, times); the begin in place of missing ones."""
        return np.where(self.missing, self._begins[:, np.newaxis], self._samples)

    def __call__(self, nodes: Array, params: Array) -> Arcs:
        """The motions from nodes of shape (segments, state); `NoResidualsError` if one ends."""
        if self._last and all(map(np.array_equal, self._last[:2], (nodes, params))):
            return self._last[2]  # those of the minimum, for the statistics
        lanes, n, count = self._directions, self._n, len(nodes)
        sizes = np.ones(lanes)
        sizes[n:] = np.where(params[self._unknown] == 0, 1.0, np.abs(params[self._unknown]))
        starts = np.zeros((count, lanes, 2 * n))
        starts[:, :, :n] = nodes[:, np.newaxis]
        starts[:, range(n), range(n, 2 * n)] = 1.0
        changes = np.zeros((len(params), lanes))
        changes[self._unknown, range(n, lanes)] = sizes[n:]
        columns = [*np.tile(changes, count), *params]
        run = self._compiled if self._program else self._in_python
        states, by, ends = run(starts.reshape(-1, 2 * n), columns)
        by = by.reshape(count, lanes, -1, n) / sizes[:, np.newaxis, np.newaxis]
        y = np.where(self.missing[:, :, np.newaxis], nodes[:, np.newaxis], states)
        ends = ends.reshape(count, lanes, 2 * n)
        ends_by = np.moveaxis(ends[:, :, n:], 1, 2) / sizes
        arcs = Arcs(np.moveaxis(y, 1, 2), by, ends[:, 0, :n], ends_by)
        self._last = nodes.copy(), params.copy(), arcs
        return arcs

    def _compiled(self, starts: Array, columns: list[Array]) -> tuple[Array, Array, Array]:
        """States and perturbations of all motions at samples, and both at ends."""
        assert self._program is not None
        lanes, capacity = self._directions, self._samples.shape[1]
        problem = self._problem.with_params(columns)
        batch = Batch(self._program, problem, starts, capacity=capacity)
        batch.motions["t"] = np.repeat(self._begins, lanes)
        batch.set_times(np.repeat(self._ends, lanes), np.repeat(self._samples, lanes, axis=0))
        if self._has_inputs:
            batch.hold(*self._held)
        batch.restart()
        if batch.rows.size < FEW:
            batch.run()
        else:
            with ThreadPoolExecutor(workers := processors()) as pool:
                for thread in [pool.submit(batch.run) for _ in range(workers)]:
                    thread.result()
        for motion in batch.motions[batch.motions["status"] != FINISHED]:
            raise failure(STATUSES[motion["status"]], float(motion["t"]))
        form, first = batch.form, batch.rows[::lanes].ravel()
        states = form.to_ordinary_many(first["t"], first["z"], first["turns"])[:, : self._n]
        # perturbations are components of the form's state, too
        shared = [i for k, i in form.shared_columns if k >= self._n]
        perturbations = batch.rows["z"][:, :, shared[0] : shared[-1] + 1]
        return states.reshape(-1, capacity, self._n), perturbations, batch.ordinary(batch.motions)

    @cached_property
    def _held(self) -> tuple[Array, Array, NDArray[np.intp]]:
        """Ends of held inputs, their values, and the index of the first ones of each motion."""
        ends, values = list[Array](), list[Array]()
        for segment in self._segments:
            ends.append(np.append(segment.changes, np.nan))
            values.append(np.concatenate([segment.inputs, segment.inputs[-1:]]))
        firsts = np.cumsum([0, *map(len, ends[:-1])])
        return np.concatenate(ends), np.concatenate(values), np.repeat(firsts, self._directions)

    def _in_python(self, starts: Array, columns: list[Array]) -> tuple[Array, Array, Array]:
        rows = np.zeros((len(starts), self._samples.shape[1], starts.shape[1]))
        ends = np.empty_like(starts)
        for k, start in enumerate(starts):
            own = k // self._directions
            values = [float(np.broadcast_to(column, len(starts))[k]) for column in columns]
            times = self._samples[own, ~self.missing[own]]
            span = (float(self._begins[own]), float(self._ends[own]))
            problem = self._problem.with_params(values)
            problem = replace(problem, start=start, span=span, samples=times)
            if self._has_inputs:
                segment = self._segments[own]
                samples = np.append(span[0], segment.changes[:-1])
                schedule = Schedule(problem.form.module, samples, segment.inputs.T, None)
                problem = replace(problem, schedule=schedule)
            outcome = Outcome.at_start(problem)
            python_loop.run(problem, outcome)
            if outcome.status is not Status.FINISHED:
                raise failure(outcome.status, outcome.end[0])
            rows[k, : len(times)], ends[k] = outcome.rows()[1], outcome.end[1]
        return rows[:: self._directions, :, : self._n], rows[:, :, self._n :], ends


def processors() -> int:
    """Number of processors that this process may use."""
    return len(os.sched_getaffinity(0))


def failure(status: Status | None, t: float) -> NoResidualsError:
    """The error of a segment that does not reach its end."""
    reason = (status or Status.INTERRUPTED).reason
    return NoResidualsError(f"the motion ends at t = {t:.6g} s, since {reason}")
