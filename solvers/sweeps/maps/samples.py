"""States at evenly spaced times."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from solvers.sweeps.map_table import MapTable
from solvers.sweeps.maps import Array, CountedMap, Motions, Panels

if TYPE_CHECKING:
    from solvers.sweeps.results import Results


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

    @classmethod
    def read(cls, table: MapTable) -> Samples:
        """The map that a table of a sweep file specifies."""
        return cls(table.components("of"), table.count("count"))

    @property
    def sample_count(self) -> int:
        """Number of times."""
        return self.count

    def values(self, motions: Motions) -> Array:
        """The samples."""
        return np.swapaxes(motions.ensemble.samples[motions.indices(self.of)], 0, 1)

    def panels(self, name: str, results: Results) -> Panels:
        """A panel of curves over time for each component."""
        from solvers.sweeps.plots.panels import curve_panels

        return curve_panels(name, results)
