"""Integration by SciPy's methods, with the samples, events and statuses of this package."""

from collections.abc import Callable
from functools import cache

import numpy as np
from scipy import integrate

from solvers.integration.inputs import segments
from solvers.integration.problem import Outcome, Problem
from solvers.integration.recorder import Recorder
from solvers.integration.solution import Array, Status
from solvers.integration.stop_flag import StopFlag
from solvers.runge_kutta.stepper import NotFiniteError, Rhs, evaluated


def run(problem: Problem, outcome: Outcome, stop: StopFlag) -> None:
    """Integrate `problem` until `stop` is set; `outcome` holds the results so far at any time."""
    outcome.backend = "scipy"
    try:
        recorder, status = Recorder(problem, outcome), Status.FINISHED
        for part in segments(problem, lambda: recorder.y, outcome.history):
            status = _run(part, outcome, recorder, stop)
            if status is not Status.FINISHED:
                break
        outcome.end_with(status, problem)
    except NotFiniteError:
        outcome.status = Status.NOT_FINITE


def _run(problem: Problem, outcome: Outcome, recorder: Recorder, stop: StopFlag) -> Status:
    if problem.span[0] == problem.span[1]:
        return Status.FINISHED
    solver = _solver(problem, outcome, recorder.y)
    while solver.status == "running":
        if stop.is_set:
            return Status.INTERRUPTED
        if outcome.steps == problem.max_steps:
            return Status.STEP_LIMIT
        solver.step()
        if solver.status == "failed":
            return Status.STEP_TOO_SMALL
        outcome.steps += 1
        state, states = _states_within(problem, solver)
        if recorder.advance(solver.t, state, states, [states]):
            return Status.EVENT
    return Status.FINISHED


def _solver(problem: Problem, outcome: Outcome, y0: Array) -> integrate.OdeSolver:
    form, method, (begin, end) = problem.form, str(problem.method), problem.span

    def rhs(t: float, z: Array) -> Array:
        outcome.nfev += 1
        return _finite("right-hand side", form.rhs, t, z, z.shape)

    def jacobian(t: float, z: Array) -> Array:
        outcome.njev += 1
        return _finite("Jacobian", form.jacobian, t, z, (len(z), len(z)))

    options = {"rtol": problem.rtol, "atol": problem.atol}
    if form.has_jacobian and method in ("Radau", "BDF", "LSODA"):
        options["jac"] = jacobian
    z = form.from_ordinary(begin, y0)
    return getattr(integrate, method)(rhs, begin, z, end, **options)


def _states_within(
    problem: Problem, solver: integrate.OdeSolver
) -> tuple[Callable[[float], Array], Callable[[Array], Array]]:
    """The state at a time within the last step, and those at several times."""
    dense_output = cache(solver.dense_output)  # it may cost evaluations

    def state(time: float) -> Array:
        z = solver.y if time == solver.t else dense_output()(time)
        return problem.form.normalised(z)

    def states(times: Array) -> Array:
        z = dense_output()(times)
        z[:, times == solver.t] = solver.y[:, np.newaxis]
        return problem.form.normalised(z)

    return state, states


def _finite(what: str, function: Rhs, t: float, z: Array, shape: tuple[int, ...]) -> Array:
    """The value of `function`; SciPy would not end, or report success, with NaN or infinity."""
    try:
        value = evaluated(what, function, t, z, shape)
    except ArithmeticError as error:
        raise NotFiniteError(f"at t = {t}, y = {z}: {error}") from error
    if not (np.isfinite(z).all() and np.isfinite(value).all()):
        raise NotFiniteError(f"at t = {t}, y = {z} it is {value}")
    return value
