"""Colours that suit what a map holds."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from matplotlib.colors import LogNorm, Normalize
from numpy.typing import NDArray

from solvers.sweeps.map import Map
from solvers.sweeps.maps import EnergyError, Final, First, Lyapunov

Array: TypeAlias = NDArray[np.float64]

#: Where nothing happened or nothing is known, and where it is proved that nothing can happen.
NOTHING, NEVER = "#c8c8c8", "#ffffff"
#: A map shows values between these percentiles, and colours those beyond like them.
SHOWN = (0.5, 99.5)


def colours(one: Map, values: Array, unit: str) -> tuple[str, Normalize]:
    """A colour map and its range: cyclic for directions, logarithmic for times and errors."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return "viridis", Normalize(0, 1)
    if isinstance(one, First | EnergyError):
        sizes = np.abs(finite[finite != 0])
        low, high = np.percentile(sizes, SHOWN) if sizes.size else (1e-17, 1e-16)
        return ("viridis_r" if isinstance(one, First) else "magma"), LogNorm(low, max(high, low))
    if is_direction(one, unit):
        return "twilight", Normalize(-np.pi, np.pi)
    low, high = np.percentile(finite, SHOWN)
    if isinstance(one, Lyapunov):
        return "magma", Normalize(min(low, 0.0), high)
    if low < 0 < high:
        return "RdBu_r", Normalize(-max(-low, high), max(-low, high))
    return "viridis", Normalize(low, high)


def is_direction(one: Map, unit: str) -> bool:
    """Whether only the direction of an angle is of interest: where motions end, not how far."""
    return type(one) is Final and unit == "rad"


def shown(one: Map, values: Array, unit: str) -> Array:
    """Values as they are drawn: directions between -π and π, errors without their sign."""
    if is_direction(one, unit):
        return np.asarray(np.remainder(values + np.pi, 2 * np.pi) - np.pi)
    return np.abs(values) if isinstance(one, EnergyError) else np.asarray(values)
