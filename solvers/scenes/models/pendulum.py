"""The single pendulum by Jacobi's elliptic functions, for every motion that is one."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from solvers.integration.accuracy.checked_motion import Array, Motion, OutsideDomainError
from solvers.references.elliptic import pendulum as exact
from solvers.references.elliptic import swing
from solvers.scenes.models.model_catalogue import EPS, ROUNDINGS, ClosedForm
from solvers.scenes.models.one_degree_of_freedom import ReducedMotion

#: Largest relative difference of equal numbers, and number of angles that are compared.
SAME, ANGLES = 1e-13, 32
#: Longest quarter period times ω: K(k) with 1 - k² of the size of a squared rounding.
QUARTER = 40.0


@dataclass(frozen=True)
class Pendulum(ClosedForm):
    """One angle obeys θ̈ = -ω² sin(θ - bottom); other coordinates have no inertia."""

    name: ClassVar[str] = "pendulum"
    complexity: ClassVar[int] = 30
    applies_to: ClassVar[str] = "one angle with inertia, as a pendulum: elliptic functions"
    error_source: ClassVar[str] = "rounding"

    coordinate: int
    n_coordinates: int
    start: tuple[float, float]
    omega_squared: float
    bottom: float

    @classmethod
    def of(cls, motion: Motion) -> Self:
        """The closed form, with its rounding error."""
        if len(motion.inertial) != 1:
            raise OutsideDomainError(f"{len(motion.inertial)} coordinates have inertia")
        reduced, k = ReducedMotion.of(motion), motion.inertial[0]
        u = 2 * np.pi * np.arange(ANGLES) / ANGLES
        mu, W, _, _ = reduced.parts(u)
        pull = -2 * float(W @ np.cos(u)) / ANGLES  # W = const - pull cos u
        other = np.abs(W - W.mean() + pull * np.cos(u)).max()
        if not reduced.is_angle or np.ptp(mu) > SAME * mu[0] or other > SAME * abs(pull):
            raise OutsideDomainError("its potential energy is not that of a pendulum")
        square, bottom = abs(pull) / float(mu[0]), 0.0 if pull > 0 else np.pi
        start = (reduced.start[0], reduced.start[1])
        shifted = (start[0] - bottom, start[1])
        error = rounding_errors(square, shifted, bool(bottom), motion.sample_times).max()
        why = f"{motion.module.COORDINATES[k]} alone has inertia, and moves as a pendulum"
        constants = (k, motion.n_coordinates, start, square, bottom)
        return cls(*constants, error_estimate=float(error), why=why)

    def states(self, t: Array) -> Array:
        states = np.full((len(t), 2 * self.n_coordinates), np.nan)
        start = (self.start[0] - self.bottom, self.start[1])
        columns = [self.coordinate, self.coordinate + self.n_coordinates]
        states[:, columns] = exact(1.0, self.omega_squared, start, t)
        states[:, self.coordinate] += self.bottom
        return states


def rounding_errors(
    square: float, start: tuple[float, float], is_shifted: bool, times: Array
) -> Array:
    """Rounding errors at `times`, as the effect of rounding the numbers of the closed form."""
    omega, half = np.sqrt(square), start[0] / 2
    if abs(start[0]) > np.pi:
        half = np.remainder(half + np.pi / 2, np.pi) - np.pi / 2
    parts = np.array([omega, np.sin(half), np.cos(half), start[1] / (2 * omega)])

    def states(parts: Array, delay: float = 0.0) -> Array:
        omega, sine, cosine, speed = parts.tolist()
        return swing(omega, sine, cosine, speed, times + delay)

    reference = states(parts)
    total = ROUNDINGS * EPS * (np.abs(reference) + abs(start[0]))
    changes = [parts * (1 + ROUNDINGS * EPS * unit) for unit in np.eye(4)]
    if is_shifted or abs(start[0]) > np.pi:  # the angle itself was rounded
        shifted = half + ROUNDINGS * EPS * max(abs(start[0]), np.pi)
        changes.append(np.array([omega, np.sin(shifted), np.cos(shifted), parts[3]]))
    for change in changes:
        total += np.abs(states(change) - reference)
    # a quarter period is rounded, and a long one has many roundings
    return total + np.abs(states(parts, ROUNDINGS * EPS * QUARTER / omega) - reference)
