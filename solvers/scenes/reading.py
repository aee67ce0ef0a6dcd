"""Scenes from TOML files: everything that makes no sense is refused when the file is read."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from math import pi
from pathlib import Path
from typing import Any

from solvers.equations.module import GeneratedModule
from solvers.io import toml_input
from solvers.io.suggestion import shortened
from solvers.io.toml_input import InputError
from solvers.scenes.checks import check_samples
from solvers.scenes.scene import Scene

#: How many pictures, outputs and runs there may be.
MOST = 24
ABSENT, TURN = "absent", 2 * pi

NEEDED = ("system", "duration", "initial")
NUMBERS = {"duration": "s", "accuracy": "1", "step": "s"}
LISTS = ("outputs", "pictures")
TEXTS = ("title", "label", "note", "model", "method", "form", "code")
#: How it is integrated.
WAY = {"model", "method", "form", "step"}
#: What can differ in what is shown beside a scene.
DIFFERS = ("label", "parameters", "initial", "model", "method", "form", "step", "code", "accuracy")
KEYS = (
    "system", "duration", "accuracy", "title", "note", "label", "outputs", "samples", "pictures",
    "model", "method", "form", "step", "code", "initial", "parameters", "beside",
)  # fmt: skip


def read(path: Path, module: Callable[[str], GeneratedModule]) -> Scene:
    """The scene in a file.

    Parameters
    ----------
    path : Path
        A TOML file.
    module : callable
        Gives a generated module by its name; raises `LookupError` for an unknown one.

    Returns
    -------
    Scene
        Named as the file is, without ``.toml``.

    Raises
    ------
    InputError
        When it makes no sense.
    OSError
        When the file cannot be read.
    """
    return toml_input.read(
        path, lambda table: scene(path.stem, table, lambda name: module(_from_here(path, name)))
    )


def _from_here(path: Path, name: str) -> str:
    """A system's name; that of a file is meant from the folder of the scene."""
    return str(path.parent / name) if name.endswith(".toml") else name


def scene(name: str, table: Mapping[str, Any], module: Callable[[str], GeneratedModule]) -> Scene:
    """The scene that a table says.

    Parameters
    ----------
    name : str
        What to call it.
    table : mapping
        A scene's file, parsed.
    module : callable
        Gives a generated module by its name; raises `LookupError` for an unknown one.

    Returns
    -------
    Scene
        With those that are to be shown beside it.

    Raises
    ------
    InputError
        When a key or its value makes no sense.
    ValueError
        When values make no sense together.
    """
    toml_input.check_keys("a scene", table, KEYS)
    missing = [key for key in NEEDED if key not in table]
    if missing:
        raise InputError(f"{missing[0]!r} is missing: a scene needs {', '.join(NEEDED)}")
    try:
        equations = module(toml_input.text("system", table["system"]))
    except LookupError as error:
        raise InputError(f"system = {table['system'][:50]!r}: {error.args[0]}") from error
    if "samples" in table:
        check_samples(table["samples"])
    others = table.get("beside", [])
    if not isinstance(others, list) or not all(isinstance(other, dict) for other in others):
        raise InputError("'beside' must be tables: write [[beside]] and what differs below it")
    if len(others) > MOST:
        raise InputError(f"[[beside]] are {len(others)}: up to {MOST} can be shown")
    for key in ("initial", "parameters"):
        toml_input.table(key, table.get(key, {}))
    beside = tuple(_beside(equations, name, table, other) for other in others)
    title = str(equations.__doc__).partition(":")[0].partition(".")[0]
    return _scene(equations, name, {"title": title, **table}, beside)


def _beside(
    module: GeneratedModule, name: str, table: Mapping[str, Any], other: Mapping[str, Any]
) -> Scene:
    toml_input.check_keys("[[beside]]", other, DIFFERS, KEYS)
    label = ", ".join(_difference(key, value) for key, value in other.items())
    # another way of integrating owes nothing to this one
    kept = {key: table[key] for key in table if key not in WAY or not WAY & set(other)}
    for key in ("initial", "parameters"):
        toml_input.table(key, other.get(key, {}))
        kept[key] = table.get(key, {}) | other.get(key, {})
    changed = {key: other[key] for key in other if key not in ("initial", "parameters")}
    return _scene(module, name, {**kept, "label": label, **changed}, ())


def _difference(key: str, value: object) -> str:
    """What differs, in words."""
    if isinstance(value, dict):
        return ", ".join(_difference(name, one) for name, one in value.items())
    words = shortened(value).strip("'")
    return words if key == "method" else f"{key} = {words}"


def _scene(
    module: GeneratedModule, name: str, table: Mapping[str, Any], beside: tuple[Scene, ...]
) -> Scene:
    given: dict[str, Any] = {key: toml_input.text(key, table[key]) for key in TEXTS if key in table}
    given |= {key: toml_input.texts(key, table[key], MOST) for key in LISTS if key in table}
    given |= {
        key: toml_input.number(key, table[key], unit)
        for key, unit in NUMBERS.items()
        if key in table
    }
    if given.get("outputs") == ():
        raise InputError("outputs = [] asks for nothing: leave it out to be given the state")
    return Scene(
        module,
        _parameters(module, table.get("parameters", {})),
        _initial(module, table["initial"]),
        samples=table.get("samples", 0),
        name=name,
        beside=beside,
        **given,
    )


def _parameters(module: GeneratedModule, table: object) -> tuple[float, ...]:
    values = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
    for key, value in _table("parameters", table, module.PARAMETERS).items():
        if value == ABSENT and key in module.POSITIVE:
            values[key] = 0.0
        elif key in module.POSITIVE:
            way = f'; if it is not there write {key} = "{ABSENT}"' if value == 0 else ""
            values[key] = toml_input.positive(f"parameters.{key}", value, module.UNITS[key], way)
        else:
            values[key] = toml_input.number(f"parameters.{key}", value, module.UNITS[key])
    return tuple(values.values())


def _initial(module: GeneratedModule, table: object) -> tuple[float, ...]:
    given = _table("initial", table, module.STATE)
    missing = [q for q in module.COORDINATES if q not in given]
    if missing:
        raise InputError(f"initial.{missing[0]} is missing: give {', '.join(module.COORDINATES)}; "
                         "velocities that are left out are 0")  # fmt: skip
    for name, value in given.items():
        if module.UNITS[name] == "rad" and isinstance(value, int | float) and abs(value) > TURN:
            warnings.warn(
                f'initial.{name} = {value} is {value / TURN:.3g} turns: write "{value} deg" if '
                "degrees are meant",
                stacklevel=2,
            )
    return tuple(toml_input.number(f"initial.{name}", given.get(name, 0.0), module.UNITS[name])
                 for name in module.STATE)  # fmt: skip


def _table(key: str, value: object, known: Sequence[str]) -> dict[str, Any]:
    found = toml_input.table(key, value)
    toml_input.check_keys(f"[{key}]", found, known, KEYS)
    return found
