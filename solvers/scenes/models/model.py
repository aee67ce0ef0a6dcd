"""The base classes of all models of a motion."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from solvers.equations.module import GeneratedModule, depends_on_time, has_function
from solvers.integration.accuracy.checked_motion import Array, Motion
from solvers.integration.accuracy.integration_run import IntegrationRun, median_seconds

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
