"""Integration by SciPy's methods, with the samples, events and statuses of this package."""

from collections.abc import Callable
from functools import cached_property
from typing import cast

import numpy as np
import scipy

from solvers.equations.forms import Form
from solvers.equations.projection import projected
from solvers.integration.loops.switching import run_parts
from solvers.integration.problem.problem import Problem
from solvers.integration.problem.status import Status, StopFlag
from solvers.integration.results.event_location import Curve
from solvers.integration.results.recorder import Outcome, Recorder
from solvers.runge_kutta.stepper import Array, NotFiniteError, Rhs, evaluated


class DenseOutput:
    """States within the last step of a solver."""

    def __init__(self, form: Form, solver: "scipy.integrate.OdeSolver") -> None:
        self._form, self._solver = form, solver

    @cached_property
    def _interpolant(self) -> Callable[[Array], Array]:
        return cast("Callable[[Array], Array]", self._solver.dense_output())  # may be expensive

    def state(self, t: float) -> Array:
        """The state at a time."""
        if t == self._solver.t:
            return projected(self._form, t, self._solver.y)
        return self.states(np.array([t]))[:, 0]

    def states(self, times: Array) -> Array:
        """The states at several times, in columns."""
        z = self._interpolant(times)
        z[:, times == self._solver.t] = self._solver.y[:, np.newaxis]
        pairs = zip(times.tolist(), z.T, strict=True)
        return np.stack([projected(self._form, t, y) for t, y in pairs], axis=1)

    def between(self, _begin: float, _y0: Array, _end: float, _y1: Array) -> Curve:
        """States at several times."""
        return self.states

    def curves(self) -> list[Curve]:
        """The states themselves."""
        return [self.states]


def run(problem: Problem, outcome: Outcome, stop: StopFlag) -> None:
    """Integrate `problem` until `stop` is set; `outcome` holds the results so far at any time."""
    outcome.backend = "scipy"
    run_parts(problem, outcome, lambda part, recorder: _run(part, outcome, recorder, stop))


def _run(problem: Problem, outcome: Outcome, recorder: Recorder, stop: StopFlag) -> Status:
    if problem.span[0] == problem.span[1]:
        return Status.FINISHED
    solver, longest = _solver(problem, outcome, recorder.y), 0.0
    while solver.status == "running":
        if stop.is_set:
            return Status.INTERRUPTED
        if outcome.steps == problem.max_steps:
            return Status.STEP_LIMIT
        solver.step()
        if solver.status == "failed":
            return Status.STEP_TOO_SMALL
        outcome.steps += 1
        try:
            ends = recorder.advance(solver.t, DenseOutput(problem.form, solver))
        except ArithmeticError as failure:  # as of constraints that depend on each other there
            return outcome.fail(failure)
        if ends:
            return Status.EVENT
        longest = max(longest, solver.step_size)
        if solver.step_size < problem.collapse * longest and solver.status == "running":
            return Status.SINGULAR
    return Status.FINISHED


def _solver(problem: Problem, outcome: Outcome, y0: Array) -> "scipy.integrate.OdeSolver":
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
    return getattr(scipy.integrate, method)(rhs, begin, z, end, **options)


def _finite(what: str, function: Rhs, t: float, z: Array, shape: tuple[int, ...]) -> Array:
    """The value of `function`; SciPy would not end, or report success, with NaN or infinity."""
    try:
        value = evaluated(what, function, t, z, shape)
    except ArithmeticError as error:
        raise NotFiniteError(f"at t = {t}, y = {z}: {error}") from error
    if not (np.isfinite(z).all() and np.isfinite(value).all()):
        raise NotFiniteError(f"at t = {t}, y = {z} it is {value}")
    return value
