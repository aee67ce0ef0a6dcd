"""Final states."""

from __future__ import annotations

from dataclasses import dataclass

from solvers.sweeps.maps import Array, ComponentMap, Motions


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
        """Components of the final states."""
        return motions.ensemble.y[motions.indices(self.of)].T
