"""Checks of the arguments of an integration, before anything runs."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule, check_sign, state_names
from solvers.integration.events import Limit
from solvers.integration.problem import Options, Problem, shortest_step
from solvers.integration.solution import Array
from solvers.io.suggestion import counted, did_you_mean
from solvers.runge_kutta.catalogue import SCIPY, load
from solvers.runge_kutta.tableau import Tableau

#: Numbers in the order of their names, or by name.
Values: TypeAlias = ArrayLike | Mapping[str, Any]
#: The largest count that loops can reach exactly.
MOST = 2**53


def check_module(module: object) -> None:
    """Refuse the name of a system in the place of its module."""
    if isinstance(module, str):
        known = f"such as solvers.load({module[:50]!r}) returns"
        raise ValueError(f"module = {module[:50]!r} must be a generated module, {known}")


def problem(
    module: GeneratedModule, t_span: ArrayLike, y0: Values, params: Values, options: Options
) -> Problem:
    """The problem that `integrate` solves, from its arguments, all of which are checked."""
    check_module(module)
    if options.backend not in (None, "compiled", "python"):
        raise ValueError(f"backend {options.backend!r} must be 'compiled' or 'python'")
    if options.compensated and options.backend == "python":
        raise ValueError("compensated = True needs a compiled loop, not backend 'python'")
    span, method, name = time_span(t_span), options.method, options.form or "lagrangian"
    form = Form(module, name, parameters(module, params).tolist())
    start = initial_state(module, y0, name)
    tableau = None if method in SCIPY else load(str(method))
    rtol, atol, h = step_control(options, tableau, span, len(start))
    if atol.ndim and name != "lagrangian":
        raise ValueError("atol can be an array in form 'lagrangian' only")
    if tableau is not None and not tableau.is_explicit and not form.has_jacobian:
        raise ValueError(f"method {method!r} needs a Jacobian, which form {name!r} does not have")
    samples = None if options.t_eval is None else times(options.t_eval, span)
    events = event_functions(options.events, module)
    max_steps = count("max_steps", options.max_steps, 0)
    limits = [Limit(module, q) for q in module.COORDINATES if q in module.POSITIVE]
    control, record = (h, rtol, atol), (samples, events, limits)
    return Problem(form, tableau or method, span, start, *control, *record, max_steps, options)


def problem_at_rest(
    module: GeneratedModule, t_span: ArrayLike, options: Options, params: Values | None = None
) -> Problem:
    """The problem of motions whose initial states are given later; default parameters if None."""
    check_module(module)
    names = state_names(module, options.form or "lagrangian")
    rest = [float(name in module.POSITIVE) for name in names]
    return problem(module, t_span, rest, module.DEFAULTS if params is None else params, options)


def parameters(module: GeneratedModule, values: Values) -> Array:
    """Parameters in the order of the module; a mapping is completed by default values."""
    result = numbers("params", _parameters(module, values), module.PARAMETERS)
    return _checked(module, result, module.PARAMETERS)


def initial_state(module: GeneratedModule, values: Values, form: str = "lagrangian") -> Array:
    """A state in the order of the module; a mapping may leave out velocities, which are 0."""
    names = state_names(module, form)
    return _checked(module, numbers("y0", _states(module, values, form), names), names)


def parameter_rows(module: GeneratedModule, values: Values, motions: int) -> Array:
    """Parameters, component first, as rows: one for all motions or one for each."""
    array = np.asarray(_parameters(module, values))
    columns = array[:, np.newaxis] if array.ndim == 1 else array
    rows = _checked(module, _rows("params", columns, module.PARAMETERS), module.PARAMETERS)
    if len(rows) not in (1, motions):
        raise ValueError(
            f"params holds values for {counted(len(rows), 'motion')}, but y0 has {motions}"
        )
    return rows


def state_rows(module: GeneratedModule, values: Values, form: str) -> Array:
    """Initial states, component first, as rows."""
    names = state_names(module, form)
    return _checked(module, _rows("y0", _states(module, values, form), names), names)


def _checked(module: GeneratedModule, values: Array, names: Sequence[str]) -> Array:
    """The values, of which the last axis has these names, if their signs are as declared."""
    for k, name in enumerate(names):
        check_sign(module, name, values[..., k])
    return values


def _parameters(module: GeneratedModule, values: Values) -> ArrayLike:
    defaults = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
    return _in_order("params", values, module.PARAMETERS, defaults)


def _states(module: GeneratedModule, values: Values, form: str) -> ArrayLike:
    velocities = module.STATE[len(module.COORDINATES) :]
    defaults = dict.fromkeys([*velocities, *(f"delta_{name}" for name in velocities)], 0.0)
    return _in_order("y0", values, state_names(module, form), defaults)


def _in_order(
    what: str, values: Values, names: Sequence[str], defaults: Mapping[str, float]
) -> ArrayLike:
    """The values of a mapping in the order of `names`, completed by `defaults`; others as given."""
    if not isinstance(values, Mapping):
        return values
    for name in values:
        if name not in names:
            hint, known = did_you_mean(str(name), names), ", ".join(names) or "none"
            raise ValueError(f"{what} has no {name!r}{hint}; known names: {known}")
    missing = [name for name in names if name not in values and name not in defaults]
    if missing:
        raise ValueError(f"{what} lacks {', '.join(missing)}: only velocities may be left out")
    columns = [_floats(f"{what}[{name!r}]", values.get(name, defaults.get(name))) for name in names]
    try:
        return np.array(np.broadcast_arrays(*columns))
    except ValueError as error:
        shapes = ", ".join(f"{n}: {c.shape}" for n, c in zip(names, columns, strict=True))
        raise ValueError(f"the values of {what} differ in shape: {shapes}") from error


def numbers(name: str, values: ArrayLike, expected: Sequence[str]) -> Array:
    """`values` as a new array of finite floats, one for each name in `expected`."""
    array = _floats(name, values)
    if array.shape != (len(expected),):
        raise ValueError(
            f"{name} has shape {array.shape}: give {len(expected)} numbers, {', '.join(expected)}"
        )
    return _finite(name, array)


def _rows(name: str, values: ArrayLike, expected: Sequence[str]) -> Array:
    """Finite floats of shape (components, n) as an array of n rows."""
    array, size = _floats(name, values), len(expected)
    if array.ndim != 2 or len(array) != size:
        hint = f"the first axis must hold the {size} components, {', '.join(expected)}"
        if array.ndim == 2 and array.shape[1] == size:
            hint += f"; transpose it: {name}.T"
        raise ValueError(f"{name} has shape {array.shape}: {hint}")
    return np.ascontiguousarray(_finite(name, array).T)


def time_span(values: ArrayLike) -> tuple[float, float]:
    """Start and end."""
    start, end = numbers("t_span", values, ("t_start", "t_end")).tolist()
    return start, end


def times(values: ArrayLike, span: tuple[float, float]) -> Array:
    """Times within `span`, in the order of the integration."""
    array = _floats("t_eval", values)
    if array.ndim != 1:
        raise ValueError(f"t_eval has shape {array.shape}: give a list of times")
    _finite("t_eval", array)
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
        if tableau is not None and not tableau.b_hat:
            raise ValueError(f"method {method!r} does not estimate its error: give a fixed step h")
        return rtol, atol, None
    if tableau is None:
        raise ValueError(f"method {method!r} is SciPy's and controls its steps: leave out h")
    return 0.0, np.array(0.0), step_size(options.h, span)


def tolerances(rtol: float, atol: ArrayLike, size: int) -> tuple[float, Array]:
    """Tolerances, of which one at least is positive in every component."""
    array, relative = _floats("atol", atol), _floats("rtol", rtol)
    for name, value in (("rtol", relative), ("atol", array)):
        if np.any(_finite(name, value) < 0):
            raise ValueError(f"{name} = {value} must not be negative")
    if relative.ndim or array.shape not in ((), (size,)):
        raise ValueError(f"rtol must be a number, atol a number or {size} of them")
    if relative == 0 and np.any(array == 0):
        raise ValueError("rtol and atol are both 0: no step is short enough; make one positive")
    if 0 < relative < 4 * np.finfo(float).eps:
        raise ValueError(f"rtol = {relative} is below the resolution of numbers, 9e-16")
    return float(relative), array


def step_size(h: float, span: tuple[float, float]) -> float:
    """A fixed step size: positive, and large enough to change the time."""
    array, shortest = _floats("h", h), shortest_step(*span)
    if array.ndim or not np.isfinite(array) or array <= 0:
        raise ValueError(f"h = {h} must be a positive number (the direction follows from t_span)")
    if array < shortest and span[0] != span[1]:
        raise ValueError(f"h = {h} is below the resolution {shortest} of times in {span}")
    return float(array)


def count(name: str, value: object, least: int) -> int:
    """A whole number, `least` or more."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise ValueError(f"{name} = {value!r} must be a whole number, {least} or more")
    if not least <= value <= MOST:
        raise ValueError(f"{name} = {value} must be from {least} to {MOST}")
    return int(value)


def check_positive(**numbers: float | None) -> None:
    """Raise `ValueError` for the first number that is not positive and finite; None passes."""
    for name, number in numbers.items():
        if number is not None and not (np.isfinite(number) and number > 0):
            raise ValueError(f"{name} = {number} must be positive")


def event_functions(events: object, module: GeneratedModule) -> list[Callable[..., float]]:
    """Events as a list of functions; events of another module are refused."""
    functions: list[Any] = list(events) if isinstance(events, Sequence) else [events]
    if not all(map(callable, functions)):
        raise ValueError(f"events = {events!r} must be functions event(t, y), one or a list")
    for event in functions:
        if getattr(event, "name", None) and getattr(event, "module", module) is not module:
            raise ValueError(f"{event.name} of {event.module.__name__} is not of {module.__name__}")
    return functions


def _floats(name: str, values: Any) -> Array:
    array = np.asarray(values)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{name} = {str(values)[:60]} must be real numbers")
    return np.array(array, dtype=float)


def _finite(name: str, array: Array) -> Array:
    if not np.isfinite(array).all():
        raise ValueError(f"{name} = {array} must be finite")
    return array
