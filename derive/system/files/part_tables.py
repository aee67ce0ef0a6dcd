"""Rigid bodies, joints and links of a system in a TOML file.

A row has its kind as a key, with the first argument of the kind's function or class as the value;
its other keys are the names of the other arguments.
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from inspect import Parameter, signature
from pathlib import Path
from typing import Any

import sympy as sp

from derive.system.centred_links import Block, Box, Cart, Wheel
from derive.system.constraints import Constraint
from derive.system.joints.body_joints import hinge, prismatic
from derive.system.joints.point_joints import ball, fixed_distance, pin, slider
from derive.system.joints.rolling_joints import rolling_on_line, rolling_on_plane
from derive.system.line_links import Line, Link, Plate, Rail, Rod, Spring, Thread
from derive.system.orientation import Orientation, quaternion, rotation_matrix, rotations
from derive.system.parts import SystemDefinitionError
from derive.system.rigid_body import RigidBody
from solvers.io import toml_input
from solvers.io.suggestion import did_you_mean, shortened
from solvers.io.toml_input import InputError

#: Characters of the longest text.
MAX_TEXT = 20_000


def read(path: Path) -> dict[str, Any]:
    """The table of a TOML file; an `InputError` says why it cannot be read."""
    try:
        return toml_input.read_table(path, "formulas stand in quotes")
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error


class TomlTable:
    """A table with a name for messages, whose keys are among those that are `known`."""

    def __init__(self, name: str, values: object, known: Collection[str]) -> None:
        if not isinstance(values, Mapping):
            raise InputError(f"{name} = {shortened(values)} must be a table")
        self.name, self.values = name, values
        for key in values:
            if key not in known:
                raise InputError(
                    f"unknown key {key[:50]!r} in {name}{did_you_mean(key, known)}; "
                    f"known are {', '.join(known)}"
                )

    def text(self, key: str, default: str | None = None) -> str:
        """A text; refused if it is missing and there is no default."""
        value = self.values.get(key, default)
        if value is None:
            raise InputError(f"{key!r} is missing in {self.name}")
        return toml_input.text(key, value, f" in {self.name}", MAX_TEXT)

    def formula(self, key: str, default: str | None = None) -> str:
        """A formula as text; numbers may stand without quotes."""
        value = self.values.get(key, default)
        if isinstance(value, int | float) and not isinstance(value, bool):
            return repr(value)
        if not isinstance(value, str | None):
            raise InputError(
                f"{key} = {shortened(value)} in {self.name} must be a number or a formula in quotes"
            )
        return " ".join(self.text(key, default).split())

    def formulas(self, key: str) -> list[str]:
        """A list of formulas; empty if it is missing."""
        value = self.values.get(key, [])
        if not isinstance(value, list):
            raise InputError(
                f"{key} = {shortened(value)} in {self.name} must be a list in square brackets"
            )
        return [TomlTable(self.name, {key: item}, (key,)).formula(key) for item in value]

    def entries(self, key: str) -> dict[str, str]:
        """Names and formulas of a table in this one; none if it is missing."""
        values = self.values.get(key, {})
        row = TomlTable(key, values, values if isinstance(values, Mapping) else ())
        return {name: row.formula(name) for name in row.values}

    def flag(self, key: str, *, default: bool) -> bool:
        """True or false."""
        value = self.values.get(key, default)
        if not isinstance(value, bool):
            raise InputError(f"{key} = {shortened(value)} in {self.name} must be true or false")
        return value

    def tables(self, key: str, known: Collection[str]) -> "dict[str, TomlTable]":
        """The tables of a table, by name."""
        inner = self.values.get(key, {})
        if not isinstance(inner, Mapping):
            raise InputError(f"{key} = {shortened(inner)} must be a table: write [{key}]")
        return {name: TomlTable(f"{key}.{name}", values, known) for name, values in inner.items()}

    def listed(self, key: str, known: Collection[str], short: str = "") -> "list[TomlTable]":
        """The tables of a list, in which a text or number may be short for one key's value."""
        inner = self.values.get(key, [])
        if not isinstance(inner, list):
            form = "a list in square brackets" if short else f"tables: write [[{key}]]"
            raise InputError(f"{key} = {shortened(inner)} must be {form}")
        if short:
            inner = [one if isinstance(one, Mapping) else {short: one} for one in inner]
        return [TomlTable(f"{key} {k}", values, known) for k, values in enumerate(inner, 1)]

    def rows(self, key: str, columns: Sequence[str]) -> "list[TomlTable]":
        """The lists of a list as tables, with these names of their entries."""
        inner = self.values.get(key, [])
        form = f"[{', '.join(columns)}]"
        if not isinstance(inner, list):
            raise InputError(f"{key} = {shortened(inner)} must be a list of lists {form}")
        tables = []
        for k, entries in enumerate(inner, 1):
            if not isinstance(entries, list) or len(entries) != len(columns):
                raise InputError(f"{key} {k} = {shortened(entries)} must be a list {form}")
            values = dict(zip(columns, entries, strict=True))
            tables.append(TomlTable(f"{key} {k}", values, columns))
        return tables


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


