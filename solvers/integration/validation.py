"""What is asked of an integration, refused before anything runs if it makes no sense."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule
from solvers.integration.problem import SHORTEST, Problem
from solvers.runge_kutta.catalogue import SCIPY, load

Array = NDArray[np.float64]

#: The largest number that loops count to.
MOST = 2**53


def problem(
    module: GeneratedModule, t_span: ArrayLike, y0: ArrayLike, params: ArrayLike, method: str,
    form: str, rtol: float, atol: ArrayLike, h: float | None, t_eval: ArrayLike | None,
    events: object, max_steps: int,
) -> Problem:  # fmt: skip
    """The problem that `solvers.integration.integrate.integrate` is asked to solve.

    Parameters
    ----------
    module, t_span, y0, params, method, form, rtol, atol, h, t_eval, events, max_steps
        As there; the form is named.

    Returns
    -------
    Problem
        With arrays of its own; tolerances are 0 where steps are fixed.

    Raises
    ------
    ValueError
        When an argument makes no sense.
    solvers.runge_kutta.catalogue.UnknownMethodError
        When no method has this name.
    """
    span = time_span(t_span)
    equations = Form(module, form, numbers("params", params, module.PARAMETERS).tolist())
    start = numbers("y0", y0, equations.ordinary)
    tableau = None if method in SCIPY else load(str(method))
    relative, absolute = tolerances(rtol, atol, len(start)) if h is None else (0.0, np.array(0.0))
    if h is not None:
        if tableau is None:
            raise ValueError(f"method {method!r} is SciPy's and controls its steps: leave out h")
        h = step(h, span)
    elif tableau is not None and not tableau.b_hat:
        raise ValueError(f"method {method!r} does not estimate its error: give a fixed step h")
    elif absolute.ndim and form != "lagrangian":
        raise ValueError("atol for each component has a meaning in form 'lagrangian' only")
    if tableau is not None and not tableau.is_explicit and not equations.has_jacobian:
        raise ValueError(f"method {method!r} needs a Jacobian, which form {form!r} does not have")
    return Problem(
        equations, tableau or method, span, start, h, relative, absolute,
        None if t_eval is None else times(t_eval, span), callables(events, module),
        count("max_steps", max_steps, 0),
    )  # fmt: skip


def numbers(name: str, values: ArrayLike, expected: Sequence[str]) -> Array:
    """`values` as a new array of finite floats, one for each name in `expected`."""
    array = _floats(name, values)
    if array.shape != (len(expected),):
        raise ValueError(
            f"{name} has shape {array.shape}: give {len(expected)} numbers, {', '.join(expected)}"
        )
    _finite(name, array)
    return array


def rung(backend: str | None, compensated: bool) -> str | None:
    """Where a loop must run, ``compiled`` or ``python``; None if it may be either."""
    if backend not in (None, "compiled", "python"):
        raise ValueError(f"backend {backend!r} must be 'compiled' or 'python'")
    if compensated and backend == "python":
        raise ValueError("compensated = True needs a compiled loop, not backend 'python'")
    return "compiled" if compensated else backend


def table(name: str, values: ArrayLike, expected: Sequence[str]) -> Array:
    """`values` as a new array of rows of finite floats, one column for each name in `expected`."""
    array = _floats(name, values)
    if array.ndim != 2 or array.shape[1] != len(expected):
        raise ValueError(
            f"{name} has shape {array.shape}: give rows of {len(expected)} numbers, "
            + ", ".join(expected)
        )
    _finite(name, array)
    return array


def time_span(values: ArrayLike) -> tuple[float, float]:
    """Beginning and end."""
    array = numbers("t_span", values, ("t_start", "t_end"))
    return float(array[0]), float(array[1])


def times(values: ArrayLike, span: tuple[float, float]) -> Array:
    """Times within `span`, each further from its beginning than the one before."""
    array = _floats("t_eval", values)
    if array.ndim != 1:
        raise ValueError(f"t_eval has shape {array.shape}: give a list of times")
    _finite("t_eval", array)
    low, high = sorted(span)
    outside = array[(array < low) | (array > high)]
    if outside.size:
        raise ValueError(f"t_eval has {outside[0]}, outside of t_span = {span}")
    if np.any(np.diff(array) * np.sign(span[1] - span[0]) <= 0):
        raise ValueError("t_eval must go from t_span's beginning to its end, no time twice")
    return array


def tolerances(rtol: float, atol: ArrayLike, size: int) -> tuple[float, Array]:
    """Tolerances, of which one at least is positive in every component."""
    array = _floats("atol", atol)
    relative = _floats("rtol", rtol)
    for name, value in (("rtol", relative), ("atol", array)):
        _finite(name, value)
        if np.any(value < 0):
            raise ValueError(f"{name} = {value} must not be negative")
    if relative.ndim or array.shape not in ((), (size,)):
        raise ValueError(f"rtol must be a number, atol a number or {size} of them")
    if relative == 0 and np.any(array == 0):
        raise ValueError("rtol and atol are both 0: no step is short enough; make one positive")
    if 0 < relative < 4 * np.finfo(float).eps:
        raise ValueError(f"rtol = {relative} is below the resolution of numbers, 9e-16")
    return float(relative), array


def step(h: float, span: tuple[float, float]) -> float:
    """A fixed step: positive, and large enough to change the time."""
    array = _floats("h", h)
    if array.ndim or not np.isfinite(array) or array <= 0:
        raise ValueError(f"h = {h} must be a positive number (the direction follows from t_span)")
    resolution = SHORTEST * float(np.spacing(np.abs(span).max()))
    if array < resolution and span[0] != span[1]:
        raise ValueError(f"h = {h} is below the resolution {resolution} of times in {span}")
    return float(array)


def count(name: str, value: object, least: int) -> int:
    """A whole number, `least` or more."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise ValueError(f"{name} = {value!r} must be a whole number, {least} or more")
    if not least <= value <= MOST:
        raise ValueError(f"{name} = {value} must be from {least} to {MOST}")
    return int(value)


def check_positive(**numbers: float | None) -> None:
    """Refuse numbers that are not positive, or not finite.

    Parameters
    ----------
    **numbers : float or None
        By name; None is left out.

    Raises
    ------
    ValueError
        With the name of the first.
    """
    for name, number in numbers.items():
        if number is not None and not (np.isfinite(number) and number > 0):
            raise ValueError(f"{name} = {number} must be positive")


def callables(events: object, module: GeneratedModule) -> list[Callable[..., float]]:
    """Events as a list."""
    found: list[Any] = list(events) if isinstance(events, Sequence) else [events]
    if not all(map(callable, found)):
        raise ValueError(f"events = {events!r} must be functions event(t, y), one or a list")
    for event in found:
        if getattr(event, "name", None) and getattr(event, "module", module) is not module:
            raise ValueError(f"{event.name} of {event.module.__name__} is not of {module.__name__}")
    return found


def _floats(name: str, values: ArrayLike) -> Array:
    array = np.asarray(values)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{name} = {str(values)[:60]} must be real numbers")
    return np.array(array, dtype=float)


def _finite(name: str, array: Array) -> None:
    if not np.isfinite(array).all():
        raise ValueError(f"{name} = {array} must be finite")
