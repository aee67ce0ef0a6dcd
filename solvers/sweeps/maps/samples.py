"""States at evenly spaced times."""

from dataclasses import dataclass

import numpy as np

from solvers.equations.signature_checks import checked
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.maps import CountedMap, Motions


@checked
@dataclass(frozen=True)
class Samples(CountedMap):
    """Components of the state at `count` evenly spaced times, start and end included.

    Parameters
    ----------
    of : tuple of str
        The components.
    count : int
        Number of times; the same for all maps of this kind in a sweep.

    Examples
    --------
    >>> Samples(("theta1",), 100).shape
    (1, 100)
    """

    example = 'of = ["theta1"], count = 100'
    plot = "curves"

    @property
    def sample_count(self) -> int:
        return self.count

    def values(self, motions: Motions) -> Array:
        return np.swapaxes(motions.ensemble.samples[motions.indices(self.of)], 0, 1)
