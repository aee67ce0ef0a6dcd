"""Checks of the arguments of an integration, before anything runs."""

import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.assembly import Assembly, tangent_start
from solvers.equations.consistent_start import (
    consistent,
    default_coordinates,
    given_names,
    guesses,
)
from solvers.equations.energy import coupling
from solvers.equations.forms import Form
from solvers.equations.module import (
    GeneratedModule,
    has_constraints,
    has_perturbation,
    parameter_names,
    perturbations,
    state_names,
)
from solvers.equations.number_checks import (
    Values,
    quantities,
    real_number,
    real_numbers,
    without_texts,
)
from solvers.equations.signature_checks import check_module
from solvers.integration.problem.events import Event, Limit, UserEvent
from solvers.integration.problem.inputs import Held, Schedule, controlled, given
from solvers.integration.problem.problem import Options, Problem, check_times, shortest_step
from solvers.io.argument_types import check_type
from solvers.io.suggestion import counted, shortened, warn_caller
from solvers.runge_kutta.method_catalogue import SCIPY, load
from solvers.runge_kutta.stepper import Array
from solvers.runge_kutta.tableau import Tableau

#: The largest count that loops can reach exactly.
MOST = 2**53


def problem(
    module: GeneratedModule, t_span: ArrayLike, y0: Values | None, params: Values, options: Options
) -> Problem:
    """The problem that `integrate` solves, from its arguments, all of which are checked.

    Without `y0` it starts at rest, whether constraints permit it or not.
    """
    check_module(module)
    warn_if_flushed()
    check_type("method", options.method, str, "the name of a method")
    check_type("form", options.form, str | None, "the name of a form")
    check_type("backend", options.backend, str | None, "the name of a backend")
    if options.backend not in (None, "compiled", "python"):
        raise ValueError(f"backend {options.backend!r} must be 'compiled' or 'python'")
    check_flag("compensated", options.compensated)
    if options.compensated and options.backend == "python":
        raise ValueError("compensated = True needs a compiled loop, not backend 'python'")
    span, method, name = time_span(t_span), options.method, options.form or "lagrangian"
    form = Form(module, name, parameters(module, params, name).tolist())
    form, schedule = _with_inputs(form, options.inputs, span)
    if y0 is None:
        start = np.array([float(s in module.POSITIVE) for s in state_names(module, name)])
    else:
        start = initial_state(module, y0, name, params_at_start(form, schedule, span), span[0])
    tableau = None if method in SCIPY else load(str(method))
    rtol, atol, h = step_control(options, tableau, span, len(start))
    if atol.ndim and name != "lagrangian":
        raise ValueError("atol can be an array in form 'lagrangian' only")
    if tableau is not None and tableau.needs_jacobian and not form.has_jacobian:
        raise ValueError(f"method {method!r} needs a Jacobian, which form {name!r} does not have")
    if tableau is not None and tableau.is_splitting:
        check_splitting(module, method, name)
        if form.feedback:
            raise ValueError(
                f"method {method!r} needs accelerations that do not depend on velocities, on which "
                "inputs that are a function may: hold the inputs between samples (solvers.Held)"
            )
    check_times(options.t_eval, len(start))
    samples = None if options.t_eval is None else times(options.t_eval, span)
    events = event_functions(options.events, module)
    max_steps = count("max_steps", options.max_steps, 0)
    limits = [Limit(module, q) for q in module.COORDINATES if q in module.POSITIVE]
    control, record = (h, rtol, atol), (samples, events, limits)
    numbers = (*control, *record, max_steps)
    return Problem(form, tableau or method, span, start, *numbers, options, schedule)


def _with_inputs(
    form: Form, values: Any, span: tuple[float, float]
) -> tuple[Form, Schedule | None]:
    """The form with inputs that are constant or functions, and the schedule of held ones."""
    module = form.module
    if values is None:
        return form, None
    if isinstance(values, Held):
        return form, Schedule.of(values, module, span)
    if callable(values):
        if form.name != "lagrangian":
            raise ValueError(
                f"inputs is a function, which form {form.name!r} cannot call: leave out form, hold "
                "the inputs between samples (solvers.Held), or replace them by formulas "
                "(derive.with_inputs)"
            )
        given("inputs", module, dict[str, float]())  # whether the system has inputs
        feedback = partial(controlled, module, values)
        return Form(module, form.name, form.params, feedback), None
    constants = given("inputs", module, values)
    return Form(module, form.name, (*form.params[: -len(constants)], *constants.tolist())), None


def check_splitting(module: GeneratedModule, method: str, form: str) -> None:
    """Refuse equations of which a splitting has not the accelerations by coordinates alone."""
    if form != "lagrangian":
        raise ValueError(
            f"method {method!r} kicks velocities and moves coordinates in turn, for which form "
            f"{form!r} is not: leave out form"
        )
    if reason := coupling(module):
        raise ValueError(
            f"method {method!r} needs accelerations that depend on coordinates and time alone, and "
            f"{reason}; use a Gauss method, which is symplectic, too, such as 'gauss4'"
        )


