"""A pendulum with other coordinates that are too light to act on it."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from solvers.references.elliptic import pendulum as exact
from solvers.scenes.models.motion import Array, Motion, OutsideDomainError
from solvers.scenes.models.pendulum import ANGLES, SAME, Pendulum, rounding_errors

#: Random states, iterations until a bound of velocities settles, and times of kicks.
STATES, ITERATIONS, KICKS = 512, 4, 16
#: Safety factor for a largest value of samples; a velocity in rad/s that counts as unbounded.
MARGIN, UNBOUNDED = 2.0, 1e6


@dataclass(frozen=True)
class PendulumAndLightMasses(Pendulum):
    """The closed form for the one angle that is requested, if the others barely affect it.

    The accelerations of the others act no longer than the motion lasts, which bounds their
    velocities; over all states within the bound the defect is the largest difference between the
    angle's acceleration and a pendulum's. Kicks of that size, at any time, make the error: the more
    the others act on the angle, the larger is the estimate.
    """

    name: ClassVar[str] = "pendulum and light masses"
    complexity: ClassVar[int] = 40
    applies_to: ClassVar[str] = "one requested angle, which lighter masses barely affect"
    error_source: ClassVar[str] = "accelerations caused by the light masses; rounding"

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
        defect = _defect(motion, k, square, states)
        error = _effect_of_kicks(square, states, times, motion.duration * defect)
        error += rounding_errors(square, start, False, times).max(axis=0)
        estimate = float(error[[i // n for i in motion.requested]].max())
        angle = module.COORDINATES[k]
        why = f"other coordinates accelerate {angle} by at most {defect:.1g} rad/s²"
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


def _defect(motion: Motion, k: int, square: float, states: Array) -> float:
    """The largest acceleration by other coordinates within the bound of their velocities."""
    n, random = motion.n_coordinates, np.random.default_rng(2)
    y = random.uniform(-np.pi, np.pi, (2 * n, STATES))
    y[[k, k + n]] = states[random.integers(0, len(states), STATES)].T
    others = [j for j in range(n) if j != k]
    velocities = [j + n for j in others]
    initial = np.abs(np.array(motion.y0)[velocities])
    bound, share = initial, random.uniform(-1, 1, (n - 1, STATES))
    defect = np.inf
    for _ in range(ITERATIONS):
        y[velocities] = bound[:, None] * share
        rates = motion.module.rhs_many(0.0, y, motion.params)[n:]
        defect = float(np.abs(rates[k] + square * np.sin(y[k])).max())
        bound = initial + MARGIN * np.abs(rates[others]).max(axis=1) * motion.duration
        if not bound.max() < UNBOUNDED:
            raise OutsideDomainError("nothing bounds the velocities of the other coordinates")
    return MARGIN * defect


def _effect_of_kicks(square: float, states: Array, times: Array, kick: float) -> Array:
    """Largest changes of angle and velocity by a kick in rad/s at any of `states`."""
    # the kick has its true size, since next to the separatrix nothing is linear
    largest = np.zeros(2)
    for angle, velocity in states[:: max(len(states) // KICKS, 1)]:
        free = exact(1.0, square, (angle, velocity), times)
        for change in (-kick, kick):
            difference = np.abs(exact(1.0, square, (angle, velocity + change), times) - free)
            largest = np.maximum(largest, difference.max(axis=0))
    return largest
