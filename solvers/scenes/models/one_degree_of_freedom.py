"""Motions with one degree of freedom: ½ μ(u) u'² + W(u) = E.

One remains where there is one coordinate, and where of two one is cyclic, or a rotation of the
whole system changes no energy: then the momentum L = I s' + C u' is conserved, W = V + L²/2I, and
μ = B - C²/I, with the cyclic coordinate or rotation s, the shape u, and I, C, B the mass matrix for
rotation, for rotation and change of shape, and for change of shape.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from solvers.equations.module import has_function
from solvers.integration.accuracy.checked_motion import Array, Motion, OutsideDomainError

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
    """The directions of the shape, and of a rotation or shift that changes no energy."""
    n, inertial, module = motion.n_coordinates, motion.inertial, motion.module
    unit = np.eye(n)
    if len(inertial) == 1:
        return unit[inertial[0]], np.zeros(n)
    if len(inertial) != 2:
        raise OutsideDomainError(f"{len(inertial)} coordinates have inertia")
    if not has_function(module, "linear") and not _is_reversible(motion):
        raise OutsideDomainError("gyroscopic forces act")
    angles = [k for k in inertial if module.UNITS[module.COORDINATES[k]] == "rad"]
    for rotation in (*unit[list(inertial)], unit[angles].sum(axis=0)):
        if rotation.any() and _is_symmetry(motion, rotation):
            shapes = [k for k in inertial if not rotation[k]] or [inertial[-1]]
            return unit[shapes[0]], rotation
    raise OutsideDomainError(
        "no coordinate is cyclic, and rotating the whole system changes its energy"
    )


def _random_states(motion: Motion) -> Array:
    return np.random.default_rng(1).uniform(0.2, 3.0, (2 * motion.n_coordinates, STATES))


def _is_symmetry(motion: Motion, direction: Array) -> bool:
    """Whether random states have the same energies and accelerations after a shift."""
    module, y = motion.module, _random_states(motion)
    shifted = y.copy()
    shifted[: len(direction)] += np.outer(
        direction, np.random.default_rng(2).uniform(-3, 3, STATES)
    )
    energies, rates = (
        [np.atleast_2d(function(0.0, x, motion.params)) for x in (y, shifted)]
        for function in (module.energy_many, module.rhs_many)
    )
    # a light mass has little energy of its own, but accelerations of any size
    return bool(np.isfinite(energies[0]).any()) and _are_same(*energies) and _are_same(*rates)


def _is_reversible(motion: Motion) -> bool:
    """Whether accelerations of random states stay the same when velocities are reversed."""
    n, y = motion.n_coordinates, _random_states(motion)
    reversed_ = np.vstack([y[:n], -y[n:]])
    rates = [motion.module.rhs_many(0.0, x, motion.params)[n:] for x in (y, reversed_)]
    return bool(np.isfinite(rates[0]).any()) and _are_same(*rates)


def _are_same(before: Array, after: Array) -> bool:
    """Whether rows agree to rounding wherever numbers exist: not without inertia."""
    exists = np.isfinite(before) & np.isfinite(after)
    change = np.where(exists, np.abs(before - after), 0.0)
    size = np.where(exists, np.abs(before), 0.0).max(axis=1, keepdims=True)
    return bool(np.all(change <= SAME * size))
