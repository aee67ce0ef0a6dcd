"""How a motion depends on its start and on parameters: samples, events and the end."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import cast
from warnings import catch_warnings, simplefilter

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.assembly import tangent_start
from solvers.equations.consistent_start import given_names
from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule, has_constraints
from solvers.equations.number_checks import Values
from solvers.equations.signature_checks import checked
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.checks.singularity import SingularityWarning, singularity
from solvers.integration.given_tolerances import many_motions
from solvers.integration.loops.switching import started
from solvers.integration.prepare import NotFinishedError
from solvers.integration.problem import validation
from solvers.integration.problem.events import Event
from solvers.integration.problem.inputs import Held
from solvers.integration.problem.problem import Options, Problem
from solvers.integration.results.ensemble_solution import Ensemble
from solvers.io.suggestion import did_you_mean
from solvers.runge_kutta.stepper import Array

#: Occurrences of each event that are stored at first.
OCCURRENCES = 16


@dataclass(frozen=True)
class Sensitivities:
    """A motion and its derivatives by k quantities.

    Attributes
    ----------
    by : tuple of str
        Names of the quantities: components of the start, parameters and inputs.
    t : float
        Time in s of the end, which may be that of a terminal event.
    y : ndarray of shape (state,)
        Coordinates and velocities at the end.
    derivatives : ndarray of shape (state, k)
        ∂y/∂quantity, at a terminal event with the change of its time.
    t_eval, samples : ndarray of shape (times,) and (state, times)
        The requested times in s and the states there; NaN after the end.
    sample_derivatives : ndarray of shape (state, k, times)
        Their derivatives.
    t_events, y_events : list of ndarray of shape (n,) and (state, n)
        Times in s of the occurrences of each event, and the states there.
    t_event_derivatives : list of ndarray of shape (k, n)
        ∂t/∂quantity of these times, infinite or NaN where the event is touched and not crossed.
    y_event_derivatives : list of ndarray of shape (state, k, n)
        Derivatives of these states, with the change of the time.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> from solvers import sensitivities
    >>> motion = sensitivities(dp, (0, 1), {"theta1": 1.0, "theta2": 0.0}, {}, ["theta1", "l2"])
    >>> motion.by, motion.derivatives.shape
    (('theta1', 'l2'), (4, 2))
    """

    by: tuple[str, ...]
    t: float
    y: Array
    derivatives: Array
    t_eval: Array
    samples: Array
    sample_derivatives: Array
    t_events: list[Array]
    y_events: list[Array]
    t_event_derivatives: list[Array]
    y_event_derivatives: list[Array]


@checked
def sensitivities(
    module: GeneratedModule,
    t_span: ArrayLike,
    y0: Values,
    params: Values,
    by: Sequence[str] | None = None,
    *,
    t_eval: ArrayLike | None = None,
    events: Event | Sequence[Event] = (),
    inputs: Held | Values | None = None,
    rtol: float = 1e-12,
    atol: float = 1e-12,
) -> Sensitivities:
    """A motion and its derivatives by its start, parameters and inputs.

    The derivatives follow the variational equations, in one vector lane for each quantity.

    Parameters
    ----------
    module, t_span, y0, params, t_eval, rtol, atol
        As in `integrate`; the tolerances apply to the derivatives, too, those by parameters in
        units of the parameter.
    by : sequence of str, optional
        Components of ``module.STATE``, for the start, and of ``module.PARAMETERS``; by default all.
        Of systems with constraints, components that `y0` leaves out change with the others; where
        it has all, a change of one changes the others by the least, in the metric of the mass
        matrix.
    events : Event or sequence of Event, optional
        Events whose times and states have derivatives, too.
    inputs : array_like of shape (inputs,), mapping of str to float, or Held, optional
        As in `integrate`, without functions, on whose results inputs would depend. A derivative by
        an input is that by a constant that is added to it.

    Returns
    -------
    Sensitivities
        The motion and its derivatives.

    Raises
    ------
    ValueError
        When an argument is invalid, or `module` has no form ``sensitivity``.
    solvers.integration.prepare.NotFinishedError
        When the motion reaches neither its end nor a terminal event.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import Event, sensitivities
    >>> lowest = Event(sp, "theta", 0.0)
    >>> motion = sensitivities(sp, (0, 1), {"theta": 0.1}, {}, ["theta", "l"], events=lowest)
    >>> motion.t_event_derivatives[0].shape  # of two quantities, at one crossing
    (2, 1)
    """
    if callable(inputs) or (isinstance(inputs, Held) and callable(inputs.values)):
        raise ValueError(
            "inputs is a function, whose derivatives are not known: give numbers, a table "
            "(solvers.Held), or replace inputs by formulas (derive.with_inputs)"
        )
    located = [events] if isinstance(events, Event) else [*events]
    options = Options("verner98", "lagrangian", rtol, atol, events=located, inputs=inputs)
    problem = validation.problem(module, t_span, y0, params, options)
    given = given_names(module, y0) if has_constraints(module) else module.STATE
    names = _names(module, by, given)
    starts, values, units = _perturbed(problem, names, given)
    occurrences, most = 0, OCCURRENCES
    while most > occurrences:
        occurrences = most
        with ignore_predictability(), catch_warnings():
            simplefilter("ignore", SingularityWarning)  # the error states it
            held = inputs if isinstance(inputs, Held) else None
            perturbed = replace(options, form="sensitivity", t_eval=t_eval, inputs=held)
            motions = many_motions(
                module, t_span, starts, values, perturbed, occurrences=occurrences
            )
        most = int(motions.occurred.max(initial=0))
    return _collected(problem, names, motions, units)


def _names(
    module: GeneratedModule, by: Sequence[str] | None, given: Sequence[str]
) -> tuple[str, ...]:
    known = (*given, *module.PARAMETERS)
    names = known if by is None else tuple(by)
    if not names:
        raise ValueError(f"by = {by!r} must be a list of one or more of {', '.join(known)}")
    for name in names:
        if name in module.STATE and name not in given:
            raise ValueError(
                f"by has {name!r}, which follows from the constraints and {', '.join(given)}: give "
                "its value in y0"
            )
        if name not in known:
            hint = did_you_mean(str(name), known)
            raise ValueError(f"by has {name!r}{hint}; known names: {', '.join(known)}")
    return names


def _perturbed(
    problem: Problem, names: Sequence[str], given: Sequence[str]
) -> tuple[Array, Array, Array]:
    """States and parameters with one perturbation in each column, and the perturbations' sizes.

    Those of parameters have the size of the parameter, so that tolerances are relative to it.
    Components of the start that are not given follow from the constraints.
    """
    module, constants = problem.form.module, np.array(problem.form.params)
    known, count = (*module.STATE, *module.PARAMETERS), len(module.STATE)
    sizes = np.concatenate([np.ones(count), np.where(constants == 0, 1.0, np.abs(constants))])
    quantities = [known.index(name) for name in names]
    changes = (np.eye(len(known)) * sizes)[:, quantities]
    motion, parameters = (
        np.tile(part[:, np.newaxis], len(names)) for part in (problem.start, constants)
    )
    states = np.vstack([motion, changes[:count]])
    params = np.vstack([changes[count:], parameters])
    if problem.form.has_constraints:
        form, flags = Form(module, "sensitivity", [*params]), np.isin(module.STATE, given)
        states = tangent_start(form, problem.span[0], states.T, flags).T
    return states, params, sizes[quantities]


def _collected(
    problem: Problem, names: tuple[str, ...], motions: Ensemble, sizes: Array
) -> Sensitivities:
    count = len(problem.start)
    for k in np.flatnonzero(~motions.success):
        status, end = motions.status[k], (float(motions.t[k]), motions.y[:count, k])
        detail = singularity(problem, status, end)
        raise NotFinishedError(status, end[0], tuple(end[1].tolist()), detail)
    y, derivatives = motions.y[:count, 0], motions.y[count:] / sizes
    t_events, y_events, of_times, of_states = [], [], [], []
    for i, event in enumerate(cast("list[Event]", problem.events)):
        n = int(motions.occurred[:, i].min())
        t, states = motions.t_events[:, i, :n], motions.y_events[:, :, i, :n]
        rates = _rates(problem, t[0], states[:count, 0])
        changes = states[count:] / sizes[:, np.newaxis]
        with np.errstate(divide="ignore", invalid="ignore"):
            component = problem.form.module.STATE.index(event.name)
            change_of_time = -changes[component] / rates[component]
            changes = changes + rates[:, np.newaxis] * change_of_time
        t_events.append(t[0])
        y_events.append(states[:count, 0])
        of_times.append(change_of_time)
        of_states.append(changes)
        if n and event.terminal and t[0, -1] == motions.t[0]:
            derivatives = changes[..., -1]
    samples = motions.samples
    return Sensitivities(
        names,
        float(motions.t[0]),
        y,
        derivatives,
        motions.t_eval,
        samples[:count, 0],
        samples[count:] / sizes[:, np.newaxis],
        t_events,
        y_events,
        of_times,
        of_states,
    )


def _rates(problem: Problem, t: Array, y: Array) -> Array:
    """Derivatives of states in columns by time."""
    rates = np.empty_like(y)
    for k, (time, state) in enumerate(zip(t.tolist(), y.T, strict=True)):
        now, schedule = problem, problem.schedule
        if schedule:
            sample = int(np.searchsorted(schedule.times, time, "right")) - 1
            now = problem.with_inputs(schedule.at(sample, time, state))
        rates[:, k] = started(now, time, state, ())[0].form.rhs(time, state)
    return rates
