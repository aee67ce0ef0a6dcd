"""Motions, one or many, with given tolerances or a given step size."""

import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.module import GeneratedModule, has_perturbation
from solvers.equations.module import inputs as input_names
from solvers.equations.number_checks import NotFiniteNumberError, Values
from solvers.equations.signature_checks import check_module
from solvers.equations.singularities import check_condition, checked_before, examined
from solvers.integration.checks.accuracy_warnings import accuracy_warnings, ensemble_warnings
from solvers.integration.checks.global_error import global_error_estimate
from solvers.integration.checks.predictability import (
    UnfinishedWarning,
    compile_perturbations,
    ignore_predictability,
    is_ignored,
)
from solvers.integration.checks.singularity import SingularityWarning, singularities, singularity
from solvers.integration.checks.step_stability import StepWarning, mark_unstable, step_instability
from solvers.integration.loops import compiled_loop, singular_passage
from solvers.integration.loops.ensemble_loop import EnsembleRun
from solvers.integration.problem import validation
from solvers.integration.problem.events import Extremum
from solvers.integration.problem.problem import (
    EventFunction,
    Options,
    Problem,
    check_memory,
    check_times,
    limit_steps,
)
from solvers.integration.problem.status import Status, StopFlag
from solvers.integration.results.ensemble_solution import Ensemble, EnsembleTimes
from solvers.integration.results.recorder import Outcome
from solvers.integration.results.solution import Interrupted, Solution, SolvedEquations
from solvers.io.argument_types import check_type
from solvers.io.suggestion import shortened, warn_caller
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
        singular_passage.run(problem, outcome, program)
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
        unknown = np.full((count, len(t)), np.nan)  # interrupted at the first sample
        return outcome.history.at(t) if outcome.history.times else unknown
    if problem.form.feedback:
        values = np.full((len(t), count), np.nan)
        for k, point in enumerate(zip(t.tolist(), y.T, strict=True)):
            with suppress(NotFiniteNumberError):
                values[k] = problem.form.feedback(*point)
        return values.T
    constants = np.array(problem.form.params[-count:])
    return np.tile(constants[:, np.newaxis], len(t))


#: Most threads of one ensemble.
MOST_WORKERS = 1024


@dataclass(frozen=True)
class MotionBatch:
    """Checked arguments of `ensemble`: initial states and parameters of all motions, in rows."""

    problem: Problem
    states: Array
    constants: Array  # one row for all motions or one for each
    times: EnsembleTimes

    def alone(self, options: Options, k: int) -> Solution:
        """Motion `k` by itself."""
        module, times, constants = self.problem.form.module, self.times, self.constants
        own = replace(options, t_eval=None, events=self.problem.events)
        if self.problem.schedule is None and self.problem.form.feedback is None:
            own = replace(own, inputs=None)  # constants that differ between motions
        span, params = (times.begin, times.end(k)), constants[k % len(constants)]
        with ignore_predictability():
            return single_motion(module, span, self.states[k], params, own)

    @classmethod
    def of(
        cls,
        module: GeneratedModule,
        t_span: ArrayLike | tuple[float, ArrayLike],
        y0: Values,
        params: Values,
        options: Options,
    ) -> Self:
        """From the arguments; ValueError where one is invalid."""
        check_module(module)
        check_type("form", options.form, str | None, "the name of a form")
        states = validation.state_rows(module, y0, params, options.form or "lagrangian")
        check_times(options.t_eval, states.shape[1])
        times = EnsembleTimes.of(t_span, options.t_eval, len(states))
        problem = validation.problem_at_rest(module, times.span, replace(options, t_eval=()))
        if times.differ and problem.schedule:
            raise ValueError(
                "inputs are held between samples: t_span must be the same for all motions"
            )
        constants = validation.parameter_rows(module, params, len(states), problem.form.name)
        if options.inputs is not None:
            count = len(input_names(module))
            constants[:, -count:] = problem.form.params[-count:]
        own = constants.copy()
        if problem.schedule:
            count = len(input_names(module))
            held = validation.params_at_start(problem.form, problem.schedule, problem.span)
            own[:, -count:] = held[-count:]
        name = problem.form.name
        states = validation.consistent_rows(module, y0, states, own, problem.span[0], name)
        return cls(problem, states, constants, times)


