"""Energy in parts of what is in play: the energy of a motion above that of the system at rest."""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray


def energy_at_rest(module: ModuleType, params: Sequence[float]) -> float:
    """Energy of the system at its equilibrium, in J."""
    place = module.equilibrium(params)
    return float(module.energy((*place, *[0.0] * len(place)), params))


def energy_error(
    module: ModuleType, params: Sequence[float], energy: ArrayLike
) -> NDArray[np.float64]:
    """How far energies in J are from the first of them, in parts of that one above rest.

    At rest there is nothing to be a part of: then in J.
    """
    found = np.asarray(energy, dtype=float)
    return (found - found[0]) / (found[0] - energy_at_rest(module, params) or 1.0)
