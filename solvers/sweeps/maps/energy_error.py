"""Energy errors."""

from __future__ import annotations

from dataclasses import dataclass

from solvers.equations.module import GeneratedModule
from solvers.sweeps.maps import Array, Map, Motions


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
    colour_map = "magma"
    is_logarithmic = True
    uses_energy = True

    def unit(self, module: GeneratedModule, component: str = "") -> str:
        """Unit of an energy."""
        return "J"

    def values(self, motions: Motions) -> Array:
        """Differences of the energy."""
        n, ensemble = len(motions.module.STATE), motions.ensemble
        before = motions.energies(0.0, motions.starts[:, :n])
        return motions.energies(ensemble.t, ensemble.y.T[:, :n]) - before
