"""The single pendulum by Jacobi's elliptic functions, wherever a motion is one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solvers.references.elliptic import pendulum as exact
from solvers.references.elliptic import swing
from solvers.scenes.models.model import EPS, ROUNDINGS, Array, Motion, OutsideDomainError
from solvers.scenes.models.one_degree_of_freedom import energy_form

#: Numbers that differ by less are the same, relatively; so many angles tell.
SAME, ANGLES = 1e-13, 32
#: Longest quarter period times ω: K(k) with 1 - k² of the size of a squared rounding.
QUARTER = 40.0


@dataclass(frozen=True)
class Pendulum:
    """One angle obeys θ̈ = -ω² sin(θ - bottom); other coordinates are there in name only."""

    coordinate: int
    coordinates: int
    y0: tuple[float, float]
    square: float
    bottom: float
    error_estimate: float
    why: str
    name: str = "pendulum"

    def states(self, t: Array) -> Array:
        """Angle and velocity; NaN for coordinates that do not exist."""
        found = np.full((len(t), 2 * self.coordinates), np.nan)
        start = (self.y0[0] - self.bottom, self.y0[1])
        places = [self.coordinate, self.coordinate + self.coordinates]
        found[:, places] = exact(1.0, self.square, start, t)
        found[:, self.coordinate] += self.bottom
        return found


def pendulum(asked: Motion) -> Pendulum:
    """The closed form, with what rounding does to it.

    Parameters
    ----------
    asked : Motion
        The motion.

    Returns
    -------
    Pendulum

    Raises
    ------
    OutsideDomainError
        When more than one coordinate moves, or it does not move as a pendulum does.
    """
    if len(asked.alive) != 1:
        raise OutsideDomainError(f"{len(asked.alive)} coordinates move")
    form, k = energy_form(asked), asked.alive[0]
    u = 2 * np.pi * np.arange(ANGLES) / ANGLES
    mu, W, _, _ = form.parts(u)
    pull = -2 * float(W @ np.cos(u)) / ANGLES  # W = const - pull cos u
    other = np.abs(W - W.mean() + pull * np.cos(u)).max()
    if not form.is_angle or np.ptp(mu) > SAME * mu[0] or other > SAME * abs(pull):
        raise OutsideDomainError("its weight does not pull as a pendulum's")
    square, bottom = abs(pull) / float(mu[0]), 0.0 if pull > 0 else np.pi
    start = (form.start[0], form.start[1])
    worst = rounding(square, (start[0] - bottom, start[1]), bool(bottom), asked.looks).max()
    why = f"{asked.module.COORDINATES[k]} alone moves mass, as a pendulum does"
    return Pendulum(k, asked.coordinates, start, square, bottom, float(worst), why)


def rounding(square: float, start: tuple[float, float], is_shifted: bool, times: Array) -> Array:
    """What rounding does: so much as changes of the numbers that the closed form is made of."""
    omega, half = np.sqrt(square), start[0] / 2
    if abs(start[0]) > np.pi:
        half = np.remainder(half + np.pi / 2, np.pi) - np.pi / 2
    parts = np.array([omega, np.sin(half), np.cos(half), start[1] / (2 * omega)])

    def states(parts: Array, late: float = 0.0) -> Array:
        omega, sine, cosine, speed = parts.tolist()
        return swing(omega, sine, cosine, speed, times + late)

    found = states(parts)
    total = ROUNDINGS * EPS * (np.abs(found) + abs(start[0]))
    changes = [parts * (1 + ROUNDINGS * EPS * unit) for unit in np.eye(4)]
    if is_shifted or abs(start[0]) > np.pi:  # the angle itself was rounded
        moved = half + ROUNDINGS * EPS * max(abs(start[0]), np.pi)
        changes.append(np.array([omega, np.sin(moved), np.cos(moved), parts[3]]))
    for change in changes:
        total += np.abs(states(change) - found)
    # a quarter period is rounded, and a long one has many roundings
    return total + np.abs(states(parts, ROUNDINGS * EPS * QUARTER / omega) - found)
