"""Integration in Python by the methods of `solvers.runge_kutta`; compiled loops agree with it."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from solvers.equations.projection import projected
from solvers.integration.loops import scipy_loop
from solvers.integration.loops.attempts import (
    FAILURES,
    Accepted,
    Orders,
    Rejected,
    StepAttempts,
    TimedState,
)
from solvers.integration.loops.switching import is_coarse, run_parts
from solvers.integration.problem.problem import Problem, shortest_step
from solvers.integration.problem.status import Status, StopFlag
from solvers.integration.results.recorder import Outcome, Recorder
from solvers.runge_kutta.step_control import Controller, OrderChoice
from solvers.runge_kutta.stepper import NotFiniteError, Stepper
from solvers.runge_kutta.tableau import Tableau

#: Most successive failures of a step, each of which divides its size by four.
MOST_FAILURES = 25


def run(problem: Problem, outcome: Outcome, stop: StopFlag | None = None) -> None:
    """Integrate `problem`, by SciPy if it has the method; `outcome` holds the results so far.

    Once `stop` is set, the integration ends with the last step.
    """
    problem, stop = problem.starting(), stop or StopFlag()
    if not isinstance(problem.method, Tableau):
        scipy_loop.run(problem, outcome, stop)
        return
    h, members, tolerances = problem.h, problem.method.members, (problem.rtol, problem.atol)
    controllers = [None if h else Controller.of(method, *tolerances) for method in members]
    choice = OrderChoice(len(members))

    def run_part(part: Problem, recorder: Recorder) -> Status:
        nonlocal h
        orders = Orders(_attempts(part, members, controllers), choice)
        try:
            status, h = _run(part, outcome, recorder, orders, h, stop)
        finally:
            outcome.nfev += sum(attempts.stepper.nfev for attempts in orders.members)
            outcome.njev += sum(attempts.stepper.njev for attempts in orders.members)
        return status

    run_parts(problem, outcome, run_part)


def _attempts(
    problem: Problem, members: Sequence[Tableau], controllers: Sequence[Controller | None]
) -> list[StepAttempts]:
    """Attempts by each method of a part of a motion; the controllers are those of all parts."""
    form, tolerances = problem.form, (problem.rtol, problem.atol)
    return [
        StepAttempts(
            Stepper(method, form.rhs, form.jacobian, *tolerances),
            controller,
            partial(projected, form),
        )
        for method, controller in zip(members, controllers, strict=True)
    ]


def _run(
    problem: Problem,
    outcome: Outcome,
    recorder: Recorder,
    orders: Orders,
    h: float | None,
    stop: StopFlag,
) -> tuple[Status, float | None]:
    """Integrate from the recorder's state on, by a first step of size `h`, or of a suitable size.

    Return the status, and the size of the next step.
    """
    (begin, end), attempts = problem.span, orders.attempts
    if begin == end:
        return Status.FINISHED, h
    y = problem.form.from_ordinary(begin, recorder.y)
    try:
        point = TimedState(begin, y, attempts.stepper.derivative(begin, y))
    except NotFiniteError as failure:
        return outcome.fail(failure), h
    shortest, failures, first = shortest_step(begin, end), 0, outcome.steps
    longest_accepted = 0.0
    rejection: ArithmeticError | None = None  # the failure of the last step, if any
    if problem.h is None:
        longest = abs(end - begin)
        h = min(h, longest) if h else attempts.first_step_size(point, end, shortest)
    assert h
    while point.t != end:
        if stop.is_set:
            return Status.INTERRUPTED, h
        if outcome.steps == problem.max_steps:
            return Status.STEP_LIMIT, h
        t = _step_end(problem, point.t, h, outcome.steps - first)
        if h < problem.collapse * longest_accepted and t != end:
            return Status.SINGULAR, h
        if abs(t - point.t) < shortest and t != end:
            status = outcome.fail(rejection) if rejection else Status.STEP_TOO_SMALL
            return status if outcome.cause else Status.STEP_TOO_SMALL, h
        attempts = orders.attempts
        trial, stops = _step(attempts, recorder, point, t, is_last=t == end)
        if isinstance(trial, Rejected):
            outcome.rejected, h, rejection = outcome.rejected + 1, trial.h, trial.failure
            point = replace(point, last=trial.last or point.last)
            failures += trial.failure is not None
            if trial.failure and (attempts.controller is None or failures > MOST_FAILURES):
                return outcome.fail(trial.failure), h
            if trial.failure:
                orders.choice.lower()
            continue
        outcome.steps, failures = outcome.steps + 1, 0
        longest_accepted = max(longest_accepted, abs(t - point.t))
        if stops:
            return Status.EVENT, h
        point = trial.end
        h *= orders.factor(trial, h)
    return Status.FINISHED, h


def _step(
    attempts: StepAttempts, recorder: Recorder, start: TimedState, t: float, *, is_last: bool
) -> tuple[Accepted | Rejected, bool]:
    """An attempt at a step to `t`, recorded if accepted, and whether an event ends the run."""
    h = abs(t - start.t)
    trial = attempts.attempt(start, t, h, is_last=is_last)
    try:
        if isinstance(trial, Rejected):
            return trial, False
        end = trial.end
        if attempts.controller and is_coarse(recorder.form, start.t, start.y, end.t, end.y):
            return Rejected(h / 2), False
        return trial, recorder.advance(t, trial)
    except FAILURES as failure:
        return Rejected(h / 4, failure), False


def _step_end(problem: Problem, t: float, h: float, steps: int) -> float:
    """The end of a step of size `h` from `t`: the end of the time span where that is near."""
    begin, end = problem.span
    direction = np.sign(end - begin)
    # fixed steps are counted, so that their ends do not drift
    aim = t + h * direction if problem.h is None else begin + (steps + 1) * h * direction
    return end if (end - aim) * direction < 1e-9 * h else aim
