"""An equilibrium: the state stays."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from solvers.equations.module import GeneratedModule, depends_on_time
from solvers.scenes.models.model import EPS, ROUNDINGS, ClosedForm
from solvers.scenes.models.motion import Array, Motion, OutsideDomainError

#: Safety factor for times between the samples.
MARGIN = 1.5
#: Terms of the exponential's series: (1/2)^15/15! is below rounding.
TERMS = 15
#: An error above this is not small at any accuracy.
LARGE = 1e3


@dataclass(frozen=True)
class Equilibrium(ClosedForm):
    """The initial state at all times.

    The defect d = y' of the constant state obeys e' = J e + d, J the Jacobian there; its solution
    is a part of one matrix exponential. As e grows, J changes: Gronwall's inequality bounds the
    growth that this adds.
    """

    name: ClassVar[str] = "rest"
    complexity: ClassVar[int] = 10
    applies_to: ClassVar[str] = "an equilibrium"
    error_source: ClassVar[str] = "residual acceleration, propagated by a matrix exponential"

    y0: tuple[float, ...]

    @classmethod
    def not_applicable(cls, module: GeneratedModule) -> str:
        # an equilibrium stays also without conserved energy
        return "the equations depend on time" if depends_on_time(module) else ""

    @classmethod
    def of(cls, motion: Motion) -> Self:
        """The equilibrium, with the error that grows from the residual acceleration."""
        motion.require_inertia()
        if any(motion.y0[motion.n_coordinates :]):
            raise OutsideDomainError("the initial velocity is not zero")
        jacobian = np.array(motion.module.jacobian(0.0, motion.y0, motion.params))
        defect = np.array(motion.module.rhs(0.0, motion.y0, motion.params))
        # terms that cancel in the right-hand side are known to rounding only
        defect += np.copysign(EPS * np.abs(jacobian) @ np.abs(motion.y0), defect)
        # the end alone shows most motions that leave the initial state
        end = _propagated(jacobian, defect, motion.sample_times[-1:])
        if not np.abs(end).max() < LARGE:
            raise OutsideDomainError("the motion leaves the initial state")
        error = _propagated(jacobian, defect, motion.sample_times)
        largest = np.abs(error).max(axis=0)
        if not largest.max() < LARGE:
            raise OutsideDomainError("the motion leaves the initial state")
        displaced = motion.module.jacobian_many(0.0, (motion.y0 + error).T, motion.params)
        changes = np.linalg.norm(np.moveaxis(displaced, -1, 0) - jacobian, 2, axis=(1, 2))
        change = float(changes.max()) * motion.duration
        bound = MARGIN * np.exp(min(change, 700)) * largest + ROUNDINGS * EPS * np.abs(motion.y0)
        estimate = float(bound[list(motion.requested)].max())
        if not estimate < LARGE:
            raise OutsideDomainError("the motion leaves the initial state")
        why = f"initial accelerations are at most {np.abs(defect).max():.1g}"
        return cls(motion.y0, error_estimate=estimate, why=why)

    def states(self, t: Array) -> Array:
        return np.tile(self.y0, (len(t), 1))


def _propagated(jacobian: Array, defect: Array, times: Array) -> Array:
    """∫ exp(J s) d ds up to each of `times`, shape (n, state)."""
    n = len(defect)
    augmented = np.zeros((n + 1, n + 1))
    augmented[:n, :n], augmented[:n, n] = jacobian, defect
    with np.errstate(over="ignore", invalid="ignore"):
        return _exponentials(augmented * times[:, None, None])[:, :n, n]


def _exponentials(matrices: Array) -> Array:
    """Exponentials of matrices of shape (samples, n, n).

    By the Taylor series of parts of norm ½ at most, which are squared; the relative error is some
    roundings times the norm of the exponent. SciPy's function would load a part of SciPy that takes
    longer than a run.
    """
    norm = float(np.abs(matrices).sum(axis=-1).max())
    if not np.isfinite(norm):
        return np.full_like(matrices, np.inf)
    squarings = max(0, int(np.frexp(norm)[1]) + 1)
    part = matrices / 2.0**squarings
    result = term = np.broadcast_to(np.eye(matrices.shape[-1]), matrices.shape)
    for order in range(1, TERMS + 1):
        term = term @ part / order
        result = result + term
    for _ in range(squarings):
        result = result @ result
    return result
