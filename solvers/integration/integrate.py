"""Integration of a generated module's equations of motion."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from warnings import warn

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.arguments import known_names
from solvers.equations.module import GeneratedModule
from solvers.equations.module import inputs as input_names
from solvers.equations.quantities import NotFiniteNumberError, Values
from solvers.equations.singularities.mass_matrix import check_condition
from solvers.integration.checks.accuracy_warnings import accuracy_warnings
from solvers.integration.checks.global_error import global_error_estimate
from solvers.integration.checks.predictability import (
    UnfinishedWarning,
    compile_perturbations,
    is_ignored,
)
from solvers.integration.checks.singularity import singularity
from solvers.integration.checks.step_stability import step_instability
from solvers.integration.loops import compiled_loop, passage
from solvers.integration.problem import validation
from solvers.integration.problem.inputs import Controller, Held
from solvers.integration.problem.memory import limit_steps
from solvers.integration.problem.problem import EventFunction, Options, Problem
from solvers.integration.problem.status import Status
from solvers.integration.results.outcome import Outcome
from solvers.integration.results.solution import Interrupted, Solution
from solvers.runge_kutta.stepper import Array


@known_names
def integrate(
    module: GeneratedModule,
    t_span: ArrayLike,
    y0: Values,
    params: Values,
    *,
    method: str = "verner853",
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
    inputs: Held | Controller | Values | None = None,
) -> Solution:
    """Integrate the motion that starts with `y0` over `t_span`.

    Parameters
    ----------
    module : module
        A generated module, such as ``generated.double_pendulum``.
    t_span : pair of float
        Start and end in s; the end may be the earlier one.
    y0 : array_like of shape (state,), or mapping of str to float
        Coordinates and velocities in the order of ``module.STATE``, whatever the form. Or numbers
        by name, as ``{"theta1": 0.1, "theta2": 0.2}``: velocities that are left out are 0. Of
        systems with constraints, which they must satisfy, also coordinates may be left out
        (`consistent_start`).
    params : array_like of shape (parameters,), or mapping of str to float
        In the order of ``module.PARAMETERS``. Or numbers by name: parameters that are left out
        have their default values.
    method : str, optional
        One of ``solvers.runge_kutta.catalogue.names()``, or a method of SciPy's ``solve_ivp``.
    form : {"lagrangian", "hamiltonian", "rational", "variational", "sensitivity"}, optional
        The form of the equations; by default the rational form, where it exists, in a compiled
        loop of an explicit method, and Lagrange's form otherwise. The variational form
        integrates a linear perturbation, too: `y0` is then the state, followed by it. In the
        sensitivity form parameters are perturbed, too: `params` are then their perturbations,
        followed by the parameters, or by name, such as ``delta_l``.
    rtol, atol : float, optional
        The error of a step in a component may be atol + rtol * abs(y); in Lagrange's form `atol`
        may be an array of shape (state,). They are unused with fixed steps.
    h : float, optional
        A fixed step size in s; methods without error estimate need one. The last step is
        shortened to end at the end of `t_span`.
    t_eval : array_like of shape (n,), optional
        Times in s of the states to return; by default the start and every step's end.
        States between steps are as accurate as the method.
    events : callable or sequence of callables, optional
        ``event(t, y)`` changes its sign where the event occurs. All changes within a step are
        located, unless the value between them is smaller than its error. Optional attributes are
        ``terminal`` (true: the integration ends there) and ``direction`` (1: upwards only, -1:
        downwards only). An `solvers.integration.problem.events.Event` runs in compiled loops, too.
    energy : bool, optional
        Whether to return the energy at these times.
    max_steps : int, optional
        Largest number of steps; the integration stops there.
    backend : {"compiled", "python"}, optional
        The backend; by default compiled if that is possible.
    compensated : bool, optional
        Whether a compiled loop compensates the rounding errors of the state, which reduces
        the error over very many steps.
    inputs : array_like of shape (inputs,), mapping of str to float, Held or callable, optional
        Constants in the order of ``module.INPUTS`` or by name, in place of those in `params`; 0 for
        those that are left out. Or a `Held`, with which inputs are constant between samples. Or a
        function ``u(t, y)`` of the time in s and the state (q, q̇) that returns them, with which
        the loop runs in Python, in Lagrange's form; `derive.with_inputs` compiles formulas.
        Estimates of errors call controllers and functions again. A run ends where a value is not
        finite.

    Returns
    -------
    Solution
        Coordinates and velocities, whatever the form. A motion that does not reach its end
        raises nothing: its ``status`` gives the reason, as does a warning, and its results up to
        there are returned.

    Raises
    ------
    ValueError
        When an argument is invalid, before anything is computed.
    solvers.runge_kutta.catalogue.UnknownMethodError
        When no method has this name.
    solvers.integration.compiled.compiler.NoCompilerError
        When ``backend="compiled"`` or ``compensated=True``, and no compiler could build the loop.
    solvers.integration.results.solution.Interrupted
        When the user interrupts; it holds the solution up to then.

    Warns
    -----
    solvers.integration.checks.predictability.UnfinishedWarning
        When the motion does not reach its end.
    solvers.integration.checks.predictability.PredictabilityWarning
        When errors grow to the size of the motion before its end.
    solvers.integration.checks.energy_change.EnergyWarning
        When a motion that conserves its energy ends with another one.
    solvers.equations.singularities.mass_matrix.MassMatrixWarning
        When the mass matrix is nearly singular at the start, or where all coordinates are equal.
    solvers.equations.singularities.singular_configuration.SingularConfigurationWarning
        When constraints nearly depend on each other at the start.
    UserWarning
        When no compiler could build the loop, and it runs in Python.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> motion = integrate(dp, (0, 1), (0.1, 0.0, 0.0, 0.0), dp.DEFAULTS, t_eval=[0, 0.5, 1])
    >>> motion.y.shape, motion.status.name
    ((4, 3), 'FINISHED')
    >>> by_name = integrate(dp, (0, 1), {"theta1": 0.1, "theta2": 0.0}, {"g": 9.81})
    """
    options = Options(
        method, form, rtol, atol, h, t_eval, events, max_steps, backend, compensated, inputs
    )
    validation.check_flag("energy", energy)
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
            warn(warning, stacklevel=3)
    elif not is_ignored():
        warn(solution.message, UnfinishedWarning, stacklevel=3)
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
