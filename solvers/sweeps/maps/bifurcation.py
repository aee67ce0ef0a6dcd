"""Bifurcation diagrams of driven systems."""

from dataclasses import dataclass

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.equations.signature_checks import checked
from solvers.integration.problem.events import Event
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.maps import Motions
from solvers.sweeps.maps.response import Response


@checked
@dataclass(frozen=True)
class Bifurcation(Response):
    """Bifurcation diagram: components once a period, over `along` upwards and downwards.

    At each value of the parameter `along`, the last axis of a grid, the motion starts where that
    at the value before ended, so that it follows one attractor as long as this exists. The period
    of the drive is `every`; states are those after `count` periods each, after `skip` others.

    Parameters
    ----------
    of : tuple of str
        Components of the state.
    along : str
        The parameter.
    every : str or float
        Period of the drive in s, or a formula of parameters.
    skip : int
        Number of periods at each value before the first that is stored.
    count : int
        Number of periods.

    Examples
    --------
    >>> Bifurcation(("theta_dot",), "a", "2*pi/Omega", skip=100, count=50).shape
    (1, 50, 2)
    """

    example = 'of = ["x"], along = "Omega", every = "2*pi/Omega", skip = 100, count = 50'
    dimensions = ("component", "number", "direction")
    plot = "bifurcation"
    wraps_angles = True
    occurrences = 1

    @property
    def labels(self) -> tuple[tuple[str, ...], ...]:
        return (self.of,)

    @property
    def shape(self) -> tuple[int, ...]:
        return len(self.of), self.count, 2

    @property
    def sample_count(self) -> int:
        return self.count + 1

    def events(self, module: GeneratedModule) -> list[Event]:
        return []

    def values(self, motions: Motions) -> Array:
        states = motions.ensemble.samples[motions.indices(self.of)]
        return np.swapaxes(states[..., 1:], 0, 1)
