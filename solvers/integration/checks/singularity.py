"""Motions that fail where their coordinates are singular, as an orientation at gimbal lock."""

from collections.abc import Sequence

import numpy as np

from solvers.equations.module import GeneratedModule, has_function
from solvers.equations.singularities import inertia
from solvers.integration.problem.problem import Problem
from solvers.integration.problem.status import Status
from solvers.integration.results.ensemble_solution import Ensemble
from solvers.runge_kutta.stepper import Array

#: A time and an ordinary state.
State = tuple[float, Sequence[float] | Array]
#: The condition from which on a motion that fails does so where coordinates are singular.
SINGULAR = 1e8
#: Displacement of a coordinate that shows on which one the singularity depends.
DISPLACEMENT = 0.01
#: Share of a coordinate in the motion without inertia that counts.
SHARE = 0.1


def singular_coordinates(
    module: GeneratedModule,
    params: Sequence[float],
    start: State,
    end: State,
) -> str:
    """A description of the singularity at which a motion failed; empty if there is none there.

    Some velocities have no inertia at the end, but have some at the start. A motion that fails for
    another reason has such an end by chance only.
    """
    if not has_function(module, "mass_matrix"):
        return ""
    t, y = end[0], np.array(end[1][: len(module.STATE)], dtype=float)
    begin = np.array(start[1][: len(module.STATE)], dtype=float)
    try:
        sizes = np.sqrt(np.abs(np.diag(inertia(module, start[0], begin.tolist(), params))))
        sizes[sizes == 0] = 1.0
        before, _ = _weakest(module, start[0], begin, params, sizes)
        least, motion = _weakest(module, t, y, params, sizes)
        names = module.COORDINATES
        others = [
            max(_weakest(module, t, y + step * one, params, sizes)[0]
                for step in (-DISPLACEMENT, DISPLACEMENT))
            for one in np.eye(len(y))[: len(names)]
        ]  # fmt: skip
    except (ArithmeticError, ValueError, np.linalg.LinAlgError):
        return ""
    if not least * SINGULAR < before:
        return ""
    cause = int(np.argmax(others))
    moving = " and ".join(name for name, x in zip(names, motion, strict=True) if abs(x) > SHARE)
    place = f"{names[cause]} = {y[cause]:.6g} {module.UNITS[names[cause]]}, t = {t:.6g} s"
    if has_function(module, "angular_momentum"):  # of bodies in space
        return (
            f"gimbal lock at {place}: there {moving} turn a body about the same axis; give the "
            "orientation by a quaternion, or by a sequence of rotations without such a state on "
            "the way"
        )
    return (
        f"coordinates are singular at {place}: there changes of {moving} move no mass, as at the "
        "pole of a sphere; use other coordinates, such as Cartesian ones with a constraint"
    )


def _weakest(
    module: GeneratedModule, t: float, y: Array, params: Sequence[float], sizes: Array
) -> tuple[float, Array]:
    """The least of the relative inertias, and the velocities that have it."""
    matrix = inertia(module, t, y.tolist(), params) / np.outer(sizes, sizes)
    if not np.isfinite(matrix).all():
        raise FloatingPointError
    values, vectors = np.linalg.eigh(matrix)
    return max(float(values[0]), 0.0) / (float(values[-1]) or 1.0), vectors[:, 0]


#: Ends of motions that run into a singularity.
FAILURES = (Status.NOT_FINITE, Status.STEP_TOO_SMALL, Status.STEP_LIMIT, Status.NO_CONVERGENCE)


class SingularityWarning(UserWarning):
    """Motions of an ensemble end where their coordinates are singular."""


def singularity(problem: Problem, status: Status | None, end: State) -> str:
    """A description of the singular coordinates at which a run ended; empty elsewhere."""
    if status not in FAILURES:
        return ""
    form, start = problem.form, (problem.span[0], problem.start)
    return singular_coordinates(form.module, form.constants, start, end)


def singularities(problem: Problem, states: Array, params: Array, result: Ensemble) -> str:
    """A description of the first motion, by rows of states and parameters, that ended so."""
    failed = np.logical_or.reduce([result.status == status for status in FAILURES])
    for k in np.flatnonzero(failed).tolist():
        end = float(result.t[k]), result.y[:, k]
        if detail := singularity(problem.motion(k, states, params), result.status[k], end):
            return f"{np.sum(failed)} of {len(states)} motions failed; of motion {k}: {detail}"
    return ""
