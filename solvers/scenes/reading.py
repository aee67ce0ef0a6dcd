"""Scenes from TOML files: everything that makes no sense is refused when the file is read."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path
from types import ModuleType
from typing import Any

from solvers.scenes.checks import check_masses, check_method, check_pictures
from solvers.scenes.quantity import QuantityError, quantity
from solvers.scenes.scene import ENERGY, Scene

#: Bytes of the largest file; the longest that ships has 2000.
LARGEST = 100_000
#: Seconds of the longest motion, samples that fit into memory, and the finest accuracy.
MOST_SAMPLES, FINEST = 1_000_001, 1e-13
ABSENT = "absent"

NEEDED = ("system", "duration", "initial")
#: What can differ in what is shown beside a scene.
DIFFERS = ("label", "parameters", "initial", "model", "method", "form", "step", "code", "accuracy")
KEYS = (*NEEDED, *DIFFERS, "title", "note", "outputs", "samples", "pictures", "beside")


class SceneError(ValueError):
    """A scene that makes no sense; the message says which key, its value and what is allowed."""


def read(path: Path, module: Callable[[str], ModuleType]) -> Scene:
    """The scene in a file.

    Parameters
    ----------
    path : Path
        A TOML file.
    module : callable
        Gives a generated module by its name; raises `LookupError` for an unknown one.

    Raises
    ------
    SceneError
        When it makes no sense.
    OSError
        When the file cannot be read.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise SceneError(f"it has more than {LARGEST} bytes")
        table = tomllib.loads(path.read_bytes().decode())
        return scene(path.stem, table, module)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise SceneError(f"{path} is no TOML file: {error}") from error
    except ValueError as error:
        raise SceneError(f"{path}: {error}") from error


def scene(name: str, table: Mapping[str, Any], module: Callable[[str], ModuleType]) -> Scene:
    """The scene that a table says.

    Raises
    ------
    ValueError
        When it makes no sense.
    """
    _keys("a scene", table, KEYS)
    missing = [key for key in NEEDED if key not in table]
    if missing:
        raise SceneError(f"{missing[0]!r} is missing: a scene needs {', '.join(NEEDED)}")
    try:
        equations = module(_text("system", table["system"]))
    except LookupError as error:
        raise SceneError(f"system = {table['system'][:50]!r}: {error.args[0]}") from error
    found = Scene(
        name,
        _text("title", table.get("title", name)),
        _text("label", table.get("label", table.get("title", name))),
        equations,
        tuple(equations.DEFAULTS),
        (),
        _positive("duration", table["duration"], "s"),
        note=_text("note", table.get("note", "")),
        samples=_count(table["samples"]) if "samples" in table else 0,
    )
    found = _changed(found, table)
    pictures = check_pictures(_texts("pictures", table.get("pictures", [])), found)
    found = replace(found, outputs=_outputs(table.get("outputs"), found), pictures=pictures)
    others = table.get("beside", [])
    if not isinstance(others, list) or not all(isinstance(other, dict) for other in others):
        raise SceneError("'beside' must be tables: write [[beside]] and what differs below it")
    return replace(found, beside=tuple(_beside(found, table, other) for other in others))


def _beside(main: Scene, table: Mapping[str, Any], other: Mapping[str, Any]) -> Scene:
    _keys("[[beside]]", other, DIFFERS)
    if "label" not in other:
        raise SceneError("[[beside]] needs a 'label' that says what differs")
    initial = table["initial"] | other.get("initial", {})
    parameters = table.get("parameters", {}) | other.get("parameters", {})
    how = {key: table[key] for key in ("model", "method", "form", "step", "code") if key in table}
    if {"model", "method", "form", "step"} & set(other):
        how = {}  # another way of integrating owes nothing to this one
    return _changed(replace(main, label=_text("label", other["label"])),
                    {**how, **other, "initial": initial, "parameters": parameters,
                     "accuracy": other.get("accuracy", main.accuracy)})  # fmt: skip


