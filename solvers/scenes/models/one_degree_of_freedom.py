"""Motions with one degree of freedom: ½ μ(u) u'² + W(u) = E.

One remains where there is one coordinate, and where of two one rotates the whole system, which
changes no energy: then its angular momentum L = I s' + C u' is conserved, W = V + L²/2I, and
μ = B - C²/I, with the system's rotation s and its shape u, and I, C, B the mass matrix for
rotation, for rotation and change of shape, and for change of shape.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from solvers.scenes.models.motion import Array, Motion, OutsideDomainError

#: Largest relative difference of equal energies, and number of random states to compare.
SAME, STATES = 1e-12, 8


@dataclass(frozen=True)
class ReducedMotion:
    """A motion reduced to its shape u: q = u shape + s rotation.

    `rotation` is zero where none is separated; `start` holds u, u' and s; `momentum` and `energy`
    are L and E.
    """

    motion: Motion
    shape: Array
    rotation: Array
    is_angle: bool
    start: tuple[float, float, float]
    momentum: float
    energy: float

    @classmethod
    def of(cls, motion: Motion) -> Self:
        """The reduced motion; `OutsideDomainError` where more degrees of freedom remain."""
        q, qdot = np.split(np.array(motion.y0), 2)
        shape, rotation = _directions(motion)
        k = int(np.argmax(shape))
        if not rotation.any():
            s = s_dot = 0.0
            u, u_dot = float(q[k]), float(qdot[k])
        else:
            # the rotation is the value of a coordinate that is not the shape
            j = int(np.argmax(rotation * (1 - shape)))
            s, s_dot = float(q[j]), float(qdot[j])
            u, u_dot = float(q[k] - s * rotation[k]), float(qdot[k] - s_dot * rotation[k])
        is_angle = motion.module.UNITS[motion.module.COORDINATES[k]] == "rad"
        reduced = cls(motion, shape, rotation, is_angle, (u, u_dot, s), 0.0, 0.0)
        state = np.concatenate([u * shape, 0 * shape])
        M = np.array(motion.module.mass_matrix_many(0.0, state, motion.params))
        momentum = float(rotation @ M @ (u_dot * shape + s_dot * rotation))
        reduced = replace(reduced, momentum=momentum)
        mu, potential, _, _ = reduced.parts(np.array(u))
        energy = float(mu * u_dot**2 / 2 + potential)
        if not np.isfinite(energy):
            raise OutsideDomainError("the initial energy is not finite")
        return replace(reduced, energy=energy)

    def parts(self, u: Array) -> tuple[Array, Array, Array, Array]:
        """μ, W, L/I and C/I at shapes u; the last two are zero without a rotation."""
        u, module, params = np.asarray(u, dtype=float), self.motion.module, self.motion.params
        states = np.multiply.outer(np.concatenate([self.shape, 0 * self.shape]), u)
        M = module.mass_matrix_many(0.0, states, params)
        potential = module.energy_many(0.0, states, params)
        B = np.einsum("i,ij...,j->...", self.shape, M, self.shape)
        if not self.rotation.any():
            return B, potential, np.zeros_like(u), np.zeros_like(u)
        C = np.einsum("i,ij...,j->...", self.rotation, M, self.shape)
        inertia = np.einsum("i,ij...,j->...", self.rotation, M, self.rotation)
        with np.errstate(divide="ignore", invalid="ignore"):
            W = potential + self.momentum**2 / (2 * inertia)
            return B - C**2 / inertia, W, self.momentum / inertia, C / inertia

    def states(self, u: Array, u_dot: Array, s: Array, s_dot: Array) -> Array:
        """Coordinates and velocities, shape (n, state); NaN for those without inertia."""
        q = np.outer(u, self.shape) + np.outer(s, self.rotation)
        qdot = np.outer(u_dot, self.shape) + np.outer(s_dot, self.rotation)
        exists = np.where((self.shape == 0) & (self.rotation == 0), np.nan, 1.0)
        return np.hstack([q * exists, qdot * exists])


def _directions(motion: Motion) -> tuple[Array, Array]:
    """The directions of the shape and of the rotation of the whole system."""
    n, inertial, module = motion.n_coordinates, motion.inertial, motion.module
    unit = np.eye(n)
    if len(inertial) == 1:
        return unit[inertial[0]], np.zeros(n)
    angles = [k for k in inertial if module.UNITS[module.COORDINATES[k]] == "rad"]
    rotation = unit[angles].sum(axis=0)
    if len(inertial) != 2 or not angles:
        raise OutsideDomainError(f"{len(inertial)} coordinates have inertia")
    if not _conserves_energy(motion, rotation):
        raise OutsideDomainError("rotating the whole system changes its energy")
    shapes = [k for k in inertial if k not in angles] or [inertial[-1]]
    return unit[shapes[0]], rotation


def _conserves_energy(motion: Motion, rotation: Array) -> bool:
    """Whether the energy of random states is the same after a rotation."""
    random = np.random.default_rng(1)
    y = random.uniform(0.2, 3.0, (2 * motion.n_coordinates, STATES))
    rotated = y.copy()
    rotated[: len(rotation)] += np.outer(rotation, random.uniform(-3, 3, STATES))
    before = motion.module.energy_many(0.0, y, motion.params)
    after = motion.module.energy_many(0.0, rotated, motion.params)
    return bool(np.all(np.abs(before - after) <= SAME * np.abs(before).max()))
