"""Sweeps from TOML files; every mistake is reported when the file is read."""

import csv
from collections.abc import Callable, Mapping
from functools import partial
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from solvers.equations.module import GeneratedModule, title
from solvers.io import toml_input
from solvers.io.suggestion import did_you_mean
from solvers.io.toml_input import InputError
from solvers.sweeps.definition import map_kinds
from solvers.sweeps.definition.axes import Axes, Grid, Random, Table
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.definition.sweep_checks import ENERGY, FROM_ENERGY, unit

FILES = Path(__file__).parents[1] / "files"
REQUIRED = ("system", "axes", "maps")
#: Largest number of values along an axis, and of motions or steps.
MAX_VALUES, MAX_COUNT = 10**7, 10**11
#: Optional keys of a file that are arguments of `Sweep`, and how they are read.
OPTIONS: dict[str, Callable[[str, object], Any]] = {
    "title": toml_input.text,
    "method": toml_input.text,
    "rtol": partial(toml_input.number, unit="1"),
    "atol": partial(toml_input.number, unit="1"),
    "duration": partial(toml_input.number, unit="s"),
    "skip": partial(toml_input.number, unit="s"),
    "max_steps": partial(toml_input.whole, least=1, most=MAX_COUNT),
}
KEYS = (*REQUIRED, *OPTIONS, "initial", "parameters", "random")


def names() -> tuple[str, ...]:
    """Names of all sweeps that ship, in alphabetical order."""
    return toml_input.names(FILES)


def find(name: str, module: Callable[[str], GeneratedModule]) -> Sweep:
    """The sweep of this name, or in this file, as `solvers.load_sweep` gives it.

    `module` loads a generated module by its name; it raises `LookupError` for an unknown one.
    """
    path = toml_input.path("sweep", name, FILES)
    return toml_input.read(path, lambda table: _sweep(path, table, module))


def _sweep(path: Path, table: Mapping[str, Any], module: Callable[[str], GeneratedModule]) -> Sweep:
    toml_input.check_keys("a sweep", table, KEYS)
    if missing := [key for key in REQUIRED if key not in table]:
        raise InputError(f"{missing[0]!r} is missing: a sweep needs {', '.join(REQUIRED)}")
    name = toml_input.text("system", table["system"])
    try:
        equations = module(str(path.parent / name) if name.endswith(".toml") else name)
    except LookupError as error:
        raise InputError(f"system = {name[:50]!r}: {error.args[0]}") from error
    options: dict[str, Any] = {"title": title(equations)}
    options |= {key: read(key, table[key]) for key, read in OPTIONS.items() if key in table}
    maps = {
        key: map_kinds.read(f"maps.{key}", equations, toml_input.table(f"maps.{key}", one))
        for key, one in toml_input.table("maps", table["maps"]).items()
    }
    axes, values = _axes(path, equations, table), _values(equations, table)
    return Sweep(equations, axes, maps, values=values, name=path.stem, **options)


def _values(module: GeneratedModule, table: Mapping[str, Any]) -> dict[str, float | str]:
    """Quantities that do not vary."""
    values: dict[str, float | str] = {}
    known = {"initial": (*module.STATE, ENERGY), "parameters": module.PARAMETERS}
    for part, names in known.items():
        given = toml_input.table(part, table.get(part, {}))
        toml_input.check_keys(f"[{part}]", given, names, KEYS)
        for key, value in given.items():
            is_free = value == FROM_ENERGY and key in module.STATE
            own = unit(module, key)
            values[key] = value if is_free else toml_input.number(f"{part}.{key}", value, own)
    return values


def _axes(path: Path, module: GeneratedModule, table: Mapping[str, Any]) -> Axes:
    if isinstance(table["axes"], str):
        if "random" in table:
            raise InputError("axes are a table, and random is given: remove one of them")
        return _from_file(path.parent / table["axes"], module)
    axes = toml_input.table("axes", table["axes"])
    toml_input.check_keys("[axes]", axes, (*module.STATE, *module.PARAMETERS, ENERGY), KEYS)
    keys = ("from", "to") if "random" in table else ("from", "to", "count")
    limits = {name: _limits(module, name, one, keys) for name, one in axes.items()}
    if "random" in table:
        random = toml_input.table("random", table["random"])
        toml_input.check_keys("random", random, ("count", "seed"))
        count = toml_input.whole("random.count", random.get("count"), 1, MAX_COUNT)
        seed = toml_input.whole("random.seed", random.get("seed", 0), 0, 2**63)
        return Random(limits, count, seed)
    counts = {}
    for name, one in axes.items():
        counts[name] = toml_input.whole(f"axes.{name}.count", one["count"], 1, MAX_VALUES)
    if (motions := prod(counts.values())) > MAX_COUNT:
        raise InputError(f"[axes] have {motions:,} motions: up to {MAX_COUNT:,} are possible")
    return Grid({name: np.linspace(*limits[name], counts[name]) for name in axes})


def _limits(
    module: GeneratedModule, name: str, value: object, keys: tuple[str, ...]
) -> tuple[float, float]:
    """Both ends of an axis, whose table must have these keys."""
    path = f"axes.{name}"
    given = toml_input.table(path, value)
    toml_input.check_keys(path, given, keys)
    for key in keys:
        if key not in given:
            raise InputError(f"{path}.{key} is missing: give {', '.join(keys)}")
    own = unit(module, name)
    low, high = (toml_input.number(f"{path}.{end}", given[end], own) for end in ("from", "to"))
    return low, high


def _from_file(path: Path, module: GeneratedModule) -> Table:
    """A table with names in its first line, and quantities below."""
    if path.suffix != ".csv":
        raise InputError(
            f"axes = {path.name!r} must be a file that ends in .csv, or a table [axes]"
        )
    if path.exists() and not path.is_file():
        raise InputError(f"axes = {path.name!r} is no file")
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:  # as spreadsheets write it
            rows = [row for row in csv.reader(file) if row]
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path.name} is no table in UTF-8: {error}") from error
    if len(rows) < 2 or any(len(row) != len(rows[0]) for row in rows):
        raise InputError(
            f"{path.name} must have names in its first line, and as many numbers in each of the "
            "others"
        )
    names = [name.strip() for name in rows[0]]
    if len({*names}) < len(names):
        raise InputError(f"{path.name} has a duplicate name: {', '.join(names)}")
    columns, known = {}, (*module.STATE, *module.PARAMETERS, ENERGY)
    for name, *texts in zip(names, *rows[1:], strict=True):
        if name not in known:
            hint = did_you_mean(name, known)
            raise InputError(f"{name[:50]!r}{hint} is not one of {', '.join(known)}")
        key, own = f"{path.name}: {name}", unit(module, name)
        columns[name] = np.array([toml_input.number(key, text, own) for text in texts])
    return Table(columns)
