"""A periodic orbit: its period, multipliers and stability."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from solvers.integration.orbits.orbit_shooting import TINY, OrbitConditions, OrbitStart, Shot
from solvers.runge_kutta.stepper import Array

#: Name of the quantity that varies along a family of a conservative system.
ENERGY = "energy"
#: Distance from the unit circle at which a multiplier counts as on it: close to another one it
#: has errors of the square root of those of the matrix.
NEUTRAL = 1e-5


@dataclass(frozen=True, repr=False)
class PeriodicOrbit:
    """A periodic motion.

    Attributes
    ----------
    y : ndarray of shape (state,)
        Coordinates and velocities at t = 0.
    period : float
        In s.
    params : tuple of float
        All parameters.
    energy : float
        Energy in J at t = 0.
    monodromy : ndarray of shape (state, state)
        The transition matrix over the period.
    multipliers : ndarray of shape (state,)
        Floquet multipliers, the eigenvalues of the monodromy matrix, the largest first. A
        perturbation that grows has one outside the unit circle. A motion of a system without
        explicit time has the multiplier 1, twice if energy is conserved; these are exact, the
        others those of the perturbations that remain.
    defect : float
        Largest difference of the state after the period from `y`, without whole turns; of an orbit
        with a symmetry, of the components that are to vanish after half the period.
    symmetry : tuple of str
        Components of the state that vanish at t = 0 and after half the period, if these conditions
        determine the orbit.
    """

    y: Array
    period: float
    params: tuple[float, ...]
    energy: float
    monodromy: Array = field(repr=False)
    multipliers: NDArray[np.complex128]
    defect: float
    symmetry: tuple[str, ...] = ()

    @classmethod
    def of(cls, shooting: OrbitConditions, point: OrbitStart, shot: Shot) -> "PeriodicOrbit":
        """The orbit through a point."""
        others = np.linalg.eigvals(reduced(shooting, point, shot.monodromy))
        values = np.concatenate([others, np.ones(len(point.y) - len(others))])
        return cls(
            point.y,
            point.period,
            tuple(point.params.tolist()),
            shooting.energy(point),
            shot.monodromy,
            values[np.argsort(-np.round(np.abs(values), 8), kind="stable")].astype(complex),
            float(np.abs(shot.residual).max()),
            shooting.reversal.names if shooting.reversal else (),
        )

    @property
    def stability(self) -> str:
        """``asymptotically stable``, ``unstable``, or ``neutral``: linear terms do not decide.

        Motions near an orbit of a system without friction that is not unstable are neutral.
        """
        sizes = np.abs(self.multipliers)
        if sizes[0] > 1 + NEUTRAL:
            return "unstable"
        is_trivial = np.abs(self.multipliers - 1) == 0
        if is_trivial.sum() <= 1 and (sizes[~is_trivial] < 1 - NEUTRAL).all():
            return "asymptotically stable"
        return "neutral"

    def __repr__(self) -> str:
        return (
            f"PeriodicOrbit(y={self.y}, period={self.period} s, energy={self.energy} J, "
            f"{self.stability}, defect={self.defect:.1e})"
        )


def reduced(shooting: OrbitConditions, point: OrbitStart, monodromy: Array) -> Array:
    """The monodromy matrix for perturbations across the orbit that keep the energy.

    In an orthonormal basis of the direction of the motion, the remaining directions, and the
    gradient of a conserved energy, the matrix is block triangular; the first and the last block
    are 1.
    """
    if not shooting.nature.is_autonomous:
        return monodromy
    trivial = [shooting.rate(point)]
    if shooting.nature.is_conservative:
        trivial.append(shooting.unfolding(point))
    columns = [vector / max(float(np.linalg.norm(vector)), TINY) for vector in trivial]
    q = np.linalg.qr(np.column_stack([*columns, np.eye(len(point.y))]))[0]
    rest = q[:, len(columns) :]
    return np.asarray(rest.T @ monodromy @ rest)
