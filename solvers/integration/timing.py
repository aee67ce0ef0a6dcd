"""One run, measured: where it ends, and what it costs; and costs between runs."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.integration import python_loop, scipy_loop, validation
from solvers.integration.prepare import NotFinishedError, prepare
from solvers.integration.problem import Outcome, Problem
from solvers.integration.solution import Status
from solvers.runge_kutta.tableau import Tableau

Array = NDArray[np.float64]

#: No run takes more steps than this.
MOST_STEPS = 10**8
#: A run is timed until so many seconds have passed.
SECONDS = 0.01


@dataclass(frozen=True)
class TimedRun:
    """What a run costs.

    Attributes
    ----------
    work_seconds : float
        Its time, with preparation left out: the median of several runs if it is short.
    work_rhs, steps : int
        Right-hand sides evaluated, and steps taken.
    end : ndarray of shape (state,)
        The ordinary state at its end.
    """

    work_seconds: float
    work_rhs: int
    steps: int
    end: Array


def timed_run(
    module: GeneratedModule, params: Sequence[float], y0: Sequence[float], duration: float,
    *, method: str, form: str, backend: str, rtol: float = 0.0, h: float | None = None,
) -> TimedRun | None:  # fmt: skip
    """Run and time a motion from time 0; None if it does not reach its end.

    Parameters
    ----------
    module, params, y0, method, form
        As in `solvers.integration.integrate.integrate`.
    duration : float
        In s.
    backend : {"compiled", "python", "scipy"}
        Where it runs. Of the last two the method decides: ours run in Python.
    rtol : float
        Relative and absolute tolerance.
    h : float, optional
        A fixed step in s instead.

    Returns
    -------
    TimedRun or None

    Raises
    ------
    ValueError
        When an argument makes no sense.
    solvers.runge_kutta.catalogue.UnknownMethodError
        When no method has this name.
    solvers.integration.compiled.compiler.NoCompilerError
        When ``backend="compiled"`` and no compiler could build the loop.
    """
    span = (0.0, duration)
    if backend == "compiled":
        run = prepare(
            module, params, method=method, form=form, rtol=rtol, atol=rtol, h=h,
            max_steps=MOST_STEPS,
        )  # fmt: skip
        try:
            end = run(span, y0)
        except NotFinishedError:
            return None
        return TimedRun(median_seconds(lambda: run(span, y0)), run.nfev, run.steps, np.array(end))
    problem = validation.problem(
        module, span, y0, params, method, form, rtol, rtol, h, span[1:], (), MOST_STEPS
    )
    before = time.perf_counter()
    outcome = _outcome(problem)
    first = time.perf_counter() - before
    if outcome.status is not Status.FINISHED:
        return None
    _, rows = outcome.rows()
    seconds = first if first > SECONDS else median_seconds(lambda: _outcome(problem))
    return TimedRun(seconds, outcome.nfev, outcome.steps, rows[-1])


def _outcome(problem: Problem) -> Outcome:
    outcome = Outcome.at_start(problem)
    rung = python_loop if isinstance(problem.method, Tableau) else scipy_loop
    rung.run(problem, outcome)
    return outcome


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
    """Work for an error, between runs from cheap to dear, on logarithmic scales; NaN beyond them.

    An error that a dearer run exceeds again was luck: each run counts with the largest
    error from there on. Where rounding makes errors grow again, the curve ends: with the
    two neighbours of which the worse is best.

    Parameters
    ----------
    error : float
        For which work is wanted.
    errors, works : sequence of float
        What each run misses, and what it costs, from cheap to dear; all positive.

    Returns
    -------
    float
        In the unit of `works`.
    """
    if not errors:
        return float("nan")
    last = least_pair(errors) + 1
    honest = np.maximum.accumulate(list(errors[:last])[::-1])
    if not honest[0] <= error <= honest[-1]:
        return float("nan")
    found = np.interp(np.log(error), np.log(honest), np.log(list(works[:last])[::-1]))
    return float(np.exp(found))


def least_pair(errors: Sequence[float]) -> int:
    """The last run of the two neighbours of which the worse is best."""
    worse = [max(pair) for pair in pairwise(errors)]
    return len(worse) - int(np.argmin(worse[::-1])) if worse else 0
