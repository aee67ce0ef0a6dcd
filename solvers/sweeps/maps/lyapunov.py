"""Lyapunov exponents."""

from __future__ import annotations

from dataclasses import dataclass

from solvers.equations.module import GeneratedModule
from solvers.sweeps.maps import Array, Map, Motions


@dataclass(frozen=True)
class Lyapunov(Map):
    """Lyapunov exponent ln(norm(δ(t))/norm(δ(0)))/t in 1/s over the duration of the motion.

    The components of the initial small change δ₀ of the state are all equal, in m, rad and s. In
    regular motion the exponent decreases as ln t/t.

    Notes
    -----
    The change follows the variational equations. The limit of long times is the largest exponent
    for almost every δ₀ (G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn, Meccanica 15
    (1980) 9-20).

    Examples
    --------
    >>> Lyapunov().unit(None)
    '1/s'
    """

    quantity = "Lyapunov exponent"
    colour_map = "magma"
    is_variational = True

    def unit(self, module: GeneratedModule, component: str = "") -> str:
        """Unit of a rate."""
        return "1/s"

    def values(self, motions: Motions) -> Array:
        """The exponents."""
        return motions.ensemble.growth / motions.ensemble.t
