"""SciPy's own methods, on our forms and with our samples, events and statuses."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy import integrate

from solvers.integration.problem import Outcome, Problem
from solvers.integration.recorder import Record
from solvers.integration.solution import Status
from solvers.runge_kutta.stepper import NotFiniteError

Array = NDArray[np.float64]


def run(problem: Problem, outcome: Outcome) -> None:
    """Integrate `problem` by a solver of SciPy's, keeping in `outcome` what is found."""
    form, (begin, end) = problem.form, problem.span
    record = Record(problem, outcome)
    outcome.backend = "scipy"
    if begin == end:
        outcome.status = Status.FINISHED
        return

    def rhs(t: float, z: Array) -> Array:
        outcome.nfev += 1
        # SciPy's solvers would go on for ever, or succeed, with what is not a number
        return _finite(form.rhs, t, z)

    def jacobian(t: float, z: Array) -> Array:
        outcome.njev += 1
        return _finite(form.jacobian, t, z)

    method = problem.method
    takes_jacobian = form.has_jacobian and method in ("Radau", "BDF", "LSODA")
    implicit = {"jac": jacobian} if takes_jacobian else {}
    try:
        solver = getattr(integrate, str(method))(
            rhs, begin, form.from_ordinary(begin, record.place), end,
            rtol=problem.rtol, atol=problem.atol, **implicit,
        )  # fmt: skip
        while solver.status == "running":
            if outcome.steps == problem.max_steps:
                outcome.status = Status.STEP_LIMIT
                return
            solver.step()
            if solver.status == "failed":
                outcome.status = Status.STEP_TOO_SMALL
                return
            outcome.steps += 1
            if record.advance(solver.t, _within(problem, solver)):
                outcome.status = Status.EVENT
                return
    except NotFiniteError:
        outcome.status = Status.NOT_FINITE
        return
    outcome.status = Status.FINISHED


def _within(problem: Problem, solver: integrate.OdeSolver) -> Callable[[float], Array]:
    dense: list[Callable[[float], Array]] = []

    def inside(time: float) -> Array:
        if time == solver.t:
            return problem.form.normalised(solver.y)
        if not dense:  # it may cost evaluations
            dense.append(solver.dense_output())
        return problem.form.normalised(dense[0](time))

    return inside


def _finite(function: Callable[[float, Array], Array], t: float, z: Array) -> Array:
    try:
        value = function(t, z)
    except ArithmeticError as error:
        raise NotFiniteError(f"at t = {t}, y = {z}: {error}") from error
    if not (np.isfinite(z).all() and np.isfinite(value).all()):
        raise NotFiniteError(f"at t = {t}, y = {z} it is {value}")
    return value
