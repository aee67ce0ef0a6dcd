"""Integrate a generated module's equations of motion: the front door.

Three rungs do the work, and the solution says which one did: a compiled loop, the
same method in Python, or a solver of SciPy's.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from warnings import warn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule
from solvers.integration import compiled_loop, python_loop, scipy_loop, validation
from solvers.integration.predictability import PredictabilityWarning, predictable_until
from solvers.integration.problem import EventFunction, Outcome, Problem
from solvers.integration.solution import Interrupted, Solution, Status
from solvers.integration.step_stability import step_instability
from solvers.runge_kutta.tableau import Tableau

Array = NDArray[np.float64]


def integrate(
    module: GeneratedModule,
    t_span: ArrayLike,
    y0: ArrayLike,
    params: ArrayLike,
    *,
    method: str = "verner87",
    form: str | None = None,
    rtol: float = 1e-9,
    atol: ArrayLike = 1e-12,
    h: float | None = None,
    t_eval: ArrayLike | None = None,
    events: EventFunction | Sequence[EventFunction] = (),
    energy: bool = False,
    max_steps: int = 1_000_000,
    backend: str | None = None,
    compensated: bool = False,
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
    method : str, optional
        One of ``solvers.runge_kutta.catalogue.names()``, or a method of SciPy's ``solve_ivp``.
    form : {"lagrangian", "hamiltonian", "rational", "variational"}, optional
        The equations that are integrated; by default rational ones, where they exist, in a
        compiled loop of an explicit method, and Lagrange's otherwise. The variational form
        carries a small change along: `y0` is then the state, followed by its change.
    rtol, atol : float, optional
        A step's error in a component may be atol + rtol |y|; of Lagrange's form `atol` may be
        an array of shape (state,). They have no effect on fixed steps.
    h : float, optional
        A fixed step in s; methods without error estimate need one. The last step is
        shortened to end at the end.
    t_eval : array_like of shape (n,), optional
        Times in s of the states that are returned; the beginning and every step's end by
        default. States between steps are as accurate as the method.
    events : callable or sequence of callables, optional
        ``event(t, y)`` changes its sign where the event occurs; of several changes
        within one step one is found. It may have the attributes ``terminal`` (true: the
        integration ends there) and ``direction`` (1: only upwards, -1: only downwards).
        ``solvers.integration.events.Event`` makes events that compiled loops know.
    energy : bool, optional
        Whether to return the energy at these times.
    max_steps : int, optional
        After so many steps the integration stops with what it has.
    backend : {"compiled", "python"}, optional
        Where the loop runs; by default compiled if that is possible.
    compensated : bool, optional
        Whether a compiled loop carries the state's rounding errors along, which pays
        over very many steps.

    Returns
    -------
    Solution
        Coordinates and velocities, whatever the form. A motion that does not reach its end
        raises nothing: its ``status`` says why, and what there is of it is returned.

    Raises
    ------
    ValueError
        When an argument makes no sense, before anything is computed.
    solvers.runge_kutta.catalogue.UnknownMethodError
        When no method has this name.
    solvers.integration.compiled.compiler.NoCompilerError
        When ``backend="compiled"`` or ``compensated=True``, and no compiler could build the loop.
    solvers.integration.solution.Interrupted
        When the user interrupts; it holds the solution up to there.

    Warns
    -----
    solvers.integration.predictability.PredictabilityWarning
        When errors of the size of the tolerances outgrow the motion before its end.
    UserWarning
        When no compiler could build the loop, and it runs in Python.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> motion = integrate(dp, (0, 1), (0.1, 0.0, 0.0, 0.0), dp.DEFAULTS, t_eval=[0, 0.5, 1])
    >>> motion.y.shape
    (4, 3)
    >>> motion.status.name
    'FINISHED'
    """
    where = validation.rung(backend, compensated)

    def asked(form: str) -> Problem:
        return validation.problem(
            module, t_span, y0, params, method, form, rtol, atol, h, t_eval, events, max_steps
        )

    problem, program = compiled_loop.choice(
        asked, form, where, method, lanes=False, compensated=compensated
    )
    outcome = Outcome.at_start(problem)
    try:
        if program:
            compiled_loop.run(problem, outcome, program)
        elif isinstance(problem.method, Tableau):
            python_loop.run(problem, outcome)
        else:
            scipy_loop.run(problem, outcome)
    except KeyboardInterrupt as interruption:
        raise Interrupted(_solution(problem, outcome, energy)) from interruption
    return _judged(problem, outcome, energy)


def _judged(problem: Problem, outcome: Outcome, energy: bool) -> Solution:
    """The solution, with what its trajectory is worth."""
    complaint = step_instability(problem, failed=outcome.status is Status.NOT_FINITE)
    if complaint:
        outcome.status = Status.UNSTABLE
    until = (
        predictable_until(problem, outcome.end[0])
        if outcome.status in (Status.FINISHED, Status.EVENT)
        else inf
    )
    if abs(until - problem.span[0]) < abs(outcome.end[0] - problem.span[0]):
        warn(
            f"beyond t = {until:.4g} this trajectory means nothing: there errors of "
            f"{problem.tolerance:.1g} have grown as large as it; "
            "tighten rtol and atol, or ask for energies and statistics only",
            PredictabilityWarning,
            stacklevel=3,
        )
    return _solution(problem, outcome, energy, complaint)


def _solution(problem: Problem, outcome: Outcome, energy: bool, complaint: str = "") -> Solution:
    form, width = problem.form, len(problem.start)
    times, rows = outcome.rows()
    y = rows.T
    t, place = outcome.end
    where = complaint or f"t = {t}, y = {place}"
    where = "" if outcome.status is Status.FINISHED else f" ({where})"
    return Solution(
        t=times,
        y=y,
        t_events=[np.array(found) for found in outcome.t_events],
        y_events=[np.array(found).reshape(-1, width) for found in outcome.y_events],
        nfev=outcome.nfev,
        njev=outcome.njev,
        status=outcome.status,
        message=outcome.status.value + where,
        steps=outcome.steps,
        rejected=outcome.rejected,
        run=f"{problem.description}, {outcome.backend}",
        backend=outcome.backend.partition(" ")[0],
        energy=_energy(form, times, y) if energy else None,
        end=outcome.end,
    )


def _energy(form: Form, t: Array, y: Array) -> Array:
    states = y[: len(form.module.STATE)]
    return np.asarray(form.module.energy_many(t, states, form.params))
