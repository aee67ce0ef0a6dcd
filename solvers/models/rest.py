"""Rest: an equilibrium stays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from solvers.models.model import EPS, LOOKS, ROUNDINGS, Array, Asked, OutsideDomainError

#: What rounding adds to an estimate that is otherwise exact.
MARGIN = 1.01
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


def rest(asked: Asked) -> Rest:
    """Rest, with the error that grows from what accelerates the system nevertheless.

    The defect d = y' of the state that stays obeys e' = J e + d, J the Jacobian there;
    its solution is a part of one matrix exponential. As e grows, J changes: Gronwall's
    inequality bounds what that adds.

    Raises
    ------
    OutsideDomainError
        When the system moves.
    """
    asked.require_mass()
    if any(asked.y0[asked.coordinates :]):
        raise OutsideDomainError("it moves at the beginning")
    jacobian = np.array(asked.module.jacobian(0.0, asked.y0, asked.params))
    defect = np.array(asked.module.rhs(0.0, asked.y0, asked.params))
    # what cancels in the right-hand side is known to rounding only
    defect += np.copysign(EPS * np.abs(jacobian) @ np.abs(asked.y0), defect)
    error = _propagated(jacobian, defect, asked.duration)
    largest = np.abs(error).max(axis=0)
    if not largest.max() < LARGE:
        raise OutsideDomainError("it moves away from there")
    size = np.linalg.norm(largest)
    moved = np.array(asked.module.jacobian(0.0, asked.y0 + error[-1], asked.params))
    change = np.linalg.norm(moved - jacobian, 2) * asked.duration if size else 0.0
    grown = MARGIN * np.exp(min(change, 700)) * largest + ROUNDINGS * EPS * np.abs(asked.y0)
    estimate = float(grown[list(asked.wanted)].max())
    if not estimate < LARGE:
        raise OutsideDomainError("it moves away from there")
    return Rest(asked.y0, estimate, f"accelerations are at most {np.abs(defect).max():.1g} there")


def _propagated(jacobian: Array, defect: Array, duration: float) -> Array:
    """∫ exp(J s) d ds up to `LOOKS` times, shape (looks, state)."""
    n = len(defect)
    augmented = np.zeros((n + 1, n + 1))
    augmented[:n, :n], augmented[:n, n] = jacobian, defect
    step = expm(augmented * duration / LOOKS)
    column, found = np.eye(n + 1)[n], []
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(LOOKS):
            column = step @ column
            found.append(column[:n])
    return np.array(found)
