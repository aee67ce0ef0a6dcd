"""The map kinds that exist; each is a file in the package `maps`."""

import inspect
import re
from collections.abc import Mapping
from dataclasses import fields
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

from solvers.equations.module import GeneratedModule
from solvers.io.suggestion import did_you_mean, shortened
from solvers.io.toml_input import InputError, check_keys
from solvers.sweeps import maps
from solvers.sweeps.definition.map_table import MapTable
from solvers.sweeps.maps import Map


def names() -> tuple[str, ...]:
    """Words for the kinds in a sweep file, in alphabetical order."""
    return tuple(sorted(file.name.replace("_", " ") for file in iter_modules(maps.__path__)))


def load(name: str) -> type[Map]:
    """The class of a kind: the only one that its module defines."""
    module = import_module(f"{maps.__name__}.{name.replace(' ', '_')}")
    (kind,) = (
        value
        for value in vars(module).values()
        if inspect.isclass(value) and issubclass(value, Map) and value.__module__ == module.__name__
    )
    return kind


def read(path: str, module: GeneratedModule, table: Mapping[str, Any]) -> Map:
    """The map that a table of a sweep file specifies."""
    known, word = names(), table.get("kind")
    options = ", ".join(map(repr, known))
    if word is None:
        raise InputError(f"{path}.kind is missing: give one of {options}")
    if not isinstance(word, str) or word not in known:
        hint = did_you_mean(word, known) if isinstance(word, str) else ""
        raise InputError(f"{path}.kind = {shortened(word)}{hint} must be one of {options}")
    kind = load(word)
    keys = [field.name for field in fields(kind)]  # type: ignore[arg-type]  # a dataclass
    check_keys(path, table, ("kind", *keys))
    return kind.read(MapTable(path, module, table))


def markdown_table() -> str:
    """A Markdown table of all kinds, from their classes."""
    rows = ["| kind | result for each motion | keys, for example | shape |\n|---|---|---|---|"]
    for name in names():
        kind = load(name)
        summary = re.split(r"\n\n\w+\n-+\n", inspect.getdoc(kind) or "")[0]
        description = " ".join(summary.split()).replace("|", r"\|")
        example = f"`{kind.example}`" if kind.example else "none"
        shape = ", ".join(kind.dimensions) or "one number"
        rows.append(f"| `{name}` | {description} | {example} | {shape} |")
    return "\n".join(rows) + "\n"
