"""Extreme values."""

from dataclasses import dataclass

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.equations.signature_checks import checked
from solvers.integration.problem.events import Event, Extremum
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.maps import ComponentMap, Motions


@checked
@dataclass(frozen=True)
class Extremes(ComponentMap):
    """Smallest and largest value of coordinates over the motion, located between steps.

    Parameters
    ----------
    of : tuple of str
        The coordinates.

    Examples
    --------
    >>> Extremes(("theta1", "theta2")).shape
    (2, 2)
    """

    example = 'of = ["theta2"]'
    dimensions = ("component", "extreme")
    occurrences = 2

    @property
    def labels(self) -> tuple[tuple[str, ...], ...]:
        return (self.of, ("smallest", "largest"))

    def events(self, module: GeneratedModule) -> list[Event]:
        return [Extremum(module, f"{name}_dot") for name in self.of]

    def values(self, motions: Motions) -> Array:
        indices, ensemble = motions.indices(self.of), motions.ensemble
        inner = ensemble.y_events[:, :, motions.events, :2]
        between = np.stack([inner[index, :, k] for k, index in enumerate(indices)], axis=1)
        ends = np.stack([motions.starts[:, indices], ensemble.y[indices].T], axis=2)
        candidates = np.concatenate([between, ends], axis=2)
        return np.stack([np.fmin.reduce(candidates, 2), np.fmax.reduce(candidates, 2)], axis=2)
