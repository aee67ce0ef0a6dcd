"""Energy errors, relative to the energy of a motion above that of the system at rest."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import cumulative_simpson

from solvers.equations.module import GeneratedModule, function, has_function


def energy_at_rest(module: GeneratedModule, params: Sequence[float]) -> float | None:
    """Energy of the system at its equilibrium in J; None if no equilibrium is known."""
    if not has_function(module, "equilibrium"):
        return None
    q = function(module, "equilibrium")(params)
    return float(module.energy(0.0, (*q, *[0.0] * len(q)), params))


def energy_error(
    module: GeneratedModule, params: Sequence[float], energy: ArrayLike
) -> NDArray[np.float64]:
    """Differences of energies from the first one, relative to that one above rest.

    In J where the motion starts at rest or no equilibrium is known.

    Parameters
    ----------
    module : module
        A generated module.
    params : sequence of float
        In the order of ``module.PARAMETERS``.
    energy : array_like of shape (n,)
        Energies along a motion in J, at least one.

    Returns
    -------
    ndarray of shape (n,)
        Positive for a gain of energy; the first is 0.
    """
    values, rest = np.asarray(energy, dtype=float), energy_at_rest(module, params)
    scale = values[0] - rest if rest is not None else 0.0
    return (values - values[0]) / (scale or 1.0)


def supplied_energy(
    module: GeneratedModule, t: ArrayLike, y: ArrayLike, params: Sequence[float]
) -> NDArray[np.float64]:
    """Energy in J supplied by forces, friction and prescribed motions since the first sample.

    By Simpson's rule over the samples `y` of shape (state, n) at increasing times `t` in s; zeros
    for a system without such a supply.
    """
    times = np.asarray(t, dtype=float)
    if not has_function(module, "power"):
        return np.zeros_like(times)
    power = function(module, "power_many")(times, y, params)
    return np.asarray(cumulative_simpson(power, x=times, initial=0.0))