def many_motions(
    module: GeneratedModule,
    t_span: ArrayLike | tuple[float, ArrayLike],
    y0: Values,
    params: Values,
    options: Options,
    *,
    occurrences: int = 1,
    skip: int | Sequence[int] = 0,
    workers: int | None = None,
    stop: StopFlag | None = None,
) -> Ensemble:
    """The motions of `ensemble` with these options, whose arguments it describes."""
    check_type("stop", stop, StopFlag | None, "a StopFlag")
    motions = MotionBatch.of(module, t_span, y0, params, options)
    problem, states, constants, times = (
        motions.problem, motions.states, motions.constants, motions.times
    )  # fmt: skip
    extremes = any(isinstance(event, Extremum) for event in problem.events)
    occurrences = validation.count("occurrences", occurrences, 2 if extremes else 1)
    skipped = _skipped(skip, problem.events)
    processors = len(os.sched_getaffinity(0))
    threads = validation.count(
        "workers", processors if workers is None else workers, 1, MOST_WORKERS
    )
    unperturbed = constants[:, constants.shape[1] - len(module.PARAMETERS) :]
    some = [
        (f"motion {k}: ", unperturbed[k % len(unperturbed)].tolist(), states[k].tolist())
        for k in examined(len(states))
    ]
    check_condition(module, some, problem.span[0])
    problem, program = compiled_loop.select(problem, lanes=True)
    components = len(problem.start)
    rows = len(states) * (1 + times.samples.shape[1] + len(problem.events) * occurrences)
    remedy = "integrate fewer motions at once, or record fewer times and occurrences"
    check_memory(f"{rows} states of {len(states)} motions", rows, components, remedy)
    loop = f"compiled by {program.library.compiler}" if program else "python"
    result = Ensemble.empty(problem, len(states), occurrences, loop, times.samples)
    result = replace(result, alone=partial(motions.alone, options))
    run = EnsembleRun(problem, states, constants, times, skipped, result, stop or StopFlag())
    try:
        if program:
            run.run_compiled(program, threads)
        else:
            run.run_one_by_one()
        run.pass_singularities()
    except KeyboardInterrupt as interruption:
        raise Interrupted(result) from interruption
    if run.stop.is_set:
        return result
    unstable = mark_unstable(problem, states, constants, result)
    if unstable:
        warn_caller(unstable, StepWarning)
    singular = singularities(problem, states, constants, result)
    if singular:
        warn_caller(singular, SingularityWarning)
    if not (unstable or singular or result.success.all() or is_ignored()):
        lost = [status for status in result.status if status not in (Status.FINISHED, Status.EVENT)]
        text = "; ".join(f"{lost.count(status)}: {status.value}" for status in dict.fromkeys(lost))
        text = f"{len(lost)} of {len(states)} motions did not reach their end: {text}"
        warn_caller(text, UnfinishedWarning)
    good = np.flatnonzero(result.success)
    own = constants[good] if len(constants) > 1 else constants
    ends = result.t[good], result.y.T[good]
    for warning in ensemble_warnings(problem, states[good], own, *ends):
        warn_caller(warning)
    return result


def _skipped(skip: int | Sequence[int], events: Sequence[EventFunction]) -> list[int]:
    """How many occurrences of each event are not stored."""
    try:
        given = [skip] * len(events) if isinstance(skip, int | np.integer) else [*skip]
    except TypeError as error:
        allowed = "must be a whole number, or one for each event"
        raise ValueError(f"skip = {shortened(skip)} {allowed}") from error
    if len(given) != len(events):
        raise ValueError(f"skip has {len(given)} numbers for {len(events)} events: give one each")
    for event, number in zip(events, given, strict=True):
        validation.count("skip", number, 0)
        if number and getattr(event, "terminal", False):
            raise ValueError(f"skip = {number}, but the event is terminal: it ends the motion")
    return given
