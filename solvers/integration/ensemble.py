"""Integration of many motions at once: in SIMD lanes, on all cores."""

from collections.abc import Sequence
from functools import partial

from numpy.typing import ArrayLike

from solvers.equations.module import GeneratedModule
from solvers.equations.number_checks import Values
from solvers.equations.signature_checks import known_names
from solvers.integration.given_tolerances import many_motions
from solvers.integration.problem.events import Event
from solvers.integration.problem.inputs import Controller, Held
from solvers.integration.problem.problem import METHOD, Options
from solvers.integration.problem.status import StopFlag
from solvers.integration.results.ensemble_solution import Ensemble


@known_names
def ensemble(
    module: GeneratedModule,
    t_span: ArrayLike | tuple[float, ArrayLike],
    y0: Values,
    params: Values,
    *,
    accuracy: float | None = None,
    method: str | None = None,
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
    accuracy : float, optional
        As in `integrate`, of every returned state: at `t_eval`, and at the end of a motion or the
        event that ends it. Motions for which the loops of an ensemble do not suffice are integrated
        one by one.
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
    solvers.integration.accuracy.accurate_ensemble.AccuracyWarning
        When estimated errors of some motions are above the `accuracy`.
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
    control = (method or METHOD, form, rtol, atol, h)
    options = Options(*control, t_eval, events, max_steps, backend, compensated, inputs)
    run = partial(many_motions, occurrences=occurrences, skip=skip, workers=workers, stop=stop)
    if accuracy is None:
        return run(module, t_span, y0, params, options)
    # loads longer numbers and series, which other motions do not need
    from solvers.integration.accuracy.accurate_ensemble import accurate_ensemble

    return accurate_ensemble(module, t_span, y0, params, options, accuracy, run)
