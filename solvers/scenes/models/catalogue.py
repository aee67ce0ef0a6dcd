"""All models of a motion: every class of a model in this folder."""

from __future__ import annotations

from importlib import import_module
from inspect import isabstract
from pkgutil import iter_modules

from solvers.scenes import models
from solvers.scenes.models.model import ClosedForm, Model


def load() -> dict[str, type[Model]]:
    """All models by their names in scene files, in ascending order of complexity."""
    names = sorted(module.name for module in iter_modules(models.__path__))
    modules = [import_module(f"{models.__name__}.{name}") for name in names]
    classes = [
        value
        for module in modules
        for value in vars(module).values()
        if isinstance(value, type) and value.__module__ == module.__name__
    ]
    concrete = [c for c in classes if issubclass(c, Model) and not isabstract(c)]
    return {model.key(): model for model in sorted(concrete, key=lambda model: model.complexity)}


def closed_forms() -> dict[str, type[ClosedForm]]:
    """The models that integrate nothing, in ascending order of complexity."""
    return {name: model for name, model in load().items() if issubclass(model, ClosedForm)}


def markdown_table() -> str:
    """All models as a Markdown table, in ascending order of complexity."""
    rows = [
        f'| `"{key}"` | {model.applies_to} | {model.error_source} |'
        for key, model in load().items()
    ]
    return "\n".join(["| `model` | applies to | error estimate |", "|---|---|---|", *rows]) + "\n"
