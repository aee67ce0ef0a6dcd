"""All models of a motion: every class of a model in this folder."""

from importlib import import_module
from inspect import isabstract, isclass
from pkgutil import iter_modules

from solvers.scenes import models
from solvers.scenes.models.model import ClosedForm, Model


def load() -> dict[str, type[Model]]:
    """All models by their names in scene files, in ascending order of complexity."""
    names = sorted(f"{models.__name__}.{module.name}" for module in iter_modules(models.__path__))
    classes = [c for name in names for c in vars(import_module(name)).values() if isclass(c)]
    concrete = [c for c in classes if issubclass(c, Model) and not isabstract(c)]
    return {model.key(): model for model in sorted(concrete, key=lambda model: model.complexity)}


def closed_forms() -> dict[str, type[ClosedForm]]:
    """The models whose states are not integrated, in ascending order of complexity."""
    return {name: model for name, model in load().items() if issubclass(model, ClosedForm)}


def markdown_table() -> str:
    """All models as a Markdown table, in ascending order of complexity."""
    head = "| `model` | applies to | error estimate |\n|---|---|---|\n"
    row = '| `"{}"` | {.applies_to} | {.error_source} |\n'
    return head + "".join(row.format(key, model, model) for key, model in load().items())
