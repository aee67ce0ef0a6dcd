"""Rigid bodies of system files."""

from collections.abc import Callable
from typing import Any

import sympy as sp

from derive.system.bodies.orientation import Orientation, quaternion, rotation_matrix, rotations
from derive.system.bodies.rigid_body import RigidBody
from derive.system.files.tables import TomlTable
from solvers.io.suggestion import shortened
from solvers.io.toml_input import InputError

#: The value of the formula at a key.
Value = Callable[[str, str], sp.Expr]
KINDS = 'rotations = "zxz" with angles, quaternion, or matrix'


def rigid_body(
    row: TomlTable, value: Value, mass: sp.Expr, position: tuple[sp.Expr, ...]
) -> RigidBody:
    """The body of a table with ``inertia`` and ``angle``, or in space ``orientation``."""
    if "orientation" not in row.values:
        if isinstance(row.values.get("inertia"), list):
            raise InputError(
                f"{row.name} has three moments of inertia but no orientation: give {KINDS}, as "
                'orientation = { quaternion = ["w", "x", "y", "z"] }'
            )
        inertia, angle = (value(row.name, row.formula(key)) for key in ("inertia", "angle"))
        return RigidBody(mass, position, inertia, angle)
    if "angle" in row.values:
        raise InputError(f"{row.name} has an angle and an orientation: omit one of them")
    axes = orientation(row, "orientation", value)
    return RigidBody(mass, position, _formulas(row, "inertia", value), axes)


def orientation(row: TomlTable, key: str, value: Value) -> Orientation:
    """The orientation of a table at a key of a row."""
    known = ("rotations", "angles", "quaternion", "matrix")
    table = TomlTable(f"{key} of {row.name}", row.values[key], known)
    kinds = [key for key in table.values if key != "angles"]
    if len(kinds) != 1 or ("angles" in table.values) != (kinds == ["rotations"]):
        raise InputError(f"{table.name} has the keys {', '.join(table.values)}: give {KINDS}")
    if kinds == ["rotations"]:
        return rotations(table.text("rotations"), _formulas(table, "angles", value))
    if kinds == ["matrix"]:
        return rotation_matrix(_formulas(table, "matrix", value))
    parts = _formulas(table, "quaternion", value)
    if len(parts) != 4:
        raise InputError(f"{table.name}: quaternion has {len(parts)} components: give four")
    return quaternion(*parts)


def _formulas(table: TomlTable, key: str, value: Value) -> Any:
    """Formulas of a list, or of a list of lists."""
    rows = table.values.get(key)
    if not isinstance(rows, list):
        raise InputError(f"{key} = {shortened(rows)} in {table.name} must be a list in brackets")
    inner = [TomlTable(table.name, {key: row}, (key,)) for row in rows]
    return [
        [value(table.name, text) for text in row.formulas(key)]
        if isinstance(row.values[key], list)
        else value(table.name, row.formula(key))
        for row in inner
    ]
