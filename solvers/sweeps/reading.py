"""Sweeps from TOML files: everything that makes no sense is refused when the file is read."""

from __future__ import annotations

import csv
import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from solvers.scenes.checks import near
from solvers.scenes.quantity import QuantityError, quantity, shown
from solvers.sweeps.axes import Axes, Grid, Random, Table
from solvers.sweeps.maps import (
    EnergyError,
    Extremes,
    Final,
    First,
    Lyapunov,
    Map,
    Samples,
    Section,
)
from solvers.sweeps.sweep import ENERGY, FROM_ENERGY, Sweep

FILES = Path(__file__).parent / "files"
#: Bytes of the largest file of a sweep.
LARGEST = 100_000
NEEDED = ("system", "duration", "axes", "maps")
KEYS = (
    *NEEDED, "title", "method", "rtol", "atol", "max_steps", "initial", "parameters", "random",
)  # fmt: skip
#: What a map of each kind is told.
KINDS: dict[str, tuple[str, ...]] = {
    "first": ("of", "barrier"),
    "final": ("of",),
    "extremes": ("of",),
    "samples": ("of", "count"),
    "section": ("of", "count", "where", "value", "direction"),
    "lyapunov": (),
    "energy error": (),
}
DIRECTIONS = {"both": 0, "up": 1, "down": -1}


class SweepError(ValueError):
    """A sweep that makes no sense; the message says which key, its value and what is allowed."""


def names() -> tuple[str, ...]:
    """Names of all sweeps that ship, in alphabetical order."""
    return tuple(sorted(path.stem for path in FILES.glob("*.toml")))


def find(name: str, module: Callable[[str], ModuleType]) -> Sweep:
    """The sweep of this name, or in this file.

    Parameters
    ----------
    name : str
        Of a sweep that ships, or the path of a file that ends in ``.toml``.
    module : callable
        Gives a generated module by its name; raises `LookupError` for an unknown one.

    Raises
    ------
    SweepError
        When there is none, or it makes no sense.
    OSError
        When the file cannot be read.
    """
    if name in names():
        return read(FILES / f"{name}.toml", module)
    if name.endswith(".toml"):
        return read(Path(name), module)
    raise SweepError(
        f"sweep {name[:80]!r} is not one of {', '.join(names())}{near(name, names())}; your own "
        "end in .toml"
    )


