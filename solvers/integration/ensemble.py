"""Many motions at once."""

import os
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.arguments import check_module, known_names
from solvers.equations.module import GeneratedModule
from solvers.equations.module import inputs as input_names
from solvers.equations.quantities import Values
from solvers.equations.singularities.mass_matrix import check_condition, examined
from solvers.integration.checks.accuracy_warnings import ensemble_warnings
from solvers.integration.checks.predictability import UnfinishedWarning, is_ignored
from solvers.integration.checks.singularity import SingularityWarning, singularities
from solvers.integration.checks.step_stability import StepWarning, mark_unstable
from solvers.integration.loops import compiled_loop
from solvers.integration.loops.ensemble_loop import EnsembleRun
from solvers.integration.loops.stop_flag import StopFlag
from solvers.integration.problem import memory, validation
from solvers.integration.problem.events import Event, Extremum
from solvers.integration.problem.inputs import Controller, Held
from solvers.integration.problem.problem import EventFunction, Options
from solvers.integration.problem.status import Status
from solvers.integration.results.ensemble_solution import Ensemble
from solvers.integration.results.ensemble_times import EnsembleTimes
from solvers.integration.results.solution import Interrupted
from solvers.io.arguments import check_type
from solvers.io.suggestion import shortened, warn_caller

#: Most threads of one ensemble.
MOST_WORKERS = 1024


@known_names
def ensemble(
    module: GeneratedModule,
    t_span: ArrayLike | tuple[float, ArrayLike],
    y0: Values,
    params: Values,
    *,
    method: str = "verner853",
    form: str | None = None,
    rtol: float = 1e-9,
    atol: float = 1e-12,
    h: float | None = None,
    t_eval: ArrayLike | None = None,
    events: Event | Sequence[Event] = (),
    occurrences: int = 1,
    skip: int | Sequence[int] = 0,
    max_steps: int = 1_000_000,
    backend: str | None = None,
    compensated: bool = False,
    workers: int | None = None,
    stop: StopFlag | None = None,
    inputs: Held | Controller | Values | None = None,
) -> Ensemble:
    """Integrate many motions.

    The results of a motion depend neither on the other motions nor on `workers`.

    Parameters
    ----------
    module, method, form, rtol, atol, h, max_steps, backend, compensated
        As in `integrate`.
    t_span : pair of float, or of float and array_like of shape (n,)
        Start and end time in s; the end may differ from motion to motion.
    y0 : array_like of shape (state, n), or mapping of str to array_like
        As in `integrate`, for each of n motions: ``{"theta1": [0.1, 0.2], "theta2": 0.0}``.
    params : array_like of shape (parameters,) or (parameters, n), or mapping
        As in `integrate`; the same for all motions or different for each.
    t_eval : array_like of shape (times,) or (n, times), optional
        Times in s at which states are recorded, the same for all motions or different for each;
        none by default.
    events : Event or sequence of Event, optional
        Events to locate. Functions, as in `integrate`, are possible in Python only.
    occurrences : int, optional
        How many occurrences of each event to store, counted from the start; with an `Extremum`,
        2 or more.
    skip : int or sequence of int, optional
        How many occurrences of each event come before those and are not stored; one number for
        all events, or one for each. Terminal events cannot be skipped.
    workers : int, optional
        Number of threads; by default one for each processor.
    stop : StopFlag, optional
        Its method ``set`` stops the motions from another thread; there are no warnings then.
    inputs : array_like of shape (inputs,), mapping of str to float, Held or callable, optional
        As in `integrate`, for all motions; constants that differ are given in `params`. A
        controller of `Held` inputs gets the states of all motions, shape (state, n), and returns
        inputs of shape (inputs, n), or (inputs,).

    Returns
    -------
    Ensemble
        Motions in the order of `y0`. One that does not reach its end raises nothing: its
        ``status`` gives the reason.

    Raises
    ------
    ValueError
        When an argument is invalid; other errors, and the warnings, are those of `integrate`, of
        which predictability and mass matrices are examined for four motions, evenly distributed.
    solvers.integration.results.solution.Interrupted
        When the user interrupts; it holds the `Ensemble` up to then.

    Warns
    -----
    solvers.integration.checks.predictability.UnfinishedWarning
        When motions do not reach their ends, for other reasons than the next two.
    solvers.integration.checks.step_stability.StepWarning
        When fixed steps are too long for some motions, whose status is then ``UNSTABLE``.
    solvers.integration.checks.singularity.SingularityWarning
        When motions fail where coordinates are singular, as an orientation at gimbal lock.
    UserWarning
        When the motions are integrated in Python, one after another; it states the reason.

    Examples
    --------
    >>> import numpy as np
    >>> import generated.double_pendulum as dp
    >>> y0 = {"theta1": np.linspace(0, 2, 20), "theta2": 0.0}
    >>> motions = ensemble(dp, (0, 5), y0, dp.DEFAULTS)
    >>> motions.y.shape
    (4, 20)
    >>> dp.energy_many(0.0, motions.y, dp.DEFAULTS).shape
    (20,)
    """
    check_type("stop", stop, StopFlag | None, "a StopFlag")
    options = Options(
        method, form, rtol, atol, h, (), events, max_steps, backend, compensated, inputs
    )
    check_module(module)
    check_type("form", form, str | None, "the name of a form")
    states = validation.state_rows(module, y0, form or "lagrangian")
    memory.check_times(t_eval, states.shape[1])
    times = EnsembleTimes.of(t_span, t_eval, len(states))
    problem = validation.problem_at_rest(module, times.span, options)
    if times.differ and problem.schedule:
        raise ValueError("inputs are held between samples: t_span must be the same for all motions")
    constants = validation.parameter_rows(module, params, len(states), problem.form.name)
    if inputs is not None:
        count = len(input_names(module))
        constants[:, -count:] = problem.form.params[-count:]
    own = constants.copy()
    if problem.schedule:
        count = len(input_names(module))
        held = validation.params_at_start(problem.form, problem.schedule, problem.span)
        own[:, -count:] = held[-count:]
    name = problem.form.name
    states = validation.consistent_rows(module, y0, states, own, problem.span[0], name)
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
    memory.check_memory(f"{rows} states of {len(states)} motions", rows, components, remedy)
    loop = f"compiled by {program.library.compiler}" if program else "python"
    result = Ensemble.empty(problem, len(states), occurrences, loop, times.samples)
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
