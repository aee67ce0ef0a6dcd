"""Rest: an equilibrium stays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from solvers.scenes.models.model import EPS, ROUNDINGS, Array, Motion, OutsideDomainError

#: What may be missed between the times that are looked at.
MARGIN = 1.5
#: Beyond this the error is no small one, whatever is asked.
LARGE = 1e3


@dataclass(frozen=True)
class Rest:
    """The state does not change."""

    y0: tuple[float, ...]
    error_estimate: float
    why: str
    name: str = "rest"

    def states(self, t: Array) -> Array:
        """The initial state at all times."""
        return np.tile(self.y0, (len(t), 1))


def rest(asked: Motion) -> Rest:
    """Rest, with the error that grows from what accelerates the system nevertheless.

    The defect d = y' of the state that stays obeys e' = J e + d, J the Jacobian there;
    its solution is a part of one matrix exponential. As e grows, J changes: Gronwall's
    inequality bounds what that adds.

    Parameters
    ----------
    asked : Motion
        The motion.

    Returns
    -------
    Rest

    Raises
    ------
    OutsideDomainError
        When the system moves, or a coordinate moves no mass.
    """
    asked.require_mass()
    if any(asked.y0[asked.coordinates :]):
        raise OutsideDomainError("it moves at the beginning")
    jacobian = np.array(asked.module.jacobian(0.0, asked.y0, asked.params))
    defect = np.array(asked.module.rhs(0.0, asked.y0, asked.params))
    # what cancels in the right-hand side is known to rounding only
    defect += np.copysign(EPS * np.abs(jacobian) @ np.abs(asked.y0), defect)
    error = _propagated(jacobian, defect, asked.looks)
    largest = np.abs(error).max(axis=0)
    if not largest.max() < LARGE:
        raise OutsideDomainError("it moves away from there")
    moved = asked.module.jacobian_many(0.0, (asked.y0 + error).T, asked.params)
    changes = np.linalg.norm(np.moveaxis(moved, -1, 0) - jacobian, 2, axis=(1, 2))
    change = float(changes.max()) * asked.duration
    grown = MARGIN * np.exp(min(change, 700)) * largest + ROUNDINGS * EPS * np.abs(asked.y0)
    estimate = float(grown[list(asked.wanted)].max())
    if not estimate < LARGE:
        raise OutsideDomainError("it moves away from there")
    return Rest(asked.y0, estimate, f"accelerations are at most {np.abs(defect).max():.1g} there")


def _propagated(jacobian: Array, defect: Array, times: Array) -> Array:
    """∫ exp(J s) d ds up to each of `times`, shape (n, state)."""
    n = len(defect)
    augmented = np.zeros((n + 1, n + 1))
    augmented[:n, :n], augmented[:n, n] = jacobian, defect
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(expm(augmented * times[:, None, None]))[:, :n, n]
