"""Integration of a generated module's equations of motion."""

from collections.abc import Sequence

from numpy.typing import ArrayLike

from solvers.equations.module import GeneratedModule
from solvers.equations.number_checks import Values
from solvers.equations.signature_checks import known_names
from solvers.integration.given_tolerances import single_motion
from solvers.integration.problem import validation
from solvers.integration.problem.inputs import Controller, Held
from solvers.integration.problem.problem import METHOD, EventFunction, Options
from solvers.integration.results.solution import Solution


@known_names
def integrate(
    module: GeneratedModule,
    t_span: ArrayLike,
    y0: Values,
    params: Values,
    *,
    accuracy: float | None = None,
    method: str | None = None,
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
        by name, as ``{"theta1": 0.1, "theta2": "20 deg"}``: velocities that are left out are 0. Of
        systems with constraints, which they must satisfy, also coordinates may be left out
        (`consistent_start`).
    params : array_like of shape (parameters,), or mapping of str to float
        In the order of ``module.PARAMETERS``. Or numbers by name: parameters that are left out
        have their default values.
    accuracy : float, optional
        The largest error of every returned state and velocity, in rad, m, rad/s and m/s. It chooses
        method, form and tolerances by recorded measurements, other runs check the error, and where
        double precision does not suffice, longer numbers or Taylor series follow. `method` and
        `form` fix what they name. Times of events are not checked.
    method : str, optional
        One of ``solvers.runge_kutta.method_catalogue.names()``, or a method of SciPy's
        ``solve_ivp``; by default ``verner853``, or with `accuracy` the cheapest.
    form : {"lagrangian", "hamiltonian", "rational", "variational", "sensitivity"}, optional
        The form of the equations; by default the rational form, where it exists, in a compiled
        loop of an explicit method, and Lagrange's form otherwise. The variational form
        integrates a linear perturbation, too: `y0` is then the state, followed by it. In the
        sensitivity form parameters are perturbed, too: `params` are then their perturbations,
        followed by the parameters, or by name, such as ``delta_l``.
    rtol, atol : float, optional
        Without `accuracy`, the error of a step in a component may be atol + rtol * abs(y); in
        Lagrange's form `atol` may be an array of shape (state,). They are unused with fixed steps.
    h : float, optional
        A fixed step size in s; methods without error estimate need one, as leapfrog and other
        splittings, of systems whose accelerations depend on coordinates alone. The last step is
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
        When an argument is invalid, before anything is computed; when longer numbers would have to
        locate events.
    solvers.integration.accuracy.integration_run.NotAccurateError
        When nothing reaches the `accuracy`; the message states what is reached.
    solvers.runge_kutta.method_catalogue.UnknownMethodError
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
    solvers.integration.checks.accuracy_warnings.EnergyWarning
        When a motion that conserves its energy ends with another one.
    solvers.integration.checks.accuracy_warnings.DriftWarning
        When that energy drifts over 1000 fixed steps and more of an explicit method, by a
        thousandth and more; it names a symplectic method.
    solvers.equations.singularities.MassMatrixWarning
        When the mass matrix is nearly singular at the start, or where all coordinates are equal.
    solvers.equations.singularities.SingularConfigurationWarning
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
    >>> chaotic = integrate(dp, (0, 30), (2.0, 0.0, 0.0, 0.0), {}, accuracy=1e-10, t_eval=[7.5, 30])
    >>> chaotic.error_estimate < 1e-10, "double-double" in chaotic.run
    (True, True)
    """
    validation.check_flag("energy", energy)
    control = (method or METHOD, form, rtol, atol, h)
    options = Options(*control, t_eval, events, max_steps, backend, compensated, inputs)
    if accuracy is None:
        return single_motion(module, t_span, y0, params, options, energy=energy)
    # loads longer numbers and series, which other motions do not need
    from solvers.integration.accuracy.accurate_motion import accurate_motion

    is_named = method is not None or form is not None
    return accurate_motion(
        module, t_span, y0, params, options, accuracy, is_named=is_named, energy=energy
    )
