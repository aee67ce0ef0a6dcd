"""Integrate a generated module's equations of motion, step by step in Python.

This is the plain reference: every method, every form, fixed or adaptive steps,
samples, events. Compiled loops are to agree with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers import request
from solvers.catalogue import load
from solvers.control import Controller
from solvers.forms import Form
from solvers.record import Event, Record
from solvers.request import SHORTEST
from solvers.solution import Solution, Status
from solvers.stepper import NoConvergenceError, NotFiniteError, Stepper

Array = NDArray[np.float64]

#: How often a step is cut to a quarter because a stage fails, before the run stops.
MOST_CUTS = 25


def integrate(
    module: ModuleType,
    t_span: ArrayLike,
    y0: ArrayLike,
    params: ArrayLike,
    *,
    method: str = "verner87",
    form: str = "lagrangian",
    rtol: float = 1e-9,
    atol: ArrayLike = 1e-12,
    h: float | None = None,
    t_eval: ArrayLike | None = None,
    events: Event | Sequence[Event] = (),
    energy: bool = False,
    max_steps: int = 1_000_000,
) -> Solution:
    """Integrate from `y0` over `t_span`.

    Parameters
    ----------
    module : module
        A generated module, such as ``generated.double_pendulum``.
    t_span : pair of float
        Beginning and end in s; the end may come first.
    y0 : array_like of shape (state,)
        Coordinates and velocities in the order of ``module.STATE``, whatever the form.
    params : array_like of shape (parameters,)
        In the order of ``module.PARAMETERS``.
    method : str
        One of ``solvers.catalogue.names()``.
    form : {"lagrangian", "hamiltonian", "rational"}
        The equations that are integrated.
    rtol, atol : float
        A step's error in a component may be atol + rtol |y|; `atol` may be an array.
        They have no effect on fixed steps.
    h : float, optional
        A fixed step in s; methods without error estimate need one. The last step is
        shortened to end at the end.
    t_eval : array_like of shape (n,), optional
        Times of the states that are returned; every step's end by default. States
        between steps are as accurate as the method.
    events : callable or sequence of callables, optional
        ``event(t, y)`` changes its sign where the event occurs; of several changes
        within one step one is found. It may have the attributes ``terminal`` (true: the
        integration ends there) and ``direction`` (1: only upwards, -1: only downwards).
    energy : bool
        Whether to return the energy at these times.
    max_steps : int
        After so many steps the integration stops with what it has.

    Returns
    -------
    Solution

    Raises
    ------
    ValueError
        When an argument makes no sense, before anything is computed.
    solvers.catalogue.UnknownMethodError
        When no method has this name.
    """
    span = request.time_span(t_span)
    start = request.numbers("y0", y0, module.STATE)
    constants = request.parameters(module, params)
    tableau, equations = load(method), Form(module, form, constants.tolist())
    controller = None
    if h is not None:
        h = request.step(h, span)
    elif not tableau.b_hat:
        raise ValueError(f"method {method!r} does not estimate its error: give a fixed step h")
    else:
        relative, absolute = request.tolerances(rtol, atol, len(start))
        if absolute.ndim and form != "lagrangian":
            raise ValueError("atol for each component has a meaning in form 'lagrangian' only")
        controller = Controller(min(tableau.order, tableau.embedded_order), relative, absolute)
    if not tableau.is_explicit and not equations.has_jacobian:
        raise ValueError(f"method {method!r} needs a Jacobian, which form {form!r} does not have")
    samples = None if t_eval is None else request.times(t_eval, span)
    watched = request.callables(events)
    max_steps = request.count(max_steps)
    stepper = Stepper(tableau, equations.rhs, equations.jacobian)
    record = Record(equations, stepper, start, span[0], samples, watched)
    status, message, steps, rejected = _run(record, span[1], h, controller, max_steps)
    t, y = np.array(record.t), np.array(record.y).reshape(-1, len(start)).T
    return Solution(
        t=t,
        y=y,
        t_events=[np.array(found) for found in record.t_events],
        y_events=[np.array(found).reshape(-1, len(start)) for found in record.y_events],
        nfev=stepper.nfev,
        njev=stepper.njev,
        status=status,
        message=message,
        steps=steps,
        rejected=rejected,
        run=f"{tableau.title}, {form} form, " + (f"h = {h}" if h else f"rtol = {rtol}"),
        energy=np.asarray(module.energy_many(y, constants)) if energy else None,
        end=(record.now, record.place),
    )


def _run(
    record: Record, end: float, h: float | None, controller: Controller | None, max_steps: int
) -> tuple[Status, str, int, int]:
    stepper, form = record.stepper, record.form
    t, begin = record.now, record.now
    direction = np.sign(end - t)
    z = form.inside(record.place)
    steps = rejected = cuts = 0

    def ended(status: Status) -> tuple[Status, str, int, int]:
        where = "" if status is Status.FINISHED else f" (t = {record.now}, y = {record.place})"
        return status, status.value + where, steps, rejected

    if t == end:
        return ended(Status.FINISHED)
    try:
        first = stepper.slope(t, z)
    except NotFiniteError:
        return ended(Status.NOT_FINITE)
    shortest = SHORTEST * np.spacing(max(abs(t), abs(end)))
    size = h if controller is None else max(controller.first_step(first, z, end - t), 2 * shortest)
    assert size is not None
    while t != end:
        if steps == max_steps:
            return ended(Status.STEP_LIMIT)
        # fixed steps are counted, so that their ends do not drift
        aim = begin + (steps + 1) * size * direction if controller is None else t + size * direction
        if (end - aim) * direction < 1e-9 * size:
            aim = end
        if abs(aim - t) < shortest and aim != end:
            return ended(Status.STEP_TOO_SMALL)
        try:
            z_end, error, last = stepper.step(t, z, aim - t, first)
            z_end = form.settled(z_end)
            norm = 0.0 if controller is None else controller.norm(error, z, z_end)
            if not np.isfinite(z_end).all() or not np.isfinite(norm):
                raise NotFiniteError("the state is not finite")
            stop = False
            if norm <= 1:
                following = first if last is None else last
                if last is None and aim != end:  # the end of the run needs no slope
                    following = stepper.slope(aim, z_end)
                stop = record.advance(t, z, first, aim, z_end)
        except (NotFiniteError, NoConvergenceError) as failure:
            rejected, cuts = rejected + 1, cuts + 1
            if controller is None or cuts > MOST_CUTS:
                lost = isinstance(failure, NoConvergenceError)
                return ended(Status.NO_CONVERGENCE if lost else Status.NOT_FINITE)
            size = abs(aim - t) / 4
            continue
        if norm > 1 and controller is not None:
            rejected += 1
            size = abs(aim - t) * controller.factor(norm)
            continue
        steps, cuts = steps + 1, 0
        if stop:
            return ended(Status.EVENT)
        t, z, first = aim, z_end, following
        if controller is not None:
            size = abs(size) * controller.factor(norm)
    return ended(Status.FINISHED)
