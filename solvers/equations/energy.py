"""Energy: whether a system keeps it and whether it separates; units, errors and supplied energy.

Errors are relative to the energy of a motion above that of the system at rest.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import ArrayLike, NDArray

from solvers.equations.module import (
    GeneratedModule,
    depends_on_time,
    function,
    has_constraints,
    has_function,
    part,
    switching_functions,
)
from solvers.io.suggestion import listed

Array = NDArray[np.float64]

#: States between neighbouring times at which the power is integrated.
NODES = 8
#: The unit of relative energy errors.
ABOVE_REST = "energy above rest"

#: Share of an energy below which a difference from it is rounding.
ROUNDING = 32 * float(np.finfo(float).eps)


@dataclass(frozen=True)
class EnergyUnit:
    """The unit of the energy errors of a motion: its energy above rest, or 1 J."""

    name: str  # `ABOVE_REST` or "J"
    joules: float

    @property
    def is_relative(self) -> bool:
        """Whether errors are relative to the energy above rest."""
        return self.name == ABOVE_REST


def conserves_energy(module: GeneratedModule) -> bool:
    """Whether the energy of every motion is constant."""
    changes = has_function(module, "power") or depends_on_time(module, "energy")
    return has_function(module, "energy") and not changes


def energy_unit(module: GeneratedModule, params: Sequence[float], first: float) -> EnergyUnit:
    """The unit of the energy errors of a motion.

    Parameters
    ----------
    module : module
        A generated module.
    params : sequence of float
        In the order of ``module.PARAMETERS``.
    first : float
        Energy at the start in J.

    Returns
    -------
    EnergyUnit
        The energy above rest; J where no equilibrium is known, or the motion does not start above
        it.
    """
    rest = energy_at_rest(module, params)
    if rest is not None and first - rest > ROUNDING * max(abs(first), abs(rest)):
        return EnergyUnit(ABOVE_REST, first - rest)
    return EnergyUnit("J", 1.0)


def energy_at_rest(module: GeneratedModule, params: Sequence[float]) -> float | None:
    """Energy of the system at its equilibrium in J; None if no equilibrium is known."""
    y = equilibrium_state(module, params)
    return None if y is None else float(module.energy(0.0, y.tolist(), params))


def energy_error(
    module: GeneratedModule, params: Sequence[float], energy: ArrayLike
) -> NDArray[np.float64]:
    """Differences of energies from the first one, in the unit of `energy_unit`.

    Relative to the first one above rest; in J where no equilibrium is known, or the motion does not
    start above it.

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
    values = np.asarray(energy, dtype=float)
    return (values - values[0]) / energy_unit(module, params, float(values[0])).joules


def supplied_energy(
    module: GeneratedModule,
    params: Sequence[float],
    times: ArrayLike,
    states: Callable[[Array], Array],
) -> Array:
    """Energy in J supplied by forces, friction and prescribed motions since the first of `times`.

    The power is integrated by Gauss's formula with `NODES` states between neighbouring times: where
    these include every step, the error is that of the states.

    Parameters
    ----------
    module : module
        A generated module.
    params : sequence of float
        In the order of ``module.PARAMETERS``.
    times : array_like of shape (n,)
        Increasing times in s.
    states : callable
        Returns coordinates and velocities at increasing times of shape (m,), shape (m, state).

    Returns
    -------
    ndarray of shape (n,)
        Zeros for a system without such a supply.
    """
    ends = np.asarray(times, dtype=float)
    if not has_function(module, "power"):
        return np.zeros_like(ends)
    nodes, weights = leggauss(NODES)
    halves = np.diff(ends) / 2
    between = (ends[:-1] + halves)[:, None] + halves[:, None] * nodes
    # neighbours that are as close as rounding share nodes
    t, indices = np.unique(between, return_inverse=True)
    power = function(module, "power_many")(t, np.nan_to_num(states(t)).T, params)
    power = np.broadcast_to(power, t.shape)[indices.reshape(between.shape)]
    return np.array([0.0, *np.cumsum(halves * (power @ weights))])


def equilibrium_state(module: GeneratedModule, params: Sequence[Any]) -> NDArray[np.float64] | None:
    """The state (q, 0) of the equilibrium; None if no equilibrium is known.

    Parameters that are arrays, for several motions, give states in columns.
    """
    if not has_function(module, "equilibrium"):
        return None
    name = "equilibrium_many" if any(map(np.ndim, params)) else "equilibrium"
    q = np.asarray(function(module, name)(params))
    return np.concatenate([q, np.zeros_like(q)])


def coupling(module: GeneratedModule) -> str:
    """The reason why accelerations do not depend on positions and time alone; empty if they do.

    Where kinetic energy depends on velocities alone, and potential energy on positions, kicks of
    velocities and drifts of positions, in turn, are motions of parts of the system. Generated
    modules state the variables of their functions.
    """
    if has_constraints(module):
        return f"the system {module.SYSTEM} has constraints, whose forces depend on velocities"
    if switching_functions(module):
        return f"forces of the system {module.SYSTEM} have kinks or jumps, at which steps end"
    positions = module.COORDINATES
    names = part(module, "rhs").VARIABLES["accelerations"]
    velocities = [name for name in names if name not in positions]
    if not velocities:
        return ""
    of_masses: tuple[str, ...] = ()
    if has_function(module, "mass_matrix"):
        of_masses = part(module, "mass_matrix").VARIABLES["mass_matrix"]
    if of_masses:
        return f"the mass matrix of the system {module.SYSTEM} depends on {listed(of_masses)}"
    return f"accelerations of the system {module.SYSTEM} depend on {listed(velocities)}"