def problem_at_rest(
    module: GeneratedModule, t_span: ArrayLike, options: Options, params: Values | None = None
) -> Problem:
    """The problem of motions whose initial states are given later; default parameters if None."""
    return problem(module, t_span, None, {} if params is None else params, options)


def parameters(module: GeneratedModule, values: Values, form: str = "lagrangian") -> Array:
    """Parameters in the order of the form; a mapping is completed by default values."""
    return _vector("params", _parameters(module, values, form), parameter_names(module, form))


def params_at_start(
    form: Form, schedule: Schedule | None, span: tuple[float, float]
) -> Sequence[Any]:
    """Parameters of the form, with the first of held inputs."""
    if schedule is None or schedule.table is None:
        return form.params
    values = schedule.table[:, schedule.pieces(span)[0]]
    return (*form.params[: -len(values)], *values.tolist())


def initial_state(
    module: GeneratedModule,
    values: Values,
    form: str = "lagrangian",
    params: Sequence[Any] | None = None,
    t: float = 0.0,
) -> Array:
    """A state in the order of the module; a mapping may leave out velocities, which are 0.

    With `params`, those of the form, a mapping may leave out coordinates, too, which constraints
    determine, or `default_coordinates`.
    """
    state = _states(module, values, form, None if params is None else np.array(params, float))
    state = _vector("y0", state, state_names(module, form))
    if params is None:
        return state
    return consistent_rows(module, values, state[np.newaxis], np.array([params], float), t, form)[0]


def consistent_rows(
    module: GeneratedModule,
    values: Values,
    rows: Array,
    params: Array,
    t: float,
    form: str = "lagrangian",
) -> Array:
    """Initial states in rows that satisfy the constraints, of which `values` were given."""
    if not has_constraints(module):
        return rows
    n, constants = len(module.STATE), params[:, params.shape[1] - len(module.PARAMETERS) :]
    states = consistent(Assembly(module, constants, t), rows[:, :n], given_names(module, values))
    rows = np.hstack([states, rows[:, n:]])
    if not has_perturbation(form):
        return rows
    names = perturbations(module.STATE)
    given = [not isinstance(values, Mapping) or name in values for name in names]
    return tangent_start(Form(module, form, [*params.T]), t, rows, np.array(given))


def parameter_rows(
    module: GeneratedModule, values: Values, motions: int, form: str = "lagrangian"
) -> Array:
    """Parameters, component first, as rows: one for all motions or one for each."""
    array = _parameters(module, values, form)
    columns = array[:, np.newaxis] if array.ndim == 1 else array
    rows = _rows("params", columns, parameter_names(module, form))
    if len(rows) not in (1, motions):
        raise ValueError(
            f"params holds values for {counted(len(rows), 'motion')}, but y0 has {motions}"
        )
    return rows


def state_rows(module: GeneratedModule, values: Values, params: Values, form: str) -> Array:
    """Initial states, component first, as rows; guesses of coordinates that constraints give."""
    states = _states(module, values, form, _parameters(module, params, form))
    return _rows("y0", states, state_names(module, form))


def _parameters(module: GeneratedModule, values: Values, form: str) -> Array:
    names = parameter_names(module, form)
    defaults = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
    defaults = dict.fromkeys(names, 0.0) | defaults
    return quantities(module, "params", names, values, defaults)


def _states(module: GeneratedModule, values: Values, form: str, params: Array | None) -> Array:
    velocities = module.STATE[len(module.COORDINATES) :]
    # in the variational form, the perturbation is that of the state alone
    perturbed = module.STATE if form == "sensitivity" else velocities
    defaults: dict[str, Any] = dict.fromkeys([*velocities, *perturbations(perturbed)], 0.0)
    if params is not None and has_constraints(module):
        defaults |= guesses(module) | dict.fromkeys(perturbations(module.STATE), 0.0)
    elif params is not None and isinstance(values, Mapping):
        own = params[len(params) - len(module.PARAMETERS) :]
        defaults |= default_coordinates(module, values, own)
    return quantities(module, "y0", state_names(module, form), values, defaults)


def _vector(name: str, array: Array, expected: Sequence[str]) -> Array:
    """An array of one number for each name in `expected`."""
    if array.shape != (len(expected),):
        raise ValueError(
            f"{name} has shape {array.shape}: give {len(expected)} numbers, {', '.join(expected)}"
        )
    return array


