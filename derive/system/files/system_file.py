"""A system as a TOML file: positions as text, read and never executed."""

from collections import ChainMap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import isfinite
from os import PathLike
from pathlib import Path
from typing import Any

import sympy as sp

from derive.formulas.budget import MAX_FACTORS_IN_SYSTEM, MAX_SECOND_IN_SYSTEM, Budget
from derive.formulas.expression import FUNCTIONS, number
from derive.formulas.syntax import ExpressionError
from derive.system.constraints import Constraint
from derive.system.files.part_tables import TomlTable, read, read_joints, read_links, rigid_body
from derive.system.naming import IDENTIFIER, check_name
from derive.system.parts import (
    Coordinate,
    Input,
    Parameter,
    PointMass,
    SystemDefinitionError,
)
from derive.system.symbols import TIME, velocity
from derive.system.system import System
from solvers.io.toml_input import InputError

KEYS = (
    *("name", "title", "coordinates", "parameters", "definitions", "masses", "potential"),
    *("gravity", "dissipation", "forces", "equilibrium", "reactions", "inputs"),
    *("outputs", "constraints", "coincide", "keep_coordinates", "joints", "links"),
)
#: Units of parameters that are positive by default.
POSITIVE_UNITS = ("kg", "m")


@dataclass(frozen=True)
class Formulas:
    """The names that formulas of a file can contain, and the budget that all of them share."""

    namespace: Mapping[str, Any]
    budget: Budget

    def value(self, key: str, text: str) -> sp.Expr:
        """The value of the formula at a key; an `InputError` names the key."""
        try:
            return number(text, self.namespace, self.budget)
        except ExpressionError as error:
            raise InputError(f"{key}: {error}") from error


def read_system(file: str | PathLike[str]) -> System:
    """The system in a TOML file; its default name is the file's name without ``.toml``."""
    path = Path(file)
    try:
        return _system(path.stem, TomlTable(str(path), read(path), KEYS))
    except (InputError, ExpressionError, SystemDefinitionError) as error:
        message = str(error)
        prefix = "" if message.startswith(str(path)) else f"{path}: "
        raise SystemDefinitionError(f"{prefix}{message}") from error


def _system(stem: str, table: TomlTable) -> System:
    name = table.text("name", stem)
    if not IDENTIFIER.match(name):
        raise InputError(f'{name[:50]!r} cannot be the name of a system: give another, name = "…"')
    for key in ("coordinates", "masses"):
        if key not in table.values:
            raise InputError(f"{key!r} is missing: a system needs coordinates and masses")
    rows = table.tables("coordinates", ("unit", "meaning", "positive"))
    coordinates = [_coordinate(key, name, row) for key, row in rows.items()]
    rows = table.tables("parameters", ("value", "unit", "meaning", "positive"))
    budget = Budget(MAX_SECOND_IN_SYSTEM, MAX_FACTORS_IN_SYSTEM)
    numbers = Formulas(FUNCTIONS, budget)
    parameters = [_parameter(key, name, row, numbers) for key, row in rows.items()]
    rows = table.tables("inputs", ("unit", "meaning", "motion"))
    inputs = [_input(key, name, row) for key, row in rows.items()]
    q = [coordinate.symbol for coordinate in coordinates]
    symbols = [*q, *(p.symbol for p in parameters), *(u.symbol for u in inputs)]
    symbols += [TIME, *map(velocity, q), *(velocity(u.symbol) for u in inputs if u.motion)]
    namespace = FUNCTIONS | {symbol.name: symbol for symbol in symbols}
    formulas = Formulas(namespace, budget)
    formulas = Formulas(namespace | _definitions(table, name, formulas), budget)
    formula, each = partial(_formula, table, formulas), partial(_by_coordinate, table, formulas, q)
    return System(
        name=name,
        title=table.text("title", name),
        coordinates=coordinates,
        parameters=parameters,
        masses=list(_masses(table, formulas)),
        potential=formula("potential"),
        gravity=_list(table, formulas, "gravity") or None,
        dissipation=formula("dissipation") or sp.S.Zero,
        forces=each("forces") or (),
        equilibrium=each("equilibrium"),
        reactions=[*_lengths(table, formulas, "reactions")],
        inputs=inputs,
        outputs=_outputs(table, formulas),
        constraints=[*_constraints(table, formulas), *read_joints(table, formulas.value, q)],
        coincide=[*_pairs(table, formulas)],
        links=[*read_links(table, formulas.value)],
        keep_coordinates=table.flag("keep_coordinates", default=False),
    )