def _changed(scene: Scene, table: Mapping[str, Any]) -> Scene:
    """What can be another in every run."""
    module = scene.module
    params = _parameters(module, table.get("parameters", {}))
    step = table.get("step")
    accuracy = _positive("accuracy", table.get("accuracy", Scene.accuracy), "1")
    if accuracy < FINEST:
        raise SceneError(f"accuracy = {accuracy} is below {FINEST}, the resolution of numbers")
    changed = replace(
        scene,
        params=params,
        y0=_initial(module, table["initial"]),
        accuracy=accuracy,
        model=_choice("model", table.get("model"), ("full",)),
        method=table.get("method"),
        form=table.get("form"),
        step=None if step is None else _positive("step", step, "s"),
        code=_choice("code", table.get("code"), ("general", "specialised")),
    )
    check_masses(changed)
    check_method(changed)
    return changed


def _parameters(module: ModuleType, table: object) -> tuple[float, ...]:
    values = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
    for key, value in _table("parameters", table, module.PARAMETERS).items():
        if value == ABSENT and key in module.POSITIVE:
            values[key] = 0.0
        elif key in module.POSITIVE:
            way = f'; if it is not there write {key} = "{ABSENT}"' if value == 0 else ""
            values[key] = _positive(f"parameters.{key}", value, module.UNITS[key], way)
        else:
            values[key] = _number(f"parameters.{key}", value, module.UNITS[key])
    return tuple(values.values())


def _initial(module: ModuleType, table: object) -> tuple[float, ...]:
    given = _table("initial", table, module.STATE)
    missing = [q for q in module.COORDINATES if q not in given]
    if missing:
        raise SceneError(f"initial.{missing[0]} is missing: give {', '.join(module.COORDINATES)}; "
                         "velocities that are left out are 0")  # fmt: skip
    return tuple(_number(f"initial.{name}", given.get(name, 0.0), module.UNITS[name])
                 for name in module.STATE)  # fmt: skip


def _outputs(value: object, scene: Scene) -> tuple[str, ...]:
    known = (*scene.module.STATE, ENERGY)
    if value is None:
        return scene.module.STATE
    outputs = _texts("outputs", value)
    for name in outputs:
        if name not in known:
            raise SceneError(f"outputs name {name[:50]!r}{_near(name, known)}: known are "
                             f"{', '.join(known)}")  # fmt: skip
    if not set(outputs) & set(scene.module.STATE):
        raise SceneError(f"outputs = {list(outputs)} names no part of the state: add one of "
                         f"{', '.join(scene.module.STATE)}")  # fmt: skip
    return outputs


def _keys(where: str, table: Mapping[str, Any], known: Sequence[str]) -> None:
    for key in table:
        if key not in known:
            raise SceneError(f"{where} has no key {key[:50]!r}{_near(key, known)}: known are "
                             f"{', '.join(known)}")  # fmt: skip


def _near(name: str, known: Sequence[str]) -> str:
    near = get_close_matches(name, known, n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""


def _table(key: str, value: object, known: Sequence[str]) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise SceneError(f"{key} = {str(value)[:50]!r} must be a table: write [{key}]")
    _keys(f"[{key}]", value, known)
    return value


def _text(key: str, value: object) -> str:
    if not isinstance(value, str):
        raise SceneError(f"{key} = {str(value)[:50]} must be text in quotes")
    return value


def _texts(key: str, value: object) -> tuple[str, ...]:
    if not isinstance(value, list):
        raise SceneError(f"{key} = {str(value)[:50]!r} must be a list of texts in square brackets")
    return tuple(_text(key, item) for item in value)


def _number(key: str, value: object, unit: str) -> float:
    try:
        return quantity(value, unit)
    except QuantityError as error:
        raise SceneError(f"{key}: {error}") from error


def _positive(key: str, value: object, unit: str, way: str = "") -> float:
    number = _number(key, value, unit)
    if number <= 0:
        raise SceneError(f"{key} = {value} must be positive, in {unit}{way}")
    return number


def _count(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 2 <= value <= MOST_SAMPLES:
        raise SceneError(f"samples = {str(value)[:50]} must be a whole number from 2 to "
                         f"{MOST_SAMPLES}")  # fmt: skip
    return value


def _choice(key: str, value: object, allowed: Sequence[str]) -> str | None:
    if value is not None and value not in allowed:
        raise SceneError(f"{key} = {str(value)[:50]!r} must be {' or '.join(map(repr, allowed))}, "
                         "or be left out")  # fmt: skip
    return None if value is None else str(value)
