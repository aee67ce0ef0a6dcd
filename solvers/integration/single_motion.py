"""One motion, integrated with given tolerances or a given step size."""

from contextlib import suppress
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.module import GeneratedModule, has_perturbation
from solvers.equations.module import inputs as input_names
from solvers.equations.number_checks import NotFiniteNumberError, Values
from solvers.equations.singularities.mass_matrix import check_condition, checked_before
from solvers.integration.checks.accuracy_warnings import accuracy_warnings
from solvers.integration.checks.global_error import global_error_estimate
from solvers.integration.checks.predictability import (
    UnfinishedWarning,
    compile_perturbations,
    ignore_predictability,
    is_ignored,
)
from solvers.integration.checks.singularity import singularity
from solvers.integration.checks.step_stability import step_instability
from solvers.integration.loops import compiled_loop, passage
from solvers.integration.problem import validation
from solvers.integration.problem.memory import limit_steps
from solvers.integration.problem.problem import Options, Problem
from solvers.integration.problem.status import Status
from solvers.integration.results.recorder import Outcome
from solvers.integration.results.solution import Interrupted, Solution, SolvedEquations
from solvers.io.suggestion import warn_caller
from solvers.runge_kutta.stepper import Array


def single_motion(
    module: GeneratedModule,
    t_span: ArrayLike,
    y0: Values,
    params: Values,
    options: Options,
    *,
    energy: bool = False,
) -> Solution:
    """The solution of `integrate` with these options, whose arguments it describes."""
    problem = validation.problem(module, t_span, y0, params, options)
    check_condition(module, [("", problem.form.constants, problem.start.tolist())], problem.span[0])
    compile_perturbations(problem)
    problem, program = compiled_loop.select(problem, lanes=False)
    problem = replace(problem, max_steps=limit_steps(problem))
    outcome = Outcome.at_start(problem)
    try:
        passage.run(problem, outcome, program)
    except KeyboardInterrupt as interruption:
        raise Interrupted(_solution(problem, outcome, energy)) from interruption
    instability = step_instability(problem, outcome)
    if instability:
        outcome.status = Status.UNSTABLE
    detail = instability or singularity(problem, outcome.status, outcome.end)
    solution = _solution(problem, outcome, energy, detail)
    if solution.success:
        for warning in accuracy_warnings(problem, *outcome.end):
            warn_caller(warning)
    elif not is_ignored():
        warn_caller(solution.message, UnfinishedWarning)
    return solution


def _solution(problem: Problem, outcome: Outcome, energy: bool, detail: str = "") -> Solution:
    (times, rows), (t, y), form = outcome.rows(), outcome.end, problem.form
    events = len(problem.events)
    if outcome.status is not Status.FINISHED:
        state = ", ".join(f"{name} = {x:.6g}" for name, x in zip(problem.units, y, strict=True))
        detail = f" (t = {t}, {state})" if not detail else f" ({detail})"
        detail = f": {outcome.cause}{detail}" if outcome.cause else detail
    if outcome.status is Status.STEP_LIMIT and problem.max_steps < problem.options.max_steps:
        detail += ": the states of more steps do not fit into memory, give times t_eval"
    states, energies = rows.T[: len(form.module.STATE)], None
    if energy:
        energies = np.asarray(form.module.energy_many(times, states, form.constants))
    return Solution(
        t=times,
        y=rows.T,
        t_events=[np.array(roots) for roots in outcome.t_events[:events]],
        y_events=[np.array(rows).reshape(-1, len(y)) for rows in outcome.y_events[:events]],
        nfev=outcome.nfev,
        njev=outcome.njev,
        status=outcome.status,
        message=outcome.status.value + detail,
        steps=outcome.steps,
        rejected=outcome.rejected,
        run=f"{problem.description}, {outcome.backend}",
        backend=outcome.backend.partition(" ")[0],
        energy=energies,
        end=outcome.end,
        units=problem.units,
        inputs=_inputs(problem, outcome, times, states),
        compare=partial(global_error_estimate, problem),
        equations=equations(problem),
    )


def equations(problem: Problem, *, repeats: bool = True) -> SolvedEquations:
    """What shows the motion of a problem; its states only where it `repeats`."""
    form, varies = problem.form, problem.has_varying_inputs
    options = replace(problem.options, events=(), form=None if varies else problem.options.form)

    def states(times: Array) -> Array:
        again = replace(options, t_eval=times)
        if has_perturbation(form.name):
            again = replace(again, form=None)
        start, span = problem.start[: len(form.module.STATE)], (problem.span[0], times[-1])
        if span[0] == span[1]:
            return np.tile(start, (len(times), 1))
        with ignore_predictability(), checked_before():
            motion = single_motion(form.module, span, start, form.constants, again)
        return motion.y[: len(start)].T

    return SolvedEquations(
        form.module, tuple(form.constants), problem.span[0], states if repeats else None, varies
    )


def _inputs(problem: Problem, outcome: Outcome, t: Array, y: Array) -> Array | None:
    """The inputs at times `t` and states `y` in columns; None for a system without inputs."""
    count = len(input_names(problem.form.module))
    if not count:
        return None
    if problem.schedule:
        return outcome.history.at(t) if outcome.history.times else np.empty((count, 0))
    if problem.form.feedback:
        values = np.full((len(t), count), np.nan)
        for k, point in enumerate(zip(t.tolist(), y.T, strict=True)):
            with suppress(NotFiniteNumberError):
                values[k] = problem.form.feedback(*point)
        return values.T
    constants = np.array(problem.form.params[-count:])
    return np.tile(constants[:, np.newaxis], len(t))
