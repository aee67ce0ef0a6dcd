"""Models of a motion: their base classes, and all models, the classes in this folder."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from inspect import isabstract, isclass
from pkgutil import iter_modules
from typing import ClassVar, Self

import numpy as np

from solvers.equations.module import GeneratedModule, depends_on_time, has_function
from solvers.integration.accuracy.checked_motion import Array, Motion
from solvers.integration.accuracy.integration_run import IntegrationRun, median_seconds
from solvers.scenes import models

#: Relative rounding of a number, and roundings that a closed form is assumed to accumulate.
EPS, ROUNDINGS = float(np.finfo(float).eps), 32


@dataclass(frozen=True, kw_only=True)
class Model(ABC):
    """A model of a motion, with an estimate of its error.

    A model is one class in a file of its own in this folder; nothing else lists it.
    """

    name: ClassVar[str]  # in results and messages
    complexity: ClassVar[int]  # models are tried in ascending order of this number
    applies_to: ClassVar[str]  # the motions to which it applies, for documentation
    error_source: ClassVar[str]  # likewise

    #: Largest error of any requested component at any time, in rad, m, rad/s or m/s.
    error_estimate: float
    why: str  # why it applies to this motion
    run: IntegrationRun | None = None  # the integration, for a model that integrates

    @classmethod
    def key(cls) -> str:
        """The value of ``model`` in a scene file."""
        return cls.name

    @abstractmethod
    def states(self, t: Array) -> Array:
        """Coordinates and velocities at times from 0 on, shape (n, state)."""

    def seconds(self, duration: float) -> float:
        """Seconds that the state at the end of the motion takes."""
        end = np.array([duration])
        return median_seconds(lambda: self.states(end))


class ClosedForm(Model):
    """A model whose states are not integrated."""

    @classmethod
    def not_applicable(cls, module: GeneratedModule) -> str:
        """The reason why no motion of a system has this model; empty where some may."""
        if depends_on_time(module):
            return "the equations depend on time"
        if has_function(module, "power"):
            return "energy is not conserved"
        return ""

    @classmethod
    @abstractmethod
    def of(cls, motion: Motion) -> Self:
        """The model of a motion; `OutsideDomainError` where it does not apply."""


def rounding_error(
    states: Callable[[Array], Array],
    y0: Sequence[float],
    sizes: Sequence[float],
    roundings: float,
) -> Array:
    """Effect of rounding the initial state on a closed form at some times, shape (n, state).

    `states` takes an initial state; `sizes` are the magnitudes that are rounded.
    """
    start = np.array(y0, dtype=float)
    reference = states(start)
    total = roundings * EPS * np.abs(reference)
    for k, size in enumerate(sizes):
        # a perturbation of this size and no smaller: near a separatrix nothing is linear
        perturbed = start + roundings * EPS * size * np.eye(len(start))[k]
        total += np.abs(states(perturbed) - reference)
    return total


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
