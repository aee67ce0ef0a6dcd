"""A pendulum with other coordinates that are too light to act on it."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from solvers.integration.accuracy.checked_motion import Array, Motion, OutsideDomainError
from solvers.integration.accuracy.double_precision import check_times
from solvers.integration.accuracy.integration_run import (
    IntegrationRun,
    NotAccurateError,
    TooLongError,
)
from solvers.integration.accuracy.method_choice import MethodChoice, usual_form
from solvers.references.elliptic import pendulum as exact
from solvers.scenes.models.pendulum import ANGLES, SAME, Pendulum, rounding_errors

#: Method and tolerance of the motion of the other coordinates, and number of kicks.
METHOD, TOLERANCE, KICKS = "verner98", 1e-9, 16
#: Safety factor: where the others move chaotically, their motion is another one, as likely.
MARGIN = 2.0


@dataclass(frozen=True)
class PendulumAndLightMasses(Pendulum):
    """The closed form for the one angle that is requested, if the others barely affect it.

    The defect is the difference between the angle's acceleration and a pendulum's, along the motion
    of all coordinates, which is integrated. The error is at most the effect of one kick, at any
    time, of the size of the integral of the defect's magnitude: it assumes that the defect always
    acts in the same direction, at the worst time.
    """

    name: ClassVar[str] = "pendulum and light masses"
    complexity: ClassVar[int] = 40
    applies_to: ClassVar[str] = "one requested angle, which lighter masses barely affect"
    error_source: ClassVar[str] = "accelerations by the light masses along the motion; rounding"

    @classmethod
    def of(cls, motion: Motion) -> Self:
        """The pendulum of the requested angle, with the error caused by the other coordinates."""
        motion.require_inertia()
        module, n = motion.module, motion.n_coordinates
        angles = {i % n for i in motion.requested}
        if len(angles) != 1 or n == 1:
            raise OutsideDomainError(f"{len(angles)} of {n} coordinates are requested")
        if any(module.UNITS[q] != "rad" for q in module.COORDINATES):
            raise OutsideDomainError("not all coordinates are angles")
        (k,) = angles
        square = _omega_squared(motion, k)
        start, times = (motion.y0[k], motion.y0[k + n]), motion.sample_times
        states = exact(1.0, square, start, times)
        kick = MARGIN * _integrated_defect(motion, k, square)
        error = _effect_of_kicks(square, states, times, kick)
        error += rounding_errors(square, start, False, times).max(axis=0)
        estimate = float(error[[i // n for i in motion.requested]].max())
        angle = module.COORDINATES[k]
        why = f"other coordinates change the velocity of {angle} by at most {kick:.1g} rad/s"
        return cls(k, n, start, square, 0.0, error_estimate=estimate, why=why)


def _omega_squared(motion: Motion, k: int) -> float:
    """ω² of the pendulum that remains, in 1/s²."""
    n = motion.n_coordinates
    y = np.zeros((2 * n, ANGLES, ANGLES))
    angle = 2 * np.pi * np.arange(ANGLES) / ANGLES
    y[:n] = angle  # all others take all angles
    y[k] = angle[:, None]
    mass = motion.module.mass_matrix_many(0.0, y, motion.params)[k][k]
    weight = motion.module.energy_many(0.0, y, motion.params).mean(axis=1)
    pull = -2 * float(weight @ np.cos(angle)) / ANGLES
    if np.ptp(mass) > SAME * mass.max() or pull <= 0:
        raise OutsideDomainError("it does not move as a pendulum")
    return pull / float(mass.flat[0])


def _integrated_defect(motion: Motion, k: int, square: float) -> float:
    """∫ |θ̈ + ω² sin θ| dt along the motion, in rad/s."""
    choice = MethodChoice(METHOD, usual_form(motion.module, METHOD), "")
    run = IntegrationRun(motion, choice, TOLERANCE)
    try:
        times = check_times(run)
        states = run.states(times).T
    except (NotAccurateError, TooLongError) as error:
        reason = f"the motion of the other coordinates is not known: {error}"
        raise OutsideDomainError(reason) from error
    rates = motion.module.rhs_many(0.0, states, motion.params)
    defect = np.abs(rates[k + motion.n_coordinates] + square * np.sin(states[k]))
    return float(np.trapezoid(defect, times))


def _effect_of_kicks(square: float, states: Array, times: Array, kick: float) -> Array:
    """Largest changes of angle and velocity by a kick in rad/s at any of `states` at `times`."""
    # the kick has its true size, since next to the separatrix nothing is linear
    largest, duration = np.zeros(2), times[-1]
    every = max(len(states) // KICKS, 1)
    for t, (angle, velocity) in zip(times[::every], states[::every], strict=True):
        after = times[times <= duration - t]
        free = exact(1.0, square, (angle, velocity), after)
        for change in (-kick, kick):
            difference = np.abs(exact(1.0, square, (angle, velocity + change), after) - free)
            largest = np.maximum(largest, difference.max(axis=0))
    return largest
