"""Energy errors."""

from dataclasses import dataclass

from solvers.sweeps.axes import Array
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
        n, ensemble = len(motions.module.STATE), motions.ensemble
        before = motions.energies(0.0, motions.starts[:, :n])
        return motions.energies(ensemble.t, ensemble.y.T[:, :n]) - before