def _definitions(table: TomlTable, system: str, formulas: Formulas) -> dict[str, Any]:
    definitions: dict[str, Any] = {}
    known = {**formulas.namespace}
    own = replace(
        formulas, namespace=ChainMap(definitions, known)
    )  # which grows with the definitions
    for key, text in table.entries("definitions").items():
        check_name(key, system)
        if key in known:
            raise InputError(f"definitions.{key}: the name is already used; choose another")
        try:
            definitions[key] = own.value(f"definitions.{key}", text)
        except InputError as error:
            raise InputError(f"{error}; a definition may use those above it") from error
    return definitions


def _outputs(table: TomlTable, formulas: Formulas) -> dict[str, sp.Expr]:
    entries = table.entries("outputs").items()
    return {key: formulas.value(f"outputs.{key}", text) for key, text in entries}


def _formula(table: TomlTable, formulas: Formulas, key: str) -> sp.Expr | None:
    return formulas.value(key, table.formula(key)) if key in table.values else None


def _list(table: TomlTable, formulas: Formulas, key: str) -> list[sp.Expr]:
    return [formulas.value(key, text) for text in table.formulas(key)]


def _lengths(table: TomlTable, formulas: Formulas, key: str) -> Iterator[sp.Symbol]:
    for text in table.formulas(key):
        value = formulas.value(key, text)
        if not isinstance(value, sp.Symbol):
            raise InputError(f"{key}: {text[:50]!r} must be the name of a constant length")
        yield value


def _constraints(table: TomlTable, formulas: Formulas) -> Iterator[Constraint]:
    known = ("formula", "name", "unit", "meaning")
    for k, row in enumerate(table.listed("constraints", known, short="formula"), 1):
        formula = formulas.value(row.name, row.formula("formula"))
        name, meaning = row.text("name", f"lambda_{k}"), row.text("meaning", "")
        yield Constraint(formula, name, row.text("unit", "1"), meaning)


def _pairs(table: TomlTable, formulas: Formulas) -> Iterator[tuple[Any, ...]]:
    for row in table.rows("coincide", ("first", "second")):
        first, second = (
            [formulas.value(row.name, text) for text in row.formulas(key)] for key in row.values
        )
        yield first, second


def _by_coordinate(
    table: TomlTable, formulas: Formulas, q: Sequence[sp.Symbol], key: str
) -> list[sp.Expr] | None:
    """One formula for each coordinate, by default 0; None if there are none."""
    texts = table.entries(key)
    names = [symbol.name for symbol in q]
    for other in set(texts) - set(names):
        raise InputError(f"{key}.{other[:50]}: coordinates are {', '.join(names)}")
    return [formulas.value(key, texts.get(name, "0")) for name in names] if texts else None


def _masses(table: TomlTable, formulas: Formulas) -> Iterator[PointMass]:
    for row in table.listed("masses", ("mass", "position", "inertia", "angle", "orientation")):
        mass, *position = (
            formulas.value(row.name, text)
            for text in (row.formula("mass"), *row.formulas("position"))
        )
        if {"inertia", "angle", "orientation"} & {*row.values}:
            yield rigid_body(row, formulas.value, mass, tuple(position))
        else:
            yield PointMass(mass, tuple(position))


def _coordinate(key: str, system: str, row: TomlTable) -> Coordinate:
    symbol = _symbol(key, system, positive=row.flag("positive", default=False))
    return Coordinate(symbol, row.text("unit", "rad"), row.text("meaning", key))


def _input(key: str, system: str, row: TomlTable) -> Input:
    symbol = _symbol(key, system, positive=False)
    is_motion = row.flag("motion", default=False)
    return Input(symbol, row.text("unit", "1"), row.text("meaning", key), is_motion)


def _parameter(key: str, system: str, row: TomlTable, numbers: Formulas) -> Parameter:
    unit = row.text("unit", "1")
    try:
        value = float(numbers.value(row.name, row.formula("value")))
    except TypeError:  # which SymPy raises for complex numbers
        raise InputError(
            f"{row.name}: value = {row.formula('value')[:50]!r} is not a real number"
        ) from None
    except InputError as error:
        raise InputError(f"{error}; value is a number, its unit is given by unit = …") from error
    is_positive = row.flag("positive", default=unit in POSITIVE_UNITS)
    if not isfinite(value) or (is_positive and value <= 0):
        kind = "positive" if is_positive else "finite"
        raise InputError(f"{row.name} = {value} must be a {kind} number")
    symbol = _symbol(key, system, positive=is_positive)
    return Parameter(symbol, unit, value, row.text("meaning", key))


def _symbol(name: str, system: str, *, positive: bool) -> sp.Symbol:
    check_name(name, system)  # before SymPy or a compiler uses it
    return sp.Symbol(name, positive=True) if positive else sp.Symbol(name, real=True)
