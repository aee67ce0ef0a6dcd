"""Checks of numbers: real, finite, and of the sign that a generated module declares."""

import re
from collections.abc import Iterable, Mapping, Sequence
from math import isfinite
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.module import GeneratedModule, outputs
from solvers.io.quantity import QuantityError
from solvers.io.quantity import quantity as parsed_quantity
from solvers.io.suggestion import did_you_mean, shortened

Array: TypeAlias = NDArray[np.float64]
#: Numbers in the order of their names, or by name.
Values: TypeAlias = ArrayLike | Mapping[str, Any]
#: Types of which every value is real; NumPy converts text, booleans and missing values, too.
REAL = frozenset((int, float, np.float64))
#: A number without a unit.
NUMBER = re.compile(r"\s*[-+]?[\d.]+(?:[eE][-+]?\d+)?\s*\Z")
Defaults: TypeAlias = Mapping[str, float | Array]


class NotFiniteNumberError(ValueError, ArithmeticError):
    """NaN or infinity in place of a number; from a user's function, it ends a run that began."""


def finite_row(values: Any) -> Sequence[float] | None:
    """Finite numbers in a usual form: one alone, or a tuple, list or array of them; else None.

    Functions that are called often accept these at once.
    """
    if type(values) is np.ndarray and values.ndim == 1:
        values = values.tolist()
    row: Sequence[Any] = (values,) if type(values) in REAL else values
    if type(row) not in (tuple, list) or not REAL.issuperset(map(type, row)):
        return None
    try:
        return row if all(map(isfinite, row)) else None
    except OverflowError:  # of an integer
        return None


def real_numbers(
    name: str, values: object, unit: str = "", *, finite: bool = True, nan: bool = False
) -> Array:
    """`values`, of any shape, as a new array of real numbers that are finite, unless allowed.

    Not `finite` allows infinity, `nan` allows all values.
    """
    kind = "finite real number" if finite else "real number"
    allowed = f"must be a {kind}{unit and f' in {unit}'}, such as 1.0"
    if invalid := _not_real(values):
        place, value = invalid
        raise ValueError(f"{name}{place} = {shortened(value)} {allowed}")
    try:
        array = np.array(values, dtype=float)
    except ValueError as error:
        raise ValueError(
            f"{name} = {shortened(values)} has parts of different lengths: make them equal"
        ) from error
    except OverflowError as error:
        raise ValueError(f"{name} = {shortened(values)} {allowed}, below 1.8e308") from error
    unusable = ~np.isfinite(array) if finite else np.isnan(array)
    if unusable.any() and not nan:
        raise NotFiniteNumberError(f"{_first(name, array, unusable)} {allowed}")
    return array


def without_texts(name: str, values: Any, unit: str) -> Any:
    """The values with numbers in place of texts such as ``90 deg``, also in lists.

    A number in quotes remains a text.
    """
    if isinstance(values, str) and not NUMBER.match(values):
        try:
            return parsed_quantity(values, unit)
        except QuantityError as error:
            raise ValueError(f"{name}: {error}") from error
    if isinstance(values, list | tuple) and not REAL.issuperset(map(type, values)):
        return [without_texts(f"{name}[{k}]", value, unit) for k, value in enumerate(values)]
    return values


def _not_real(values: Any) -> tuple[str, object] | None:
    """Place and value of the first entry that is no real number; None where all are."""
    if isinstance(values, list | tuple):
        if REAL.issuperset(map(type, values)):
            return None
        for k, value in enumerate(values):
            if invalid := _not_real(value):
                return f"[{k}]{invalid[0]}", invalid[1]
        return None
    is_real = isinstance(values, int) and not isinstance(values, bool)
    is_real = is_real or np.asarray(values).dtype.kind in "iuf"
    return None if is_real and not np.ma.is_masked(values) else ("", values)


def _first(name: str, array: Array, wrong: NDArray[np.bool_]) -> str:
    """The first wrong entry of an array, with its place and value."""
    index = np.unravel_index(int(np.argmax(wrong)), array.shape)
    return f"{name}{''.join(f'[{k}]' for k in index)} = {array[index]}"


def real_number(name: str, value: object, unit: str = "", *, finite: bool = True) -> float:
    """One real number that is finite, unless infinity is allowed."""
    number = real_numbers(name, value, unit, finite=finite)
    if number.ndim:
        raise ValueError(f"{name} = {shortened(value)} must be one number, not several")
    return float(number)


def positive(name: str, value: object, *, finite: bool = True) -> float:
    """A positive number."""
    number = real_number(name, value, finite=finite)
    if number <= 0:
        raise ValueError(f"{name} = {number} must be positive")
    return number


def quantity(
    module: GeneratedModule, name: str, values: object, *, absent: bool = True, nan: bool = False
) -> Array:
    """Values, of any shape, of a parameter or component of the state, as the module declares it.

    Where parts may be `absent`, a positive parameter may be 0, such as a mass that does not exist.
    """
    unit = module.UNITS.get(name, "")
    array = real_numbers(name, without_texts(name, values, unit), unit, nan=nan)
    if name in module.POSITIVE:
        wrong = array < 0 if absent and name in module.PARAMETERS else array <= 0
        if wrong.any():
            raise ValueError(f"{_first(name, array, wrong)} must be positive, in {unit}")
    return array


def quantities(
    module: GeneratedModule,
    what: str,
    names: Sequence[str],
    values: Values,
    defaults: Defaults,
    *,
    nan: bool = False,
) -> Array:
    """Values of the quantities `names`, the first axis; a mapping is completed by `defaults`.

    The shape of a sequence is that of `values`, to be checked by the caller.
    """
    given: Any = values
    if isinstance(values, Mapping):
        check_outputs(module, what, values)
        given = _in_order(what, names, values, defaults)
    elif not isinstance(values, list | tuple):
        given = np.asarray(values)
        if not given.ndim:
            return real_numbers(what, values)
    if len(given) != len(names):
        return real_numbers(what, values)
    columns = [quantity(module, *pair, nan=nan) for pair in zip(names, given, strict=True)]
    try:
        return np.array(np.broadcast_arrays(*columns) if given is not values else columns)
    except ValueError as error:
        shapes = ", ".join(f"{n}: {c.shape}" for n, c in zip(names, columns, strict=True))
        raise ValueError(f"the values of {what} differ in shape: {shapes}") from error


def check_outputs(module: GeneratedModule, what: str, names: Iterable[str]) -> None:
    """Refuse values of outputs, such as coordinates that were eliminated."""
    for name in names:
        if name in outputs(module):
            raise ValueError(
                f"{what} has {name!r}, which follows from {', '.join(module.COORDINATES)}: give "
                "these, or derive the system with keep_coordinates=True"
            )


def _in_order(
    what: str, names: Sequence[str], values: Mapping[str, Any], defaults: Defaults
) -> list[Any]:
    """The values of a mapping in the order of `names`."""
    for name in values:
        if name not in names:
            hint, known = did_you_mean(str(name), names), ", ".join(names) or "none"
            raise ValueError(f"{what} has no {name!r}{hint}; known names: {known}")
    if missing := [name for name in names if name not in values and name not in defaults]:
        raise ValueError(f"{what} lacks {', '.join(missing)}, on which the motion depends")
    return [values.get(name, defaults.get(name)) for name in names]
