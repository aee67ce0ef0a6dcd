"""Joints of a system in a TOML file, with the arguments of the functions as keys."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from inspect import Parameter, signature
from typing import Any

import sympy as sp

from derive.system.constraints import Constraint
from derive.system.orientation import Orientation, rotation_matrix
from derive.system.parts import SystemDefinitionError
from derive.system.point_joints import ball, fixed_distance, pin, slider
from derive.system.rolling_joints import rolling_on_line, rolling_on_plane
from derive.system.tables import Table
from solvers.io.suggestion import shortened
from solvers.io.toml_input import InputError

JOINTS: dict[str, Callable[..., list[Constraint]]] = {
    joint.__name__: joint
    for joint in (pin, ball, slider, fixed_distance, rolling_on_line, rolling_on_plane)
}
#: Arguments that are no keys: the name is the value of the kind, coordinates are the system's.
IMPLIED = ("name", "coordinates")


def _arguments(kind: str) -> dict[str, Parameter]:
    parameters = signature(JOINTS[kind]).parameters
    return {key: value for key, value in parameters.items() if key not in IMPLIED}


#: Keys of all kinds, in order.
KEYS = (*JOINTS, *dict.fromkeys(key for kind in JOINTS for key in _arguments(kind)))


def read_joints(
    table: Table, value: Callable[[str, str], sp.Expr], q: Sequence[sp.Symbol]
) -> Iterator[Constraint]:
    """The constraints of the joints of a file; ``value(key, text)`` is the value of a formula."""
    for row in table.listed("joints", KEYS):
        kinds = [kind for kind in JOINTS if kind in row.values]
        if len(kinds) != 1:
            raise InputError(f"{row.name} must have one of the keys {', '.join(JOINTS)}")
        try:
            arguments = _values(row, kinds[0], partial(value, row.name))
            if "coordinates" in signature(JOINTS[kinds[0]]).parameters:
                arguments["coordinates"] = q
            yield from JOINTS[kinds[0]](row.text(kinds[0]), **arguments)
        except SystemDefinitionError as error:
            raise InputError(f"{row.name}: {error}") from error


def _values(row: Table, kind: str, value: Callable[[str], sp.Expr]) -> dict[str, Any]:
    known = _arguments(kind)
    values: dict[str, Any] = {}
    for key, argument in known.items():
        if key not in row.values and argument.default is Parameter.empty:
            raise InputError(f"{row.name} needs {key}; the keys of a {kind} are {', '.join(known)}")
    for key, given in row.values.items():
        if key == kind:
            continue
        if key not in known:
            raise InputError(f"{row.name} is a {kind}, without {key}: keys are {', '.join(known)}")
        if key == "orientation":
            values[key] = _orientation(row, given, value)
        elif isinstance(given, list):
            values[key] = tuple(map(value, row.formulas(key)))
        else:
            values[key] = value(row.formula(key))
    return values


def _orientation(row: Table, given: object, value: Callable[[str], sp.Expr]) -> Orientation:
    """The orientation with a rotation matrix, a list of its rows."""
    if not isinstance(given, list):
        raise InputError(
            f"orientation = {shortened(given)} in {row.name} must be a matrix, a list of three "
            "rows of three formulas each"
        )
    rows = (Table(row.name, {"orientation": one}, ("orientation",)) for one in given)
    return rotation_matrix([[*map(value, one.formulas("orientation"))] for one in rows])
