"""Many motions at once."""

from __future__ import annotations

import os
from collections.abc import Sequence

from numpy.typing import ArrayLike

from solvers.equations.module import GeneratedModule
from solvers.integration import compiled_loop, validation
from solvers.integration.ensemble_run import EnsembleRun, StopFlag
from solvers.integration.ensemble_solution import Ensemble
from solvers.integration.events import Event, Extremum
from solvers.integration.problem import Options
from solvers.integration.solution import Interrupted
from solvers.integration.validation import Values


def ensemble(
    module: GeneratedModule,
    t_span: ArrayLike,
    y0: Values,
    params: Values,
    *,
    method: str = "verner87",
    form: str | None = None,
    rtol: float = 1e-9,
    atol: float = 1e-12,
    h: float | None = None,
    t_eval: ArrayLike | None = None,
    events: Event | Sequence[Event] = (),
    occurrences: int = 1,
    max_steps: int = 1_000_000,
    backend: str | None = None,
    compensated: bool = False,
    workers: int | None = None,
    stop: StopFlag | None = None,
) -> Ensemble:
    """Integrate many motions over the same time span.

    The results of a motion depend neither on the other motions nor on `workers`.

    Parameters
    ----------
    module : module
        A generated module, such as ``generated.double_pendulum``.
    t_span : pair of float
        Start and end in s; the end may be the earlier one.
    y0 : array_like of shape (state, n), or mapping of str to array_like
        Initial coordinates and velocities of each motion, in the order of ``module.STATE``; in
        the variational form followed by a small change. Or arrays and numbers by name, as
        ``{"theta1": [0.1, 0.2], "theta2": 0.0}``: velocities that are left out are 0.
    params : array_like of shape (parameters,) or (parameters, n), or mapping
        In the order of ``module.PARAMETERS``; the same for all motions or different for each. Or
        numbers and arrays by name: parameters that are left out have their default values.
    method, form, rtol, atol, h, max_steps, backend, compensated : optional
        As in `solvers.integrate`.
    t_eval : array_like of shape (times,), optional
        Times in s at which states are recorded; none by default.
    events : Event or sequence of Event, optional
        Events to locate.
    occurrences : int, optional
        How many occurrences of each event to store, counted from the start. Of an
        `solvers.Extremum` those with the smallest and the largest value are stored, so that it
        must be 2 or more.
    workers : int, optional
        Number of threads; by default one for each processor.
    stop : StopFlag, optional
        Its method ``set`` stops the motions from another thread.

    Returns
    -------
    Ensemble
        Motions in the order of `y0`. One that does not reach its end raises nothing: its
        ``status`` gives the reason.

    Raises
    ------
    ValueError
        When an argument is invalid, before anything is computed.
    solvers.runge_kutta.catalogue.UnknownMethodError
        When no method has this name.
    solvers.integration.compiled.compiler.NoCompilerError
        When ``backend="compiled"`` or ``compensated=True``, and no compiler could build the loop.
    solvers.integration.solution.Interrupted
        When the user interrupts; it holds the `Ensemble` up to then.

    Warns
    -----
    UserWarning
        When no compiler could build the loop, and it runs in Python.

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
    times = () if t_eval is None else t_eval
    options = Options(method, form, rtol, atol, h, times, events, max_steps, backend, compensated)
    problem = validation.problem_at_rest(module, t_span, options)
    states = validation.state_rows(module, y0, problem.form.name)
    constants = validation.parameter_rows(module, params, len(states))
    extremes = any(isinstance(event, Extremum) for event in problem.events)
    occurrences = validation.count("occurrences", occurrences, 2 if extremes else 1)
    threads = len(os.sched_getaffinity(0)) if workers is None else workers
    threads = validation.count("workers", threads, 1)
    problem, program = compiled_loop.select(problem, lanes=True)
    backend_name = f"compiled by {program.library.compiler}" if program else "python"
    assert problem.samples is not None
    shape, about = (len(problem.events), occurrences), f"{problem.description}, {backend_name}"
    result = Ensemble.empty(len(states), problem.units, problem.samples, shape, about)
    run = EnsembleRun(problem, states, constants, result, stop or StopFlag())
    try:
        if program:
            run.run_compiled(program, threads)
        else:
            run.run_one_by_one()
    except KeyboardInterrupt as interruption:
        raise Interrupted(result) from interruption
    return result
