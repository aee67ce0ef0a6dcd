"""Energy in parts of what is in play: the energy of a motion above that of the system at rest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import cumulative_simpson

from solvers.equations.module import GeneratedModule, function, has_function


def energy_at_rest(module: GeneratedModule, params: Sequence[float]) -> float | None:
    """Energy of the system at its equilibrium, in J; None where it has none that is known."""
    if not has_function(module, "equilibrium"):
        return None
    place = function(module, "equilibrium")(params)
    return float(module.energy(0.0, (*place, *[0.0] * len(place)), params))


def energy_error(
    module: GeneratedModule, params: Sequence[float], energy: ArrayLike
) -> NDArray[np.float64]:
    """How far energies in J are from the first of them, in parts of that one above rest.

    At rest there is nothing to be a part of, nor where no rest is known: then in J.

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
        Positive where energy was gained; the first is 0.
    """
    found, rest = np.asarray(energy, dtype=float), energy_at_rest(module, params)
    return (found - found[0]) / ((found[0] - rest if rest is not None else 0.0) or 1.0)


def supplied_energy(
    module: GeneratedModule, t: ArrayLike, y: ArrayLike, params: Sequence[float]
) -> NDArray[np.float64]:
    """Energy in J that forces, friction and what moves by itself have supplied so far.

    By Simpson's rule over the samples; zeros where nothing does.

    Parameters
    ----------
    module : module
        A generated module.
    t : array_like of shape (n,)
        Times in s, increasing.
    y : array_like of shape (state, n)
        Coordinates and velocities at these times, in the order of ``module.STATE``.
    params : sequence of float
        In the order of ``module.PARAMETERS``.

    Returns
    -------
    ndarray of shape (n,)
        The first is 0.

    Raises
    ------
    ValueError
        When something is supplied, and three times or more do not increase.
    """
    times = np.asarray(t, dtype=float)
    if not has_function(module, "power"):
        return np.zeros_like(times)
    power = function(module, "power_many")(times, y, params)
    return np.asarray(cumulative_simpson(power, x=times, initial=0.0))