def read(path: Path, module: Callable[[str], ModuleType]) -> Sweep:
    """The sweep in a file.

    Raises
    ------
    SweepError
        When it makes no sense.
    OSError
        When the file cannot be read.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise SweepError(f"it has more than {LARGEST} bytes")
        table = tomllib.loads(path.read_bytes().decode())
        return _sweep(path, table, module)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise SweepError(
            f"{path} is no TOML file: {error}; a number with a unit stands in quotes"
        ) from error
    except ValueError as error:
        raise SweepError(f"{path}: {error}") from error


def _sweep(path: Path, table: Mapping[str, Any], module: Callable[[str], ModuleType]) -> Sweep:
    _keys("a sweep", table, KEYS)
    missing = [key for key in NEEDED if key not in table]
    if missing:
        raise SweepError(f"{missing[0]!r} is missing: a sweep needs {', '.join(NEEDED)}")
    name = _text("system", table["system"])
    try:
        equations = module(str(path.parent / name) if name.endswith(".toml") else name)
    except LookupError as error:
        raise SweepError(f"system = {name[:50]!r}: {error.args[0]}") from error
    initial = _table("initial", table.get("initial", {}), (*equations.STATE, ENERGY))
    parameters = _table("parameters", table.get("parameters", {}), equations.PARAMETERS)
    values: dict[str, float | str] = {}
    for key, value in {**initial, **parameters}.items():
        is_free = value == FROM_ENERGY and key in equations.STATE
        values[key] = FROM_ENERGY if is_free else _number(key, value, _unit(equations, key))
    maps = _table("maps", table["maps"], None)
    way = {key: table[key] for key in ("method", "max_steps") if key in table}
    way |= {key: _number(key, table[key], "1") for key in ("rtol", "atol") if key in table}
    title = str(equations.__doc__).partition(":")[0].partition(".")[0]
    return Sweep(
        equations,
        _axes(path, equations, table),
        {key: _map(f"maps.{key}", equations, one) for key, one in maps.items()},
        _number("duration", table["duration"], "s"),
        values,
        name=path.stem,
        title=_text("title", table.get("title", title)),
        **way,
    )


def _axes(path: Path, module: ModuleType, table: Mapping[str, Any]) -> Axes:
    axes, known = table["axes"], (*module.STATE, *module.PARAMETERS, ENERGY)
    if isinstance(axes, str):
        return _from_file(path.parent / axes, module)
    axes = _table("axes", axes, known)
    ends = {key: _limits(f"axes.{key}", one, _unit(module, key)) for key, one in axes.items()}
    if "random" in table:
        drawn = _table("random", table["random"], ("count", "seed"))
        for key, one in axes.items():
            _keys(f"axes.{key}", one, ("from", "to"))
        return Random(ends, drawn.get("count", 0), drawn.get("seed", 0))
    return Grid({
        key: np.linspace(*ends[key], _whole(f"axes.{key}.count", one.get("count"), 1))
        for key, one in axes.items()
    })  # fmt: skip


def _limits(key: str, one: object, unit: str) -> tuple[float, float]:
    one = _table(key, one, ("from", "to", "count"))
    if not {"from", "to"} <= {*one}:
        raise SweepError(f"{key} needs from and to, and on a grid their count")
    return _number(f"{key}.from", one["from"], unit), _number(f"{key}.to", one["to"], unit)


def _from_file(path: Path, module: ModuleType) -> Table:
    """A table with names in its first line, and numbers in their units below."""
    if path.suffix != ".csv":
        raise SweepError(f"axes = {path.name!r} must be a table that ends in .csv, or be written "
                         "as [axes]")  # fmt: skip
    with open(path, encoding="utf-8", newline="") as file:
        rows = [row for row in csv.reader(file) if row]
    if len(rows) < 2 or any(len(row) != len(rows[0]) for row in rows):
        raise SweepError(f"{path.name} must have names in its first line, and as many numbers in "
                         "each of the others")  # fmt: skip
    columns = zip(*rows[1:], strict=True)
    return Table({
        name.strip(): np.array([
            _number(f"{path.name}: {name.strip()}", value, _unit(module, name.strip()))
            for value in column
        ])
        for name, column in zip(rows[0], columns, strict=True)
    })  # fmt: skip


def _map(key: str, module: ModuleType, one: object) -> Map:
    given = _table(key, one, None)
    kind = given.get("kind")
    if kind not in KINDS:
        hint = near(str(kind)[:50], tuple(KINDS))
        raise SweepError(
            f"{key}.kind = {shown(kind)} must be one of {', '.join(map(repr, KINDS))}{hint}"
        )
    _keys(key, given, ("kind", *KINDS[kind]))
    if kind == "lyapunov":
        return Lyapunov()
    if kind == "energy error":
        return EnergyError()
    if kind == "first":
        watched = _table(f"{key}.of", given.get("of"), module.STATE)
        values = {
            name: tuple(_number(f"{key}.of.{name}", v, module.UNITS[name]) for v in _list(value))
            for name, value in watched.items()
        }
        places = [
            _table(f"{key}.barrier", place, module.COORDINATES)
            for place in _list(given.get("barrier", []))
        ]
        return First(values, tuple(
            {q: _number(f"{key}.barrier.{q}", v, module.UNITS[q]) for q, v in place.items()}
            for place in places
        ))  # fmt: skip
    of = tuple(_text(f"{key}.of", name) for name in _list(given.get("of", [])))
    for name in of or ("",):
        if name not in module.STATE:
            raise SweepError(
                f"{key}.of names {name[:50]!r}{near(name, module.STATE)}: known are "
                f"{', '.join(module.STATE)}"
            )
    if kind in ("final", "extremes"):
        return Final(of) if kind == "final" else Extremes(of)
    count = _whole(f"{key}.count", given.get("count"), 1)
    if kind == "samples":
        return Samples(of, count)
    where = _text(f"{key}.where", given.get("where", ""))
    direction = given.get("direction", "both")
    if where not in module.STATE or direction not in DIRECTIONS:
        raise SweepError(
            f"{key}: where = {where[:50]!r} must be one of {', '.join(module.STATE)}, and "
            f"direction = {shown(direction)} one of {', '.join(DIRECTIONS)}"
        )
    value = _number(f"{key}.value", given.get("value", 0.0), module.UNITS[where])
    return Section(of, count, where, value, DIRECTIONS[direction])


def _unit(module: ModuleType, name: str) -> str:
    if name == ENERGY:
        return "J"
    if name not in (*module.STATE, *module.PARAMETERS):
        known = (*module.STATE, *module.PARAMETERS, ENERGY)
        raise SweepError(f"{name[:50]!r}{near(name, known)} is not one of {', '.join(known)}")
    return str(module.UNITS[name])


def _keys(where: str, table: Mapping[str, Any], known: Sequence[str]) -> None:
    for key in table:
        if key not in known:
            raise SweepError(
                f"{where} has no key {key[:50]!r}{near(key, known)}; known are {', '.join(known)}"
            )


def _table(key: str, value: object, known: Sequence[str] | None) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise SweepError(f"{key} = {shown(value)} must be a table: write [{key}]")
    if known is not None:
        _keys(key, value, known)
    return value


def _list(value: object) -> list[Any]:
    return value if isinstance(value, list) else [value]


def _text(key: str, value: object) -> str:
    if not isinstance(value, str) or len(value) > 2000:
        raise SweepError(f"{key} = {shown(value)} must be a text in quotes")
    return value


def _whole(key: str, value: object, least: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise SweepError(f"{key} = {shown(value)} must be a whole number, {least} or more")
    return value


def _number(key: str, value: object, unit: str) -> float:
    try:
        return quantity(value, unit)
    except QuantityError as error:
        raise SweepError(f"{key}: {error}") from error
