"""Motions with one degree of freedom left: ½ μ(u) u'² + W(u) = E.

One is left where there is one coordinate, and where of two one turns the whole system, which
changes no energy: then its angular momentum L = I s' + C u' is kept, W = V + L²/2I, and
μ = B - C²/I, with the system's angle s and its shape u, and I, C, B what the mass matrix is
for turning, for turning and changing shape, and for changing shape.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from solvers.scenes.models.model import Array, Motion, OutsideDomainError

#: Two energies that differ by less are the same, relatively: random states tell.
SAME, STATES = 1e-12, 8


@dataclass(frozen=True)
class EnergyForm:
    """A motion reduced to its shape u.

    Attributes
    ----------
    asked : Motion
        The motion.
    shape, turn : ndarray of shape (coordinates,)
        q = u shape + s turn; without a turn the latter is zero.
    is_angle : bool
        Whether u comes back after 2π.
    start : tuple of float
        u, u', s at the beginning.
    momentum, energy : float
        L and E.
    """

    asked: Motion
    shape: Array
    turn: Array
    is_angle: bool
    start: tuple[float, float, float]
    momentum: float
    energy: float

    def parts(self, u: Array) -> tuple[Array, Array, Array, Array]:
        """μ, W, L/I and C/I at shapes u; the last two are zero without a turn."""
        u = np.asarray(u, dtype=float)
        states = np.multiply.outer(np.concatenate([self.shape, 0 * self.shape]), u)
        M = self.asked.module.mass_matrix_many(0.0, states, self.asked.params)
        potential = self.asked.module.energy_many(0.0, states, self.asked.params)
        B = np.einsum("i,ij...,j->...", self.shape, M, self.shape)
        if not self.turn.any():
            return B, potential, np.zeros_like(u), np.zeros_like(u)
        C = np.einsum("i,ij...,j->...", self.turn, M, self.shape)
        inertia = np.einsum("i,ij...,j->...", self.turn, M, self.turn)
        with np.errstate(divide="ignore", invalid="ignore"):
            return (B - C**2 / inertia, potential + self.momentum**2 / (2 * inertia),
                    self.momentum / inertia, C / inertia)  # fmt: skip

    def states(self, u: Array, u_dot: Array, s: Array, s_dot: Array) -> Array:
        """Coordinates and velocities, shape (n, state); NaN for what moves no mass."""
        place = np.outer(u, self.shape) + np.outer(s, self.turn)
        speed = np.outer(u_dot, self.shape) + np.outer(s_dot, self.turn)
        there = np.where((self.shape == 0) & (self.turn == 0), np.nan, 1.0)
        return np.hstack([place * there, speed * there])


def energy_form(asked: Motion) -> EnergyForm:
    """The form of a motion.

    Parameters
    ----------
    asked : Motion
        The motion.

    Returns
    -------
    EnergyForm

    Raises
    ------
    OutsideDomainError
        When more than one degree of freedom is left, or the energy is not finite.
    """
    q, qdot = np.split(np.array(asked.y0), 2)
    shape, turn = _directions(asked)
    k = int(np.argmax(shape))
    if not turn.any():
        s = s_dot = 0.0
        u, u_dot = float(q[k]), float(qdot[k])
    else:
        # where the whole system turns, one coordinate says how far: one that is no shape
        j = int(np.argmax(turn * (1 - shape)))
        s, s_dot = float(q[j]), float(qdot[j])
        u, u_dot = float(q[k] - s * turn[k]), float(qdot[k] - s_dot * turn[k])
    is_angle = asked.module.UNITS[asked.module.COORDINATES[k]] == "rad"
    form = EnergyForm(asked, shape, turn, is_angle, (u, u_dot, s), 0.0, 0.0)
    M = np.array(asked.module.mass_matrix_many(0.0, np.concatenate([u * shape, 0 * shape]),
                                               asked.params))  # fmt: skip
    momentum = float(turn @ M @ (u_dot * shape + s_dot * turn))
    form = replace(form, momentum=momentum)
    mu, potential, _, _ = form.parts(np.array(u))
    energy = float(mu * u_dot**2 / 2 + potential)
    if not np.isfinite(energy):
        raise OutsideDomainError("the energy at the beginning is not finite")
    return replace(form, energy=energy)


def _directions(asked: Motion) -> tuple[Array, Array]:
    """In which direction the shape changes, and in which the whole system turns."""
    n, alive = asked.coordinates, asked.alive
    unit = np.eye(n)
    if len(alive) == 1:
        return unit[alive[0]], np.zeros(n)
    angles = [k for k in alive if asked.module.UNITS[asked.module.COORDINATES[k]] == "rad"]
    turn = unit[angles].sum(axis=0)
    if len(alive) != 2 or not angles:
        raise OutsideDomainError(f"{len(alive)} coordinates move")
    if not _unchanged(asked, turn):
        raise OutsideDomainError("turning the whole system changes its energy")
    shapes = [k for k in alive if k not in angles] or [alive[-1]]
    return unit[shapes[0]], turn


def _unchanged(asked: Motion, turn: Array) -> bool:
    """Whether the energy of any state is the same after a turn."""
    random = np.random.default_rng(1)
    y = random.uniform(0.2, 3.0, (2 * asked.coordinates, STATES))
    turned = y.copy()
    turned[: len(turn)] += np.outer(turn, random.uniform(-3, 3, STATES))
    before, after = (asked.module.energy_many(0.0, state, asked.params) for state in (y, turned))
    return bool(np.all(np.abs(before - after) <= SAME * np.abs(before).max()))