JOINTS: dict[str, Callable[..., list[Constraint]]] = {
    joint.__name__: joint
    for joint in (pin, ball, slider, fixed_distance, hinge, prismatic,
        rolling_on_line, rolling_on_plane)
}  # fmt: skip
LINKS: dict[str, Callable[..., Link]] = {
    link.__name__.lower(): link
    for link in (Rod, Thread, Spring, Rail, Plate, Wheel, Block, Cart, Box)
}
#: Arguments that are orientations of bodies.
ORIENTATIONS = ("orientation", "first", "second")
#: The argument that is no key: the coordinates are those of the system.
COORDINATES = "coordinates"


def read_joints(table: TomlTable, value: Value, q: Sequence[sp.Symbol]) -> Iterator[Constraint]:
    """The constraints of the joints of a file; ``value(name, text)`` is the value of a formula."""
    for row, kind in _rows(table, "joints", JOINTS):
        arguments = {key: _joint_value(row, key, value) for key in row.values if key != kind}
        if COORDINATES in signature(JOINTS[kind]).parameters:
            arguments[COORDINATES] = q
        with _named_errors(row):
            constraints = JOINTS[kind](row.text(kind), **arguments)
        yield from constraints


def read_links(table: TomlTable, value: Value) -> Iterator[Link]:
    """The links of a file; ``value(name, text)`` is the value of a formula."""
    for row, kind in _rows(table, "links", LINKS):
        formula, points = partial(value, row.name), row.values[kind]
        if LINKS[kind] not in Line.__subclasses__():
            points = [points]
        elif not isinstance(points, list):
            raise InputError(f"{kind} = {shortened(points)} in {row.name} must be a list of points")
        with _named_errors(row):
            places = [_place(row, kind, point, formula) for point in points]
            arguments = {key: _link_value(row, key, formula) for key in row.values if key != kind}
            link = LINKS[kind](*places, **arguments)
        yield link


def _arguments(part: Callable[..., Any]) -> dict[str, Parameter]:
    """The arguments of a kind that are keys beside the kind."""
    _, *others = signature(part).parameters.values()
    return {one.name: one for one in others if one.name != COORDINATES}


def _rows(
    table: TomlTable, name: str, kinds: Mapping[str, Callable[..., Any]]
) -> Iterator[tuple[TomlTable, str]]:
    """Rows of a file with their kinds; an `InputError` names a key that is missing or unknown."""
    keys = dict.fromkeys(key for part in kinds.values() for key in _arguments(part))
    for row in table.listed(name, (*kinds, *keys)):
        own = [kind for kind in kinds if kind in row.values]
        if len(own) != 1:
            raise InputError(f"{row.name} must have one of the keys {', '.join(kinds)}")
        kind, known = own[0], _arguments(kinds[own[0]])
        named = f"its keys are {', '.join([kind, *known])}"
        for key, argument in known.items():
            if key not in row.values and argument.default is Parameter.empty:
                raise InputError(f"{row.name}: a {kind} needs {key}; {named}")
        for key in row.values:
            if key not in (kind, *known):
                raise InputError(f"{row.name}: a {kind} has no {key}; {named}")
        yield row, kind


@contextmanager
def _named_errors(row: TomlTable) -> Iterator[None]:
    try:
        yield
    except SystemDefinitionError as error:
        raise InputError(f"{row.name}: {error}") from error


def _joint_value(row: TomlTable, key: str, value: Value) -> object:
    if key in ORIENTATIONS:
        return orientation(row, key, value)
    if key in ("axis", "axle"):
        return row.text(key)
    formula, given = partial(value, row.name), row.values[key]
    return (
        _place(row, key, given, formula) if isinstance(given, list) else formula(row.formula(key))
    )


def _link_value(row: TomlTable, key: str, formula: Callable[[str], sp.Expr]) -> object:
    if key != "plane":
        return formula(row.formula(key))
    axes = row.values[key]
    if not isinstance(axes, list) or len(axes) != 2:
        raise InputError(f"plane = {shortened(axes)} in {row.name} must be two unit vectors")
    return tuple(_place(row, key, axis, formula) for axis in axes)


def _place(row: TomlTable, key: str, point: object, formula: Callable[[str], sp.Expr]) -> object:
    """A point: the number of a mass, or formulas of its components."""
    if isinstance(point, list):
        return tuple(map(formula, TomlTable(row.name, {key: point}, (key,)).formulas(key)))
    return point
