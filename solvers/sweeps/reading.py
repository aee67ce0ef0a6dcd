"""Sweeps from TOML files: everything that makes no sense is refused when the file is read."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.io import toml_input
from solvers.io.suggestion import did_you_mean
from solvers.io.toml_input import InputError
from solvers.sweeps.axes import Axes, Grid, Random, Table
from solvers.sweeps.checks import ENERGY, FROM_ENERGY
from solvers.sweeps.reading_maps import kept
from solvers.sweeps.sweep import Sweep

FILES = Path(__file__).parent / "files"
NEEDED = ("system", "duration", "axes", "maps")
KEYS = (
    *NEEDED, "title", "method", "rtol", "atol", "max_steps", "initial", "parameters", "random",
)  # fmt: skip
#: Values along an axis; motions and steps: no more than so many.
LONGEST, MOST = 10**7, 10**11


def names() -> tuple[str, ...]:
    """Names of all sweeps that ship, in alphabetical order."""
    return toml_input.names(FILES)


def find(name: str, module: Callable[[str], GeneratedModule]) -> Sweep:
    """The sweep of this name, or in this file.

    Parameters
    ----------
    name : str
        Of a sweep that ships, or the path of a file that ends in ``.toml``.
    module : callable
        Gives a generated module by its name; raises `LookupError` for an unknown one.

    Returns
    -------
    Sweep
        Named as the file is, without ``.toml``.

    Raises
    ------
    solvers.io.toml_input.InputError
        When there is none, or it makes no sense.
    OSError
        When the file, or the table that it names, cannot be read.
    """
    path = toml_input.path("sweep", name, FILES)
    return toml_input.read(path, lambda table: _sweep(path, table, module))


def _sweep(path: Path, table: Mapping[str, Any], module: Callable[[str], GeneratedModule]) -> Sweep:
    toml_input.check_keys("a sweep", table, KEYS)
    missing = [key for key in NEEDED if key not in table]
    if missing:
        raise InputError(f"{missing[0]!r} is missing: a sweep needs {', '.join(NEEDED)}")
    name = toml_input.text("system", table["system"])
    try:
        equations = module(str(path.parent / name) if name.endswith(".toml") else name)
    except LookupError as error:
        raise InputError(f"system = {name[:50]!r}: {error.args[0]}") from error
    way: dict[str, Any] = {
        key: toml_input.number(key, table[key], "1") for key in ("rtol", "atol") if key in table
    }
    if "method" in table:
        way["method"] = toml_input.text("method", table["method"])
    if "max_steps" in table:
        way["max_steps"] = toml_input.whole("max_steps", table["max_steps"], 1, MOST)
    title = str(equations.__doc__).partition(":")[0].partition(".")[0]
    return Sweep(
        equations,
        _axes(path, equations, table),
        {
            key: kept(f"maps.{key}", equations, toml_input.table(f"maps.{key}", one))
            for key, one in toml_input.table("maps", table["maps"]).items()
        },
        toml_input.number("duration", table["duration"], "s"),
        _values(equations, table),
        name=path.stem,
        title=toml_input.text("title", table.get("title", title)),
        **way,
    )


def _values(module: GeneratedModule, table: Mapping[str, Any]) -> dict[str, float | str]:
    """What does not vary."""
    values: dict[str, float | str] = {}
    known = {"initial": (*module.STATE, ENERGY), "parameters": module.PARAMETERS}
    for part, names in known.items():
        given = toml_input.table(part, table.get(part, {}))
        toml_input.check_keys(f"[{part}]", given, names, KEYS)
        for key, value in given.items():
            is_free = value == FROM_ENERGY and key in module.STATE
            values[key] = (
                FROM_ENERGY
                if is_free
                else toml_input.number(f"{part}.{key}", value, unit(module, key))
            )
    return values


def _axes(path: Path, module: GeneratedModule, table: Mapping[str, Any]) -> Axes:
    if isinstance(table["axes"], str):
        if "random" in table:
            raise InputError("axes are a table, and random is given: leave one of them out")
        return _from_file(path.parent / table["axes"], module)
    axes = toml_input.table("axes", table["axes"])
    toml_input.check_keys("[axes]", axes, (*module.STATE, *module.PARAMETERS, ENERGY), KEYS)
    is_grid = "random" not in table
    ends, counts = {}, {}
    for name, value in axes.items():
        key, given = f"axes.{name}", toml_input.table(f"axes.{name}", value)
        needed = ("from", "to", "count") if is_grid else ("from", "to")
        toml_input.check_keys(key, given, needed)
        missing = [part for part in needed if part not in given]
        if missing:
            raise InputError(f"{key}.{missing[0]} is missing: give {', '.join(needed)}")
        low, high = (
            toml_input.number(f"{key}.{end}", given[end], unit(module, name))
            for end in ("from", "to")
        )
        ends[name] = low, high
        counts[name] = (
            toml_input.whole(f"{key}.count", given["count"], 1, LONGEST) if is_grid else 0
        )
    if is_grid and prod(counts.values()) > MOST:
        raise InputError(f"[axes] have {prod(counts.values()):,} motions: up to {MOST:,} are "
                         "possible")  # fmt: skip
    if is_grid:
        return Grid({name: np.linspace(*ends[name], counts[name]) for name in axes})
    drawn = toml_input.table("random", table["random"])
    toml_input.check_keys("random", drawn, ("count", "seed"))
    count = toml_input.whole("random.count", drawn.get("count"), 1, MOST)
    return Random(ends, count, toml_input.whole("random.seed", drawn.get("seed", 0), 0, 2**63))


def _from_file(path: Path, module: GeneratedModule) -> Table:
    """A table with names in its first line, and numbers in their units below."""
    if path.suffix != ".csv":
        raise InputError(f"axes = {path.name!r} must be a table that ends in .csv, or be written "
                         "as [axes]")  # fmt: skip
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:  # as spreadsheets write it
            rows = [row for row in csv.reader(file) if row]
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path.name} is no table in UTF-8: {error}") from error
    if len(rows) < 2 or any(len(row) != len(rows[0]) for row in rows):
        raise InputError(f"{path.name} must have names in its first line, and as many numbers in "
                         "each of the others")  # fmt: skip
    names = [name.strip() for name in rows[0]]
    if len({*names}) < len(names):
        raise InputError(f"{path.name} has a name twice: {', '.join(names)}")
    columns = zip(*rows[1:], strict=True)
    return Table({
        name: np.array([
            toml_input.number(f"{path.name}: {name}", value, unit(module, name)) for value in column
        ])
        for name, column in zip(names, columns, strict=True)
    })  # fmt: skip


def unit(module: GeneratedModule, name: str) -> str:
    """The unit of what may vary or be given."""
    if name == ENERGY:
        return "J"
    known = (*module.STATE, *module.PARAMETERS)
    if name not in known:
        raise InputError(
            f"{name[:50]!r}{did_you_mean(name, known)} is not one of {', '.join((*known, ENERGY))}"
        )
    return str(module.UNITS[name])
