"""Joints of a system in a TOML file, with the arguments of the functions as keys."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from inspect import Parameter, signature
from typing import Any

import sympy as sp

from derive.system.constraints import Constraint
from derive.system.files.body_tables import Value, orientation
from derive.system.files.tables import TomlTable
from derive.system.joints.body_joints import hinge, prismatic
from derive.system.joints.point_joints import ball, fixed_distance, pin, slider
from derive.system.joints.rolling_joints import rolling_on_line, rolling_on_plane
from derive.system.parts import SystemDefinitionError
from solvers.io.toml_input import InputError

JOINTS: dict[str, Callable[..., list[Constraint]]] = {
    joint.__name__: joint
    for joint in (pin, ball, slider, fixed_distance, hinge, prismatic,
        rolling_on_line, rolling_on_plane)
}  # fmt: skip
#: Arguments that are orientations of bodies.
ORIENTATIONS = ("orientation", "first", "second")
#: Arguments that are no keys: the name is the value of the kind, coordinates are the system's.
IMPLIED = ("name", "coordinates")


def _arguments(kind: str) -> dict[str, Parameter]:
    parameters = signature(JOINTS[kind]).parameters
    return {key: value for key, value in parameters.items() if key not in IMPLIED}


#: Keys of all kinds, in order.
KEYS = (*JOINTS, *dict.fromkeys(key for kind in JOINTS for key in _arguments(kind)))


def read_joints(table: TomlTable, value: Value, q: Sequence[sp.Symbol]) -> Iterator[Constraint]:
    """The constraints of the joints of a file."""
    for row in table.listed("joints", KEYS):
        kinds = [kind for kind in JOINTS if kind in row.values]
        if len(kinds) != 1:
            raise InputError(f"{row.name} must have one of the keys {', '.join(JOINTS)}")
        try:
            arguments = _values(row, kinds[0], value)
            if "coordinates" in signature(JOINTS[kinds[0]]).parameters:
                arguments["coordinates"] = q
            yield from JOINTS[kinds[0]](row.text(kinds[0]), **arguments)
        except SystemDefinitionError as error:
            raise InputError(f"{row.name}: {error}") from error


def _values(row: TomlTable, kind: str, value: Value) -> dict[str, Any]:
    known, formula = _arguments(kind), partial(value, row.name)
    values: dict[str, Any] = {}
    for key, argument in known.items():
        if key not in row.values and argument.default is Parameter.empty:
            raise InputError(f"{row.name} needs {key}; the keys of a {kind} are {', '.join(known)}")
    for key, given in row.values.items():
        if key == kind:
            continue
        if key not in known:
            raise InputError(f"{row.name} is a {kind}, without {key}: keys are {', '.join(known)}")
        if key in ORIENTATIONS:
            values[key] = orientation(row, key, value)
        elif key in ("axis", "axle"):
            values[key] = row.text(key)
        elif isinstance(given, list):
            values[key] = tuple(map(formula, row.formulas(key)))
        else:
            values[key] = formula(row.formula(key))
    return values