def _rows(name: str, array: Array, expected: Sequence[str]) -> Array:
    """An array of shape (components, n) as one of n rows."""
    size = len(expected)
    if array.ndim != 2 or len(array) != size:
        hint = f"the first axis must hold the {size} components, {', '.join(expected)}"
        if array.ndim == 2 and array.shape[1] == size:
            hint += f"; transpose it: {name}.T"
        raise ValueError(f"{name} has shape {array.shape}: {hint}")
    return np.ascontiguousarray(array.T)


def time_span(values: ArrayLike) -> tuple[float, float]:
    """Start and end."""
    seconds = real_numbers("t_span", without_texts("t_span", values, "s"), "s")
    start, end = _vector("t_span", seconds, ("start", "end")).tolist()
    return start, end


def times(values: ArrayLike, span: tuple[float, float]) -> Array:
    """Times within `span`, in the order of the integration."""
    array = real_numbers("t_eval", without_texts("t_eval", values, "s"), "s")
    if array.ndim != 1:
        raise ValueError(f"t_eval has shape {array.shape}: give a list of times")
    low, high = sorted(span)
    outside = array[(array < low) | (array > high)]
    if outside.size:
        raise ValueError(f"t_eval has {outside[0]}, outside of t_span = {span}")
    if np.any(np.diff(array) * np.sign(span[1] - span[0]) <= 0):
        raise ValueError("t_eval must be ordered from the start of t_span to its end")
    return array


def step_control(
    options: Options, tableau: Tableau | None, span: tuple[float, float], size: int
) -> tuple[float, Array, float | None]:
    """Relative and absolute tolerance, 0 for fixed steps, and the fixed step size if any."""
    method = options.method
    if options.h is None:
        rtol, atol = tolerances(options.rtol, options.atol, size)
        if tableau is not None and not tableau.estimates_error:
            why = "does not estimate its error"
            if tableau.is_splitting:
                why = "keeps energies over long times since its steps are equal"
            raise ValueError(f"method {method!r} {why}: give a fixed step h")
        return rtol, atol, None
    if tableau is None:
        raise ValueError(f"method {method!r} is SciPy's and controls its steps: leave out h")
    return 0.0, np.array(0.0), step_size(options.h, span)


def tolerances(rtol: float, atol: ArrayLike, size: int) -> tuple[float, Array]:
    """Tolerances, of which one at least is positive in every component."""
    array, relative = real_numbers("atol", atol), real_number("rtol", rtol)
    for name, value in (("rtol", relative), ("atol", array)):
        if np.any(value < 0):
            raise ValueError(f"{name} = {value} must not be negative")
    if array.shape not in ((), (size,)):
        raise ValueError(f"atol must be a number or {size} of them")
    if relative == 0 and np.any(array == 0):
        raise ValueError("rtol and atol are both 0: no step is short enough; make one positive")
    if 0 < relative < 4 * np.finfo(float).eps:
        raise ValueError(f"rtol = {relative} is below the resolution of numbers, 9e-16")
    return relative, array


def step_size(h: float, span: tuple[float, float]) -> float:
    """A fixed step size: positive, and large enough to change the time."""
    size, shortest = real_number("h", h, "s"), shortest_step(*span)
    if size <= 0:
        raise ValueError(f"h = {h} must be a positive number (the direction follows from t_span)")
    if size < shortest and span[0] != span[1]:
        raise ValueError(f"h = {h} is below the resolution {shortest} of times in {span}")
    return size


def count(name: str, value: object, least: int, most: int = MOST) -> int:
    """A whole number from `least` to `most`."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise ValueError(f"{name} = {value!r} must be a whole number, {least} or more")
    if not least <= value <= most:
        raise ValueError(f"{name} = {shortened(value)} must be from {least} to {most}")
    return int(value)


def check_flag(name: str, value: object) -> None:
    """Refuse anything but True and False."""
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} = {shortened(value)} must be True or False")


def event_functions(events: object, module: GeneratedModule) -> list[Callable[..., float]]:
    """Events as a list of functions; events of another module are refused."""
    functions: list[Any] = list(events) if isinstance(events, Sequence) else [events]
    if not all(map(callable, functions)):
        allowed = "must be functions event(t, y), one or a list: leave it out for none"
        raise ValueError(f"events = {shortened(events)} {allowed}")
    for event in functions:
        if getattr(event, "name", None) and getattr(event, "module", module) is not module:
            raise ValueError(f"{event.name} of {event.module.__name__} is not of {module.__name__}")
    return [
        event if isinstance(event, Event) else UserEvent(f"events[{k}]", event)
        for k, event in enumerate(functions)
    ]


def warn_if_flushed() -> None:
    """Warn if this thread sets numbers below ``sys.float_info.min`` to zero."""
    if sys.float_info.min * 0.5 == 0:
        warn_caller(
            f"this process sets numbers below {sys.float_info.min:.2g} to zero: motions next to "
            "rest lose their digits. A library built with -ffast-math has switched that on; import "
            "it after the integration, or integrate in a process without it",
        )
