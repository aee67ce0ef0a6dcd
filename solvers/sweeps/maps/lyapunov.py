"""Lyapunov exponents."""

from dataclasses import dataclass

from solvers.sweeps.definition.axes import Array
from solvers.sweeps.maps import Map, Motions


@dataclass(frozen=True)
class Lyapunov(Map):
    """Lyapunov exponent ln(norm(δ(t))/norm(δ(0)))/t in 1/s over the duration of the motion.

    The components of the initial perturbation δ₀ of the state are all equal, in m, rad and s. In
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
    own_unit = "1/s"
    colour_map = "magma"
    is_variational = True

    def values(self, motions: Motions) -> Array:
        return motions.ensemble.growth / (motions.ensemble.t - motions.begin)
