"""The change of an energy that the system keeps: evidence, at no cost, of a useless result."""

import numpy as np
from numpy.typing import NDArray

from solvers.equations.energy import equilibrium_state
from solvers.equations.forms import Form
from solvers.integration.checks.predictability import PredictabilityWarning
from solvers.runge_kutta.stepper import Array

#: Part of the motion's energy, and number of steps, from which on its change is a drift that calls
#: for another method. Errors of a symplectic method do not add up, and shorter steps that reduce a
#: thousandth cost little in runs of fewer steps.
VISIBLE, LONG = 1e-3, 1000
#: The tolerable change, in units of the motion's energy. In 10,000 runs of twelve systems every
#: larger change had errors above a tenth of the motion, and errors below 0.3 only at tolerances
#: of 0.1.
TOLERABLE = 1.0


class EnergyWarning(PredictabilityWarning):
    """The energy of a motion that conserves it has changed by more than itself."""


class DriftWarning(PredictabilityWarning):
    """The energy of a long motion drifts, as it does not by a symplectic method."""


def energies(form: Form, y: Array) -> Array:
    """Energies in J of ordinary states in columns."""
    with np.errstate(all="ignore"):
        return np.asarray(form.module.energy_many(0.0, y[: len(form.module.STATE)], form.constants))


def motion_energy(form: Form, start: Array) -> Array:
    """The energy in J that motions from states in columns have: what a large change is.

    The largest of kinetic energy, potential energy, and energy above that of the equilibrium,
    where one is known.
    """
    n = len(form.module.COORDINATES)
    own, at_rest = energies(form, start), start.copy()
    at_rest[n:] = 0.0
    potential = energies(form, at_rest)
    rest = equilibrium_state(form.module, form.constants)
    above = own - (np.nan if rest is None else energies(form, rest))
    parts = [np.abs(part) for part in np.broadcast_arrays(own - potential, potential, above)]
    return np.asarray(np.fmax.reduce(parts))


def changed_energy(
    form: Form, start: Array, end: Array, tolerable: float = TOLERABLE
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Energies in J of start and end, states in columns, and whether they differ intolerably.

    A `tolerable` change is given in units of the motion's energy.
    """
    before, after = energies(form, start), energies(form, end)
    with np.errstate(all="ignore"):
        is_tolerable = np.abs(after - before) <= tolerable * motion_energy(form, start)
    return before, after, ~is_tolerable
