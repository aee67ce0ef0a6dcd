"""Final states."""

from dataclasses import dataclass

from solvers.equations.signature_checks import checked
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.maps import ComponentMap, Motions


@checked
@dataclass(frozen=True)
class Final(ComponentMap):
    """Components of the state at the end.

    Parameters
    ----------
    of : tuple of str
        The components.

    Examples
    --------
    >>> Final(("theta1", "theta1_dot")).shape
    (2,)
    """

    example = 'of = ["theta1"]'
    wraps_angles = True

    def values(self, motions: Motions) -> Array:
        return motions.ensemble.y[motions.indices(self.of)].T
