"""Stroboscopic sections."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from solvers.equations.signature_checks import checked
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.definition.map_table import MapTable
from solvers.sweeps.definition.sampling import Sampling
from solvers.sweeps.maps import CountedMap, Motions


@checked
@dataclass(frozen=True)
class Stroboscopic(CountedMap):
    """Stroboscopic section: components at `count` multiples of the period `every`.

    The period is a formula of parameters, which may vary. The first `skip` periods are not stored;
    `phase` shifts all times by this part of a period. The motion ends with the last time, so that
    the sweep has no `duration`.

    Parameters
    ----------
    of : tuple of str
        Components of the state that are stored.
    count : int
        Number of times.
    every : str or float
        Period in s, or a formula of parameters.
    phase : float
        Phase in rad, from 0 to 2π.
    skip : int
        Number of periods before the first time.

    Examples
    --------
    >>> Stroboscopic(("theta", "theta_dot"), 200, "2*pi/Omega", skip=100).shape
    (2, 200)
    """

    every: str | float
    phase: float = 0.0
    skip: int = 0

    example = 'of = ["x"], count = 200, every = "2*pi/Omega", phase = "90 deg", skip = 100'
    plot = "section"
    wraps_angles = True

    @classmethod
    def read(cls, table: MapTable) -> Self:
        phase = table.number("phase", "rad", 0.0)
        periods = table.period("every"), phase, table.count("skip", 0)
        return cls(table.components("of"), table.count("count"), *periods)

    @property
    def sample_count(self) -> int:
        return self.count

    @property
    def sampling(self) -> Sampling:
        return Sampling(self.every, self.count, self.phase, self.skip)

    def values(self, motions: Motions) -> Array:
        return np.swapaxes(motions.ensemble.samples[motions.indices(self.of)], 0, 1)
