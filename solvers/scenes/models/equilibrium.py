"""An equilibrium: the state stays."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from solvers.equations.module import GeneratedModule, depends_on_time
from solvers.integration.accuracy.checked_motion import (
    Array,
    Motion,
    OutsideDomainError,
    golden_points,
)
from solvers.scenes.models.model_catalogue import EPS, ROUNDINGS, ClosedForm

#: Safety factor for times between the samples.
MARGIN = 1.5
#: Terms of the exponential's series: (1/2)^15/15! is below rounding.
TERMS = 15
#: An error above this is not small at any accuracy.
LARGE = 1e3
#: Numbers of intervals in which equations that depend on time count as constant, and the relative
#: change of the error at which there are enough.
INTERVALS, CLOSE = (256, 512, 1024, 2048, 4096, 8192, 16384, 32768), 0.1
LEAVES = "the motion leaves the initial state"


@dataclass(frozen=True)
class Equilibrium(ClosedForm):
    """The initial state at all times.

    The defect d = y' of the constant state obeys e' = J e + d, J the Jacobian there; its solution
    is a part of one matrix exponential, or of one for each of many short intervals if the equations
    depend on time. As e grows, J changes: Gronwall's inequality bounds the growth that this adds.
    """

    name: ClassVar[str] = "rest"
    complexity: ClassVar[int] = 10
    applies_to: ClassVar[str] = "an equilibrium, or a state that hardly changes"
    error_source: ClassVar[str] = "rate of change, propagated by a matrix exponential"

    y0: tuple[float, ...]

    @classmethod
    def not_applicable(cls, module: GeneratedModule) -> str:
        return ""  # an equilibrium stays also without conserved energy

    @classmethod
    def of(cls, motion: Motion) -> Self:
        """The equilibrium, with the error that grows from the rate of change."""
        motion.require_inertia()
        propagated = _with_time if depends_on_time(motion.module) else _without_time
        times, error, jacobians, defects = propagated(motion)
        displaced = motion.module.jacobian_many(times, (motion.y0 + error).T, motion.params)
        differences = np.moveaxis(displaced, -1, 0) - jacobians
        change = float(np.linalg.norm(differences, 2, axis=(1, 2)).max()) * motion.duration
        growth = MARGIN * np.exp(min(change, 700))
        bound = growth * np.abs(error).max(axis=0) + ROUNDINGS * EPS * np.abs(motion.y0)
        estimate = float(bound[list(motion.requested)].max())
        if not estimate < LARGE:
            raise OutsideDomainError(LEAVES)
        why = f"rates of change of the initial state are at most {np.abs(defects).max():.1g}"
        return cls(motion.y0, error_estimate=estimate, why=why)

    def states(self, t: Array) -> Array:
        return np.tile(self.y0, (len(t), 1))


def _linearised(motion: Motion, times: Array) -> tuple[Array, Array]:
    """Jacobians and defects of the initial state at `times`."""
    states = np.tile(motion.y0, (len(times), 1))
    jacobians = np.moveaxis(motion.module.jacobian_many(times, states.T, motion.params), -1, 0)
    defects = np.asarray(motion.module.rhs_many(times, states.T, motion.params)).T
    # terms that cancel in the right-hand side are known to rounding only
    return jacobians, defects + np.copysign(EPS * np.abs(jacobians) @ np.abs(motion.y0), defects)


def _without_time(motion: Motion) -> tuple[Array, Array, Array, Array]:
    """Times, errors there, Jacobians and defects of equations that do not depend on time."""
    jacobian, defect = _linearised(motion, np.zeros(1))
    # the end alone shows most motions that leave the initial state
    for times in (motion.sample_times[-1:], motion.sample_times):
        error = _integrals(jacobian, defect, times)
        if not np.abs(error).max() < LARGE:
            raise OutsideDomainError(LEAVES)
    return times, error, jacobian, defect


def _with_time(motion: Motion) -> tuple[Array, Array, Array, Array]:
    """The same of equations that depend on time, as constant in each of many short intervals.

    Times are the middles of the intervals, which have no period in common with the equations, and
    errors those at their ends.
    """
    before = 0.0
    for count in INTERVALS:
        ends = motion.duration * np.array([*np.sort(golden_points(count)), 1.0])
        middles = (ends[1:] + ends[:-1]) / 2
        jacobians, defects = _linearised(motion, middles)
        matrices = _augmented(jacobians, defects) * np.diff(ends)[:, None, None]
        state = np.zeros(len(motion.y0) + 1)
        state[-1] = 1.0
        error = np.array([(state := matrix @ state)[:-1] for matrix in _exponentials(matrices)])
        largest = float(np.abs(error).max())
        if abs(largest - before) <= CLOSE * largest:
            return middles, error, jacobians, defects
        if not min(before, largest) < LARGE:
            raise OutsideDomainError(LEAVES)
        before = largest
    raise OutsideDomainError(f"the equations vary too much for {INTERVALS[-1]} intervals")


def _augmented(jacobians: Array, defects: Array) -> Array:
    """Matrices A of (e, 1)' = A (e, 1)."""
    return np.pad(np.dstack([jacobians, defects]), ((0, 0), (0, 1), (0, 0)))


def _integrals(jacobian: Array, defect: Array, times: Array) -> Array:
    """∫ exp(J s) d ds up to each of `times`, shape (n, state)."""
    with np.errstate(over="ignore", invalid="ignore"):
        exponents = _augmented(jacobian, defect) * times[:, None, None]
        return _exponentials(exponents)[:, :-1, -1]


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
