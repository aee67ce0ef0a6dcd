"""Energy errors."""

from dataclasses import dataclass

import numpy as np

from solvers.sweeps.definition.axes import Array
from solvers.sweeps.maps import Map, Motions


@dataclass(frozen=True)
class EnergyError(Map):
    """Energy at the end minus energy at the start, in J.

    Systems with friction or driving, which change the energy, are refused.

    Examples
    --------
    >>> EnergyError().shape
    ()
    """

    quantity = "energy error"
    own_unit = "J"
    colour_map = "magma"
    is_logarithmic = True
    uses_energy = True

    def values(self, motions: Motions) -> Array:
        n, ensemble, energy = (
            len(motions.module.STATE),
            motions.ensemble,
            motions.module.energy_many,
        )
        after = np.asarray(energy(ensemble.t, ensemble.y[:n], motions.params))
        return after - np.asarray(energy(motions.begin, motions.starts[:, :n].T, motions.params))
