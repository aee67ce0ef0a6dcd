"""Any of our methods, step by step in Python. Compiled loops agree with it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from solvers.integration.problem import SHORTEST, Outcome, Problem
from solvers.integration.recorder import Record
from solvers.integration.solution import Status
from solvers.runge_kutta.stepper import NoConvergenceError, NotFiniteError, Stepper
from solvers.runge_kutta.tableau import Tableau

Array = NDArray[np.float64]

#: How often a step is cut to a quarter because a stage fails, before the run stops.
MOST_CUTS = 25


def run(problem: Problem, outcome: Outcome) -> None:
    """Integrate `problem`, keeping in `outcome` what is found as it is found."""
    assert isinstance(problem.method, Tableau)
    form = problem.form
    stepper = Stepper(problem.method, form.rhs, form.jacobian)
    try:
        outcome.status = _run(problem, outcome, stepper)
    finally:
        outcome.nfev, outcome.njev = stepper.nfev, stepper.njev


def _run(problem: Problem, outcome: Outcome, stepper: Stepper) -> Status:
    form, controller = problem.form, problem.controller
    record = Record(problem, outcome)
    begin, end = problem.span
    direction = np.sign(end - begin)
    t, z = begin, form.from_ordinary(begin, record.place)
    if t == end:
        return Status.FINISHED
    try:
        first = stepper.derivative(t, z)
    except NotFiniteError:
        return Status.NOT_FINITE
    shortest = SHORTEST * float(np.spacing(max(abs(t), abs(end))))
    cuts = 0
    if controller is None:
        assert problem.h is not None
        size = problem.h
    else:
        guess = controller.first_step(stepper.derivative, t, z, first, end - t)
        size = max(guess, 2 * shortest)
    while t != end:
        if outcome.steps == problem.max_steps:
            return Status.STEP_LIMIT
        aim = t + size * direction
        if controller is None:  # fixed steps are counted, so that their ends do not drift
            aim = begin + (outcome.steps + 1) * size * direction
        if (end - aim) * direction < 1e-9 * size:
            aim = end
        if abs(aim - t) < shortest and aim != end:
            return Status.STEP_TOO_SMALL
        try:
            z_end, error, last = stepper.step(t, z, aim - t, first)
            norm = 0.0 if controller is None else controller.norm(error, z, z_end)
            z_end = form.normalised(z_end)
            if not np.isfinite(z_end).all() or not np.isfinite(norm):
                raise NotFiniteError("the state is not finite")
            stop = False
            if norm <= 1:
                following = first if last is None else last
                if last is None and aim != end:  # the end of the run needs no slope
                    following = stepper.derivative(aim, z_end)

                def inside(
                    time: float, t: float = t, z: Array = z, first: Array = first,
                    aim: float = aim, z_end: Array = z_end,
                ) -> Array:  # fmt: skip
                    if time == aim:
                        return z_end
                    return form.normalised(stepper.step(t, z, time - t, first)[0])

                stop = record.advance(aim, inside)
        except (NotFiniteError, NoConvergenceError) as failure:
            outcome.rejected, cuts = outcome.rejected + 1, cuts + 1
            if controller is None or cuts > MOST_CUTS:
                lost = isinstance(failure, NoConvergenceError)
                return Status.NO_CONVERGENCE if lost else Status.NOT_FINITE
            size = abs(aim - t) / 4
            continue
        if norm > 1 and controller is not None:
            outcome.rejected += 1
            size = abs(aim - t) * controller.factor(norm)
            continue
        outcome.steps, cuts = outcome.steps + 1, 0
        if stop:
            return Status.EVENT
        t, z, first = aim, z_end, following
        if controller is not None:
            size *= controller.factor(norm)
    return Status.FINISHED
