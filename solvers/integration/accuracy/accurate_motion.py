"""One motion whose returned states have errors below a requested accuracy."""

from dataclasses import replace
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.module import GeneratedModule, has_perturbation, inputs
from solvers.equations.number_checks import Values, positive
from solvers.integration.accuracy.checked_motion import Array, Motion
from solvers.integration.accuracy.checked_run import FINEST, RESERVE, CheckedRun, compile_checks
from solvers.integration.accuracy.integration_run import FINE, SMOOTH, IntegrationRun
from solvers.integration.accuracy.method_choice import MethodChoice, cheapest, usual_form
from solvers.integration.accuracy.sufficient_run import sufficient_run
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.given_tolerances import equations, single_motion
from solvers.integration.loops.compiled_loop import compile_ahead
from solvers.integration.problem import validation
from solvers.integration.problem.inputs import Controller, Held
from solvers.integration.problem.problem import METHOD, Options, Problem
from solvers.integration.problem.status import Status
from solvers.integration.results.solution import Solution

#: The choice whose steps show where a motion is fast.
FINE_CHOICE = MethodChoice(*SMOOTH, "")


def accurate_motion(
    module: GeneratedModule,
    t_span: ArrayLike,
    y0: Values,
    params: Values,
    options: Options,
    accuracy: float,
    *,
    is_named: bool,
    energy: bool = False,
) -> Solution:
    """The solution of `integrate` with this accuracy, whose arguments it describes.

    The method and form of `options` are chosen, unless one of them `is_named`.
    """
    accuracy = positive("accuracy", accuracy)
    check_options(options)
    problem = validation.problem(module, t_span, y0, params, options)
    motion = _motion(problem, options)
    if motion.duration == 0:
        return single_motion(module, t_span, y0, params, options, energy=energy)
    choice = _choice(motion, options, accuracy, is_named=is_named)
    if any(getattr(event, "terminal", False) for event in problem.events):
        motion = _up_to_event(motion, options, accuracy)
    compile_ahead(module, choice.form, choice.method, compensated=choice.compensated)
    compile_checks(IntegrationRun(motion, choice, FINE), motion)
    times = motion.times or IntegrationRun(motion, FINE_CHOICE, FINE).step_times()
    run, _ = sufficient_run(motion, choice, accuracy, motion.ordered([*times, motion.span[1]]))
    if run.computed is None:
        options = replace(options, **run.run.options)
        with ignore_predictability():
            solution = single_motion(module, t_span, y0, params, options, energy=energy)
    elif problem.events:
        raise ValueError(
            f"accuracy = {accuracy:g} needs {run.run.description}, in which no events are located: "
            "request less accuracy, or leave out events"
        )
    else:
        solution = _in_longer_numbers(problem, run, np.array(times), energy=energy)
    error = run.error_estimate
    return replace(
        solution, error_estimate=error, compare=lambda t, y: np.full((len(y), len(t)), error)
    )


def check_options(options: Options) -> None:
    """Refuse options that an accuracy determines."""
    for name in ("rtol", "atol", "h", "max_steps", "backend", "compensated"):
        if np.any(getattr(options, name) != getattr(Options, name)):
            raise ValueError(
                f"{name} = {getattr(options, name)} beside accuracy, which determines it: leave "
                "out one of them"
            )
    if options.form is not None and has_perturbation(options.form):
        raise ValueError(f"accuracy in form {options.form!r}: perturbations are not checked")


def _motion(problem: Problem, options: Options) -> Motion:
    """The motion of a problem, of which the components with inertia are requested."""
    (begin, end), module = problem.span, problem.form.module
    times = () if problem.samples is None else tuple(problem.samples.tolist())
    varying = cast("Held | Controller", options.inputs) if problem.has_varying_inputs else None
    motion = Motion(
        module, tuple(problem.form.constants), tuple(problem.start.tolist()), end - begin,
        tuple(range(len(module.STATE))), times, begin, varying,
    )  # fmt: skip
    motion.require_inertia()
    n = motion.n_coordinates
    return replace(motion, requested=tuple(k for k in motion.requested if k % n in motion.inertial))


def _choice(motion: Motion, options: Options, accuracy: float, *, is_named: bool) -> MethodChoice:
    """The cheapest method choice, or the one with the method or the form that is named."""
    choice = cheapest(motion.module, motion.params, accuracy)
    if is_named:
        form = options.form or usual_form(motion.module, options.method)
        choice = MethodChoice(options.method, form, "as requested", is_named=True)
    return choice if choice.form in motion.forms else replace(choice, form="lagrangian")


def _up_to_event(motion: Motion, options: Options, accuracy: float) -> Motion:
    """The motion up to the event that ends it, if one does."""
    tolerance = max(accuracy * RESERVE, FINEST)
    options = replace(options, method=METHOD, form=None, t_eval=[], rtol=tolerance, atol=tolerance)
    with ignore_predictability():
        first = single_motion(motion.module, motion.span, motion.y0, motion.params, options)
    if first.status is not Status.EVENT:
        return motion
    end = first.end[0]
    times = tuple(t for t in motion.times if abs(t - motion.begin) <= abs(end - motion.begin))
    return replace(motion, duration=end - motion.begin, times=times)


def _in_longer_numbers(
    problem: Problem, checked: CheckedRun, times: Array, *, energy: bool
) -> Solution:
    """The solution whose states are known, and whose steps are not counted."""
    assert checked.computed is not None
    known, states = checked.computed
    row = {t: k for k, t in enumerate(known.tolist())}
    y = states[[row[t] for t in times.tolist()]].T
    module, constants = problem.form.module, problem.form.constants
    count = len(inputs(module))
    return Solution(
        t=times,
        y=y,
        t_events=[],
        y_events=[],
        nfev=0,
        njev=0,
        status=Status.FINISHED,
        message=Status.FINISHED.value,
        steps=0,
        rejected=0,
        run=checked.run.description,
        backend="python" if checked.run.method_choice.is_series else "compiled",
        energy=np.asarray(module.energy_many(times, y, constants)) if energy else None,
        end=(float(known[-1]), states[-1]),
        units=problem.units,
        equations=equations(problem, repeats=False),
        inputs=np.tile(np.array(constants[-count:])[:, np.newaxis], len(times)) if count else None,
    )
