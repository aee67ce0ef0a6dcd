"""A system as a TOML file: positions as text, read and never executed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isfinite
from pathlib import Path
from typing import Any

import sympy as sp

from derive.formulas.expression import FUNCTIONS, ExpressionError, parse
from derive.system.naming import IDENTIFIER, check_name
from derive.system.parts import Coordinate, Parameter, PointMass, RigidBody, SystemDefinitionError
from derive.system.symbols import TIME, velocity
from derive.system.system import System
from derive.system.tables import Table, read
from solvers.io.toml_input import InputError

KEYS = (
    "name", "title", "coordinates", "parameters", "definitions", "masses", "potential", "gravity",
    "dissipation", "forces", "equilibrium", "reactions",
)  # fmt: skip
#: What cannot be negative or zero, unless it says so.
POSITIVE_UNITS = ("kg", "m")


def read_system(path: Path) -> System:
    """The system that a TOML file describes.

    Parameters
    ----------
    path : Path
        Its name without ``.toml`` is the system's, unless the file gives another.

    Returns
    -------
    System

    Raises
    ------
    SystemDefinitionError
        When it describes none; the message says where, and what is allowed.
    """
    try:
        return _system(path.stem, Table(str(path), read(path), KEYS))
    except (InputError, ExpressionError, SystemDefinitionError) as error:
        message = str(error)
        raise SystemDefinitionError(
            message if message.startswith(str(path)) else f"{path}: {message}"
        ) from error


def _system(stem: str, table: Table) -> System:
    name = table.text("name", stem)
    if not IDENTIFIER.match(name):
        raise InputError(f'{name[:50]!r} cannot be the system\'s name: give another, name = "…"')
    for key in ("coordinates", "masses"):
        if key not in table.values:
            raise InputError(f"{key!r} is missing: a system needs coordinates and masses")
    coordinates = [
        Coordinate(
            _symbol(key, name, positive=row.flag("positive", default=False)),
            row.text("unit", "rad"), row.text("meaning", key),
        )
        for key, row in table.tables("coordinates", ("unit", "meaning", "positive")).items()
    ]  # fmt: skip
    parameters = [_parameter(key, name, row) for key, row in table.tables(
        "parameters", ("value", "unit", "meaning", "positive")).items()]  # fmt: skip
    symbols = [*(c.symbol for c in coordinates), *(p.symbol for p in parameters), TIME]
    scope: dict[str, Any] = {
        **FUNCTIONS, **{s.name: s for s in symbols},
        **{velocity(c.symbol).name: velocity(c.symbol) for c in coordinates},
    }  # fmt: skip
    for key, text in table.entries("definitions").items():
        check_name(key, name)
        if key in scope:
            raise InputError(f"definitions.{key}: that name is taken")
        try:
            scope[key] = _value(f"definitions.{key}", text, scope)
        except InputError as error:
            raise InputError(f"{error}; a definition may use those above it") from error

    def optional(key: str) -> sp.Expr | None:
        return _value(key, table.formula(key), scope) if key in table.values else None

    def by_coordinate(key: str) -> list[sp.Expr] | None:
        given = table.entries(key)
        known = [c.symbol.name for c in coordinates]
        for other in set(given) - set(known):
            raise InputError(f"{key}.{other[:50]}: coordinates are {', '.join(known)}")
        texts = [given.get(coordinate, "0") for coordinate in known]
        return [_value(key, text, scope) for text in texts] if given else None

    gravity = [_value("gravity", text, scope) for text in table.formulas("gravity")]
    return System(
        name=name,
        title=table.text("title", name),
        coordinates=coordinates,
        parameters=parameters,
        masses=list(_masses(table, scope)),
        potential=optional("potential"),
        gravity=gravity or None,
        dissipation=optional("dissipation") or sp.S.Zero,
        forces=by_coordinate("forces") or (),
        equilibrium=by_coordinate("equilibrium"),
        reactions=[_value("reactions", text, scope) for text in table.formulas("reactions")],
    )


def _masses(table: Table, scope: Mapping[str, Any]) -> Iterator[PointMass]:
    for row in table.listed("masses", ("mass", "position", "inertia", "angle")):
        mass = _value(row.name, row.formula("mass"), scope)
        position = tuple(_value(row.name, text, scope) for text in row.formulas("position"))
        if "inertia" in row.values or "angle" in row.values:
            inertia, angle = (
                _value(row.name, row.formula(key), scope) for key in ("inertia", "angle")
            )
            yield RigidBody(mass, position, inertia, angle)
        else:
            yield PointMass(mass, position)


def _parameter(key: str, system: str, row: Table) -> Parameter:
    unit = row.text("unit", "1")
    try:
        value = float(_value(row.name, row.formula("value"), FUNCTIONS))
    except InputError as error:
        raise InputError(f"{error}; value is a number, its unit stands in unit = …") from error
    is_positive = row.flag("positive", default=unit in POSITIVE_UNITS)
    if not isfinite(value) or (is_positive and value <= 0):
        raise InputError(
            f"{row.name} = {value} must be a {'positive' if is_positive else 'finite'} number"
        )
    symbol = _symbol(key, system, positive=is_positive)
    return Parameter(symbol, unit, value, row.text("meaning", key))


def _symbol(name: str, system: str, *, positive: bool) -> sp.Symbol:
    check_name(name, system)  # before SymPy or a compiler sees it
    return sp.Symbol(name, positive=True) if positive else sp.Symbol(name, real=True)


def _value(place: str, text: str, scope: Mapping[str, Any]) -> sp.Expr:
    try:
        value = parse(text, scope)
    except ExpressionError as error:
        raise InputError(f"{place}: {error}") from error
    if not isinstance(value, sp.Expr):
        raise InputError(f"{place}: {text[:50]!r} must be a number, not a column or matrix")
    return value
