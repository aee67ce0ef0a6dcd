"""Timed runs: the end and the cost of an integration, and costs between runs."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.integration.loops import python_loop
from solvers.integration.prepare import NotFinishedError, prepare
from solvers.integration.problem import validation
from solvers.integration.problem.problem import Options
from solvers.integration.problem.status import Status
from solvers.integration.results.recorder import Outcome
from solvers.runge_kutta.stepper import Array

#: Largest number of steps of a timed run.
MOST_STEPS = 10**8
#: Seconds for which a short run is repeated.
SECONDS = 0.01


@dataclass(frozen=True)
class TimedRun:
    """The cost and the end of a run."""

    work_seconds: float  # without preparation; the median of several runs if it is short
    work_rhs: int
    steps: int
    end: Array  # an ordinary state


def timed_run(
    module: GeneratedModule,
    params: Sequence[float],
    y0: Sequence[float],
    duration: float,
    *,
    method: str,
    form: str,
    backend: str,
    rtol: float = 0.0,
    h: float | None = None,
) -> TimedRun | None:
    """Integrate and time a motion from time 0; None if it does not reach its end.

    Parameters
    ----------
    module, params, y0, method, form, h
        As in `integrate`.
    duration : float
        In s.
    backend : {"compiled", "python", "scipy"}
        The backend; the method decides between the last two.
    rtol : float
        Relative and absolute tolerance.

    Returns
    -------
    TimedRun or None

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> choice = dict(method="rk4", form="rational", backend="python", h=0.1)
    >>> run = timed_run(sp, sp.DEFAULTS, (1.0, 0.0), 1.0, **choice)
    >>> run.steps, run.work_rhs
    (10, 40)
    """
    span = (0.0, duration)
    if backend == "compiled":
        build = partial(prepare, module, params, method=method, form=form, max_steps=MOST_STEPS)
        run = build(rtol=rtol, atol=rtol, h=h)
        try:
            end = run(span, y0)
        except NotFinishedError:
            return None
        return TimedRun(median_seconds(lambda: run(span, y0)), run.nfev, run.steps, np.array(end))
    options = Options(method, form, rtol, rtol, h, t_eval=span[1:], max_steps=MOST_STEPS)
    problem = validation.problem(module, span, y0, params, options)

    def run_once() -> Outcome:
        result = Outcome.at_start(problem)
        python_loop.run(problem, result)
        return result

    start = time.perf_counter()
    result = run_once()
    first = time.perf_counter() - start
    if result.status is not Status.FINISHED:
        return None
    seconds = first if first > SECONDS else median_seconds(run_once)
    return TimedRun(seconds, result.nfev, result.steps, result.rows()[1][-1])


def median_seconds(run: Callable[[], object]) -> float:
    """Median time of a call."""
    times: list[float] = []
    until = time.perf_counter() + SECONDS
    while not times or time.perf_counter() < until:
        before = time.perf_counter()
        run()
        times.append(time.perf_counter() - before)
    return float(np.median(times))


def work_at(error: float, errors: Sequence[float], works: Sequence[float]) -> float:
    """The work for an error, interpolated on logarithmic scales; NaN outside of the runs.

    Runs are in the order of increasing work. Each counts with the largest error of it and of all
    runs with more work: a smaller error at less work is a coincidence. Where rounding makes errors
    grow again, the curve ends: with the pair of neighbours whose larger error is least.
    """
    if not errors:
        return float("nan")
    last = least_pair(errors) + 1
    monotonic = np.maximum.accumulate(list(errors[:last])[::-1])
    if not monotonic[0] <= error <= monotonic[-1]:
        return float("nan")
    logarithm = np.interp(np.log(error), np.log(monotonic), np.log(list(works[:last])[::-1]))
    return float(np.exp(logarithm))


def least_pair(errors: Sequence[float]) -> int:
    """The later run of the pair of neighbours whose larger error is least."""
    larger = [max(pair) for pair in pairwise(errors)]
    return len(larger) - int(np.argmin(larger[::-1])) if larger else 0
