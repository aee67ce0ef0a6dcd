"""A pendulum whose other coordinates are too light to matter."""

from __future__ import annotations

import numpy as np

from solvers.references.elliptic import pendulum as exact
from solvers.scenes.models.model import Array, Motion, OutsideDomainError
from solvers.scenes.models.pendulum import ANGLES, SAME, Pendulum, rounding

#: Random states that are tried, rounds until a bound of velocities settles, and times of kicks.
STATES, ROUNDS, KICKS = 512, 4, 16
#: What the largest of so many samples may miss; and a velocity in rad/s that means no bound.
MARGIN, ENDLESS = 2.0, 1e6


def light(asked: Motion) -> Pendulum:
    """The closed form for the one angle that is wanted, if the others hardly act on it.

    Whatever the others do, they accelerate for no longer than the motion lasts, which
    bounds their velocities; over all states within the bound the defect is the largest
    difference between the angle's acceleration and a pendulum's. Kicks of that size, at
    any time, make the error.

    Parameters
    ----------
    asked : Motion
        The motion, and which angle and velocity are wanted.

    Returns
    -------
    Pendulum
        The more the others act on it, the larger is the estimate of its error.

    Raises
    ------
    OutsideDomainError
        When not exactly one angle of several is wanted, or it would not move as a pendulum
        does; when a coordinate is no angle or moves no mass, or nothing bounds the others'
        velocities.
    """
    asked.require_mass()
    module, n = asked.module, asked.coordinates
    kept = {i % n for i in asked.wanted}
    if len(kept) != 1 or n == 1:
        raise OutsideDomainError(f"{len(kept)} of {n} coordinates are wanted")
    if any(module.UNITS[q] != "rad" for q in module.COORDINATES):
        raise OutsideDomainError("not all coordinates are angles")
    (k,) = kept
    square = _square(asked, k)
    start = (asked.y0[k], asked.y0[k + n])
    motion = exact(1.0, square, start, asked.looks)
    defect = _defect(asked, k, square, motion)
    error = _kicked(square, motion, asked.looks, asked.duration * defect)
    error += rounding(square, start, False, asked.looks).max(axis=0)
    wanted = [i // n for i in asked.wanted]
    return Pendulum(k, n, start, square, 0.0, float(error[wanted].max()),
                    f"other coordinates accelerate {module.COORDINATES[k]} by at most "
                    f"{defect:.1g} rad/s²")  # fmt: skip


def _square(asked: Motion, k: int) -> float:
    """ω² of the pendulum that is left, in 1/s²."""
    n = asked.coordinates
    y = np.zeros((2 * n, ANGLES, ANGLES))
    angle = 2 * np.pi * np.arange(ANGLES) / ANGLES
    y[:n] = angle  # all others take all angles
    y[k] = angle[:, None]
    mass = asked.module.mass_matrix_many(0.0, y, asked.params)[k][k]
    weight = asked.module.energy_many(0.0, y, asked.params).mean(axis=1)
    swing = -2 * float(weight @ np.cos(angle)) / ANGLES
    if np.ptp(mass) > SAME * mass.max() or swing <= 0:
        raise OutsideDomainError("it does not move as a pendulum does")
    return swing / float(mass.flat[0])


def _defect(asked: Motion, k: int, square: float, motion: Array) -> float:
    """The largest acceleration by other coordinates that is within reach."""
    n, random = asked.coordinates, np.random.default_rng(2)
    y = random.uniform(-np.pi, np.pi, (2 * n, STATES))
    y[[k, k + n]] = motion[random.integers(0, len(motion), STATES)].T
    others = [j for j in range(n) if j != k]
    before = np.abs(np.array(asked.y0)[[j + n for j in others]])
    bound, share = before, random.uniform(-1, 1, (n - 1, STATES))
    found = np.inf
    for _ in range(ROUNDS):
        y[[j + n for j in others]] = bound[:, None] * share
        rates = asked.module.rhs_many(0.0, y, asked.params)[n:]
        found = float(np.abs(rates[k] + square * np.sin(y[k])).max())
        bound = before + MARGIN * np.abs(rates[others]).max(axis=1) * asked.duration
        if not bound.max() < ENDLESS:
            raise OutsideDomainError("nothing bounds the velocities of the other coordinates")
    return MARGIN * found


def _kicked(square: float, motion: Array, times: Array, kick: float) -> Array:
    """What a kick makes at most of angle and velocity, given at any time and in any direction.

    It is given as it is: next to the separatrix nothing is in proportion.

    Parameters
    ----------
    square : float
        ω² of the pendulum in 1/s².
    motion : ndarray of shape (times, 2)
        Angles in rad and velocities in rad/s, at some of which kicks are given.
    times : ndarray of shape (times,)
        When to look after a kick, in s.
    kick : float
        What it adds to the velocity, in rad/s.

    Returns
    -------
    ndarray of shape (2,)
        In rad and rad/s.
    """
    worst = np.zeros(2)
    for angle, velocity in motion[:: max(len(motion) // KICKS, 1)]:
        plain = exact(1.0, square, (angle, velocity), times)
        for way in (-kick, kick):
            apart = np.abs(exact(1.0, square, (angle, velocity + way), times) - plain)
            worst = np.maximum(worst, apart.max(axis=0))
    return worst
