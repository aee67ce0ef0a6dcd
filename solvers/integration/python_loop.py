"""Integration in Python by the methods of `solvers.runge_kutta`; compiled loops agree with it."""

from __future__ import annotations

import numpy as np

from solvers.integration import scipy_loop
from solvers.integration.attempt import FAILURES, Accepted, Attempts, Point, Rejected
from solvers.integration.problem import Outcome, Problem, shortest_step
from solvers.integration.recorder import Recorder
from solvers.integration.solution import Status
from solvers.runge_kutta.stepper import NoConvergenceError, NotFiniteError, Stepper
from solvers.runge_kutta.tableau import Tableau

#: Most successive failures of a step, each of which divides its size by four.
MOST_FAILURES = 25


def run(problem: Problem, outcome: Outcome) -> None:
    """Integrate `problem`, by SciPy if it has the method; `outcome` holds the results so far."""
    if not isinstance(problem.method, Tableau):
        scipy_loop.run(problem, outcome)
        return
    stepper = Stepper(problem.method, problem.form.rhs, problem.form.jacobian)
    try:
        outcome.status = _run(problem, outcome, stepper)
    finally:
        outcome.nfev, outcome.njev = stepper.nfev, stepper.njev


def _run(problem: Problem, outcome: Outcome, stepper: Stepper) -> Status:
    recorder, (begin, end) = Recorder(problem, outcome), problem.span
    if begin == end:
        return Status.FINISHED
    attempts = Attempts(stepper, problem.controller, problem.form.normalised)
    y = problem.form.from_ordinary(begin, recorder.y)
    try:
        point = Point(begin, y, stepper.derivative(begin, y))
    except NotFiniteError:
        return Status.NOT_FINITE
    shortest, failures = shortest_step(begin, end), 0
    h = problem.h or attempts.first_step_size(point, end, shortest)
    while point.t != end:
        if outcome.steps == problem.max_steps:
            return Status.STEP_LIMIT
        t = _step_end(problem, point.t, h, outcome.steps)
        if abs(t - point.t) < shortest and t != end:
            return Status.STEP_TOO_SMALL
        trial, stops = _step(attempts, recorder, point, t, is_last=t == end)
        if isinstance(trial, Rejected):
            outcome.rejected, h = outcome.rejected + 1, trial.h
            failures += trial.failure is not None
            if trial.failure and (attempts.controller is None or failures > MOST_FAILURES):
                unsolved = isinstance(trial.failure, NoConvergenceError)
                return Status.NO_CONVERGENCE if unsolved else Status.NOT_FINITE
            continue
        outcome.steps, failures = outcome.steps + 1, 0
        if stops:
            return Status.EVENT
        point = trial.end
        if attempts.controller:
            h *= attempts.controller.factor(trial.norm)
    return Status.FINISHED


def _step(
    attempts: Attempts, recorder: Recorder, start: Point, t: float, *, is_last: bool
) -> tuple[Accepted | Rejected, bool]:
    """An attempt at a step to `t`, recorded if accepted, and whether an event ends the run."""
    h = abs(t - start.t)
    trial = attempts.attempt(start, t, h, is_last=is_last)
    try:
        return trial, isinstance(trial, Accepted) and recorder.advance(t, trial.state)
    except FAILURES as failure:
        return Rejected(h / 4, failure), False


def _step_end(problem: Problem, t: float, h: float, steps: int) -> float:
    """The end of a step of size `h` from `t`: the end of the time span where that is near."""
    begin, end = problem.span
    direction = np.sign(end - begin)
    # fixed steps are counted, so that their ends do not drift
    aim = t + h * direction if problem.h is None else begin + (steps + 1) * h * direction
    return end if (end - aim) * direction < 1e-9 * h else aim
