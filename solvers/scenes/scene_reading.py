"""Scenes from TOML files; what is not valid is refused when the file is read."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from itertools import product
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from solvers.equations.consistent_start import default_coordinates
from solvers.equations.module import GeneratedModule, has_constraints, title
from solvers.equations.number_checks import check_outputs
from solvers.io import toml_input
from solvers.io.suggestion import shortened
from solvers.io.toml_input import InputError
from solvers.scenes.scene import MOST_SAMPLES, Scene

FILES = Path(__file__).parent / "files"
#: Most pictures, outputs and runs.
MOST = 24
ABSENT, TURN = "absent", 2 * pi

REQUIRED = ("system", "duration", "initial")
NUMBERS = {"duration": "s", "accuracy": "1", "step": "s"}
LISTS = ("outputs", "pictures")
TEXTS = ("title", "label", "note", "model", "method", "form", "code")
TABLES = ("initial", "parameters")
INTEGRATION = {"model", "method", "form", "step"}
#: Keys of a table [[beside]].
BESIDE = ("label", *TABLES, "model", "method", "form", "step", "code", "accuracy")
KEYS = (*REQUIRED, "accuracy", "step", *LISTS, *TEXTS, "samples", "parameters", "beside")


def names() -> tuple[str, ...]:
    """Names of all scenes that ship, in alphabetical order."""
    return toml_input.names(FILES)


def find(name: str, load: Callable[[str], GeneratedModule]) -> Scene:
    """The scene of a name, or in a TOML file; `InputError` where it is not valid.

    `load` returns the generated module of a name, or raises `LookupError`.
    """
    return read(toml_input.path("scene", name, FILES), load)


def read(path: Path, load: Callable[[str], GeneratedModule]) -> Scene:
    """The scene in a TOML file; `InputError` where the file or a value is not valid."""

    def load_beside(name: str) -> GeneratedModule:
        # the path of a system file is relative to the folder of the scene
        return load(str(path.parent / name) if name.endswith(".toml") else name)

    return toml_input.read(path, lambda table: scene(path.stem, table, load_beside))


def scene(name: str, table: Mapping[str, Any], load: Callable[[str], GeneratedModule]) -> Scene:
    """The scene of a parsed file; `InputError` or `ValueError` where it is not valid."""
    toml_input.check_keys("a scene", table, KEYS)
    if missing := [key for key in REQUIRED if key not in table]:
        raise InputError(f"{missing[0]!r} is missing: a scene needs {', '.join(REQUIRED)}")
    try:
        module = load(toml_input.text("system", table["system"]))
    except LookupError as error:
        raise InputError(f"system = {table['system'][:50]!r}: {error.args[0]}") from error
    if not isinstance(table.get("samples", []), list):
        toml_input.whole("samples", table["samples"], 2, MOST_SAMPLES)
    others = table.get("beside", [])
    if not isinstance(others, list) or not all(isinstance(other, dict) for other in others):
        raise InputError("'beside' must be tables: write [[beside]] and the differences below it")
    if len(others) > MOST:
        raise InputError(f"[[beside]] are {len(others)}: up to {MOST} can be shown")
    for key, each in product(TABLES, (table, *others)):
        toml_input.table(key, each.get(key, {}))
    table = {"title": title(module), **table}
    beside = tuple(_beside(module, name, table, other) for other in others)
    return _scene(module, name, table, beside)


def _beside(
    module: GeneratedModule, name: str, table: Mapping[str, Any], other: Mapping[str, Any]
) -> Scene:
    toml_input.check_keys("[[beside]]", other, BESIDE, KEYS)
    label = ", ".join(_difference(key, value) for key, value in other.items())
    # a model or method replaces all settings of the integration
    replaced = INTEGRATION if INTEGRATION & set(other) else set()
    settings = {key: table[key] for key in table if key not in replaced}
    merged = {key: table.get(key, {}) | other.get(key, {}) for key in TABLES}
    return _scene(module, name, {**settings, "label": label, **other, **merged}, ())


def _difference(key: str, value: object) -> str:
    """A changed value as text, for the label."""
    if isinstance(value, dict):
        return ", ".join(_difference(name, one) for name, one in value.items())
    text = shortened(value).strip("'")
    return text if key == "method" else f"{key} = {text}"


def _scene(
    module: GeneratedModule, name: str, table: Mapping[str, Any], beside: tuple[Scene, ...]
) -> Scene:
    values: dict[str, Any] = {k: toml_input.text(k, table[k]) for k in TEXTS if k in table}
    values |= {k: toml_input.texts(k, table[k], MOST) for k in LISTS if k in table}
    values |= {k: toml_input.number(k, table[k], NUMBERS[k]) for k in NUMBERS if k in table}
    if values.get("outputs") == ():
        raise InputError("outputs = [] requests nothing: leave it out to request the state")
    params = _parameters(module, table.get("parameters", {}))
    y0, guess = _initial(module, table["initial"], params)
    samples = table.get("samples", 0)
    if isinstance(samples, list):
        samples = [toml_input.number(f"samples[{k}]", t, "s") for k, t in enumerate(samples)]
    values |= {"y0": y0, "guess": guess, "samples": samples}
    return Scene(module, params, name=name, beside=beside, **values)


def _parameters(module: GeneratedModule, table: object) -> tuple[float, ...]:
    values = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
    for key, value in _table("parameters", table, module.PARAMETERS).items():
        name, unit = f"parameters.{key}", module.UNITS[key]
        if value == ABSENT and key in module.POSITIVE:
            values[key] = 0.0
        elif key in module.POSITIVE:
            remedy = f'; if it does not exist write {key} = "{ABSENT}"' if value == 0 else ""
            values[key] = toml_input.positive(name, value, unit, remedy)
        else:
            values[key] = toml_input.number(name, value, unit)
    return tuple(values.values())


def _initial(
    module: GeneratedModule, table: object, params: Sequence[float]
) -> tuple[dict[str, float], dict[str, float]]:
    """Components of the initial state, and guesses of those that constraints determine."""
    check_outputs(module, "[initial]", toml_input.table("initial", table))
    given, units = _table("initial", table, module.STATE), module.UNITS
    is_constrained, guesses = has_constraints(module), dict[str, Any]()
    for name, value in list(given.items()):
        if is_constrained and isinstance(value, dict):
            toml_input.check_keys(f"initial.{name}", value, ("guess",))
            guesses |= {name: value.get("guess", 0.0)}
            del given[name]
    if not is_constrained:
        known = {*given, *default_coordinates(module, given, np.array(params))}
        if missing := [q for q in module.COORDINATES if q not in known]:
            remedy = f"give {', '.join(module.COORDINATES)}; velocities that are left out are 0"
            raise InputError(f"initial.{missing[0]} is missing: {remedy}")
    for name, value in (given | guesses).items():
        if units[name] == "rad" and isinstance(value, int | float) and abs(value) > TURN:
            text = f"initial.{name} = {value} is {value / TURN:.3g} turns"
            warnings.warn(f'{text}: write "{value} deg" if degrees are meant', stacklevel=2)
    numbers = {q: toml_input.number(f"initial.{q}", x, units[q]) for q, x in given.items()}
    near = {q: toml_input.number(f"initial.{q}.guess", x, units[q]) for q, x in guesses.items()}
    return numbers, near


def _table(key: str, value: object, known: Sequence[str]) -> dict[str, Any]:
    table = toml_input.table(key, value)
    toml_input.check_keys(f"[{key}]", table, known, KEYS)
    return table
