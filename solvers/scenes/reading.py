"""Scenes from TOML files: everything that makes no sense is refused when the file is read."""

from __future__ import annotations

import tomllib
import warnings
from collections.abc import Callable, Mapping, Sequence
from math import pi
from pathlib import Path
from types import ModuleType
from typing import Any

from solvers.scenes.checks import check_samples, near
from solvers.scenes.quantity import QuantityError, quantity, shown
from solvers.scenes.scene import Scene

#: Bytes of the largest file; the longest that ships has 2000.
LARGEST = 100_000
#: Characters of a text, and how many pictures, outputs and runs there may be.
LONGEST, MOST = 2000, 24
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
        return scene(path.stem, table, lambda name: module(_from_here(path, name)))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise SceneError(
            f"{path} is no TOML file: {error}; a number with a unit stands in quotes, and a "
            "decimal point is a point"
        ) from error
    except ValueError as error:
        raise SceneError(f"{path}: {error}") from error


def _from_here(path: Path, name: str) -> str:
    """A system's name; that of a file is meant from the folder of the scene."""
    return str(path.parent / name) if name.endswith(".toml") else name


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
    if "samples" in table:
        check_samples(table["samples"])
    others = table.get("beside", [])
    if not isinstance(others, list) or not all(isinstance(other, dict) for other in others):
        raise SceneError("'beside' must be tables: write [[beside]] and what differs below it")
    if len(others) > MOST:
        raise SceneError(f"[[beside]] are {len(others)}: up to {MOST} can be shown")
    for key in ("initial", "parameters"):
        _is_table(key, table.get(key, {}))
    beside = tuple(_beside(equations, name, table, other) for other in others)
    title = str(equations.__doc__).partition(":")[0].partition(".")[0]
    return _scene(equations, name, {"title": title, **table}, beside)


def _beside(
    module: ModuleType, name: str, table: Mapping[str, Any], other: Mapping[str, Any]
) -> Scene:
    _keys("[[beside]]", other, DIFFERS)
    label = ", ".join(_difference(key, value) for key, value in other.items())
    # another way of integrating owes nothing to this one
    kept = {key: table[key] for key in table if key not in WAY or not WAY & set(other)}
    for key in ("initial", "parameters"):
        _is_table(key, other.get(key, {}))
        kept[key] = table.get(key, {}) | other.get(key, {})
    changed = {key: other[key] for key in other if key not in ("initial", "parameters")}
    return _scene(module, name, {**kept, "label": label, **changed}, ())


def _difference(key: str, value: object) -> str:
    """What differs, in words."""
    if isinstance(value, dict):
        return ", ".join(_difference(name, one) for name, one in value.items())
    words = shown(value).strip("'")
    return words if key == "method" else f"{key} = {words}"


def _scene(
    module: ModuleType, name: str, table: Mapping[str, Any], beside: tuple[Scene, ...]
) -> Scene:
    given: dict[str, Any] = {key: _text(key, table[key]) for key in TEXTS if key in table}
    given |= {key: _texts(key, table[key]) for key in LISTS if key in table}
    given |= {key: _number(key, table[key], unit) for key, unit in NUMBERS.items() if key in table}
    if given.get("outputs") == ():
        raise SceneError("outputs = [] asks for nothing: leave it out to be given the state")
    return Scene(
        module,
        _parameters(module, table.get("parameters", {})),
        _initial(module, table["initial"]),
        samples=table.get("samples", 0),
        name=name,
        beside=beside,
        **given,
    )


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
    for name, value in given.items():
        if module.UNITS[name] == "rad" and isinstance(value, int | float) and abs(value) > TURN:
            warnings.warn(
                f'initial.{name} = {value} is {value / TURN:.3g} turns: write "{value} deg" if '
                "degrees are meant",
                stacklevel=2,
            )
    return tuple(_number(f"initial.{name}", given.get(name, 0.0), module.UNITS[name])
                 for name in module.STATE)  # fmt: skip


def _keys(where: str, table: Mapping[str, Any], known: Sequence[str]) -> None:
    for key in table:
        if key not in known:
            misplaced = key in KEYS and where.startswith("[")
            hint = f": {key!r} belongs above the first [table]" if misplaced else near(key, known)
            raise SceneError(f"{where} has no key {key[:50]!r}{hint}; known are {', '.join(known)}")


def _table(key: str, value: object, known: Sequence[str]) -> dict[str, Any]:
    _is_table(key, value)
    assert isinstance(value, dict)
    _keys(f"[{key}]", value, known)
    return value


def _is_table(key: str, value: object) -> None:
    if not isinstance(value, dict):
        raise SceneError(f"{key} = {shown(value)} must be a table: write [{key}]")


def _text(key: str, value: object) -> str:
    if not isinstance(value, str):
        raise SceneError(f"{key} = {shown(value)} must be text in quotes")
    if len(value) > LONGEST or not all(c.isprintable() or c in "\n\t" for c in value):
        raise SceneError(f"{key} = {shown(value)} must be up to {LONGEST} printable characters")
    return value


def _texts(key: str, value: object) -> tuple[str, ...]:
    if not isinstance(value, list):
        raise SceneError(f"{key} = {shown(value)} must be a list of texts in square brackets")
    if len(value) > MOST:
        raise SceneError(f"{key} are {len(value)}: up to {MOST} can be shown")
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
