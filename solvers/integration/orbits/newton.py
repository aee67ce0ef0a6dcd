"""Newton's method for periodic orbits."""

from dataclasses import replace

import numpy as np

from solvers.integration.orbits.shooting import Point, Shooting, Shot
from solvers.integration.solution import Array

#: Most iterations.
MAX_ITERATIONS = 30
#: Residuals below this may stagnate because of rounding errors of the motion; decrease of a
#: residual by Newton's method that is not limited by them.
SMALL, DECREASE = 1e-6, 0.5
#: Length of the unfolding column: short, since it is used where nothing else helps.
SHARE = 1e-3


class NoPeriodicOrbitError(ArithmeticError):
    """Newton's method found no periodic motion near the guess."""


def solve(
    shooting: Shooting,
    point: Point,
    fixed: Array | None = None,
    *,
    scales: Array | None = None,
    iterations: int | None = None,
    rcond: float | None = None,
    reach: float = np.inf,
) -> tuple[Point, Shot]:
    """The orbit that is nearest to a guess, and its shot.

    Each step is the shortest in units of `scales`, one for each column, that solves the linear
    equations, without those whose singular values, relative to the largest, are below `rcond`.
    Changes are orthogonal to the rows of `fixed`, of shape (conditions, state + 2).
    `NoPeriodicOrbitError` where the iteration does not converge within the distance `reach`.
    """
    n, before = len(point.y), np.inf
    scales = np.ones(n + 2) if scales is None else scales
    fixed = np.empty((0, n + 2)) if fixed is None else fixed
    free, change = shooting.unknowns(point), np.zeros(n + 2)
    for _ in range(MAX_ITERATIONS if iterations is None else iterations):
        shot = shooting(point)
        shooting = replace(shooting, advance=shot.advance)
        defect = float(np.abs(shot.residual).max())
        if defect <= shooting.atol or DECREASE * before <= defect < SMALL:
            return point, shot
        unfolds = shooting.reversal is None and shooting.nature.is_conservative
        matrix = bordered(shooting, point, shot.rows, fixed, scales, unfolds=unfolds)
        target = np.concatenate([-shot.residual, np.zeros(len(fixed))])
        step = np.zeros(n + 2)
        step[free] = np.linalg.lstsq(matrix, target, rcond)[0][: free.sum()]
        point, before = shooting.moved(point, step * scales), defect
        change += step
        if not 0 < point.period < np.inf or np.linalg.norm(change) > reach:
            break
    raise NoPeriodicOrbitError(
        "the state still changes, after the last iteration of Newton's method, by "
        f"{defect:.1e} in a period of {point.period} s: give a better guess"
    )


def bordered(
    shooting: Shooting, point: Point, rows: Array, fixed: Array, scales: Array, *, unfolds: bool
) -> Array:
    """Derivatives by the unknowns, in units of `scales`, above the rows of `fixed`.

    With `unfolds`, the unfolding follows as a last column.
    """
    free = shooting.unknowns(point)
    columns = np.concatenate([rows, fixed])[:, free] * scales[free]
    if unfolds:
        unfolding = np.concatenate([SHARE * shooting.unfolding(point), np.zeros(len(fixed))])
        columns = np.column_stack([columns, unfolding])
    return np.asarray(columns)
