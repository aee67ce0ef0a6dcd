"""Newton's method for periodic orbits, damped where a step leads no closer to one."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from solvers.integration.orbits.orbit_shooting import TINY, OrbitConditions, OrbitStart, Shot
from solvers.runge_kutta.stepper import Array

#: Most motions that are integrated.
MAX_ITERATIONS = 60
#: Residuals below this may be limited by rounding errors of the motion; number of successive steps
#: that do not decrease them which ends the iteration.
SMALL, STALLS = 1e-6, 3
#: Length of the unfolding column: short, since it is used where nothing else helps.
SHARE = 1e-3
#: Damping, relative to the square of the residual: the least, and its changes after a step that
#: decreases the residual and after one that does not.
DAMPING, LESS, MORE = 1.0, 0.1, 1000.0
#: Longest period after a step, relative to that before.
LONGEST = 2.0


class NoPeriodicOrbitError(ArithmeticError):
    """Newton's method found no periodic motion near the guess."""


@dataclass(frozen=True)
class Iterate:
    """A point on the way to a periodic orbit, and its shot.

    Residuals are in units of `sizes`, one for each component of the state.
    """

    shooting: OrbitConditions
    point: OrbitStart
    shot: Shot
    sizes: Array

    @classmethod
    def at(cls, shooting: OrbitConditions, point: OrbitStart, sizes: Array) -> "Iterate":
        """The iterate at a point; its motion is integrated."""
        shot = shooting(point)
        return cls(replace(shooting, advance=shot.advance), point, shot, sizes)

    def moved(self, change: Array) -> "Iterate | None":
        """The iterate after a change; None where there is none, or the period is too long."""
        try:
            point = self.shooting.moved(self.point, change)
            if 0 < point.period < LONGEST * self.point.period:
                return Iterate.at(self.shooting, point, self.sizes)
        except (ArithmeticError, ValueError):  # the motion ends, or there is no such state
            pass
        return None

    @cached_property
    def residual(self) -> Array:
        """Changes in a period, and distances from the values of functions that are held."""
        return np.concatenate([self.shot.residual / self._units, self._held[0]])

    @cached_property
    def _held(self) -> tuple[Array, Array]:
        values, rows = self.shooting.held(self.point)
        units = np.linalg.norm(rows[:, : len(self.sizes)] * self.sizes, axis=1)
        return values / units, rows / units[:, np.newaxis]

    @cached_property
    def _units(self) -> Array:
        """The units of the residuals of the shot."""
        reversal = self.shooting.reversal
        return self.sizes if reversal is None else np.tile(self.sizes[reversal.changed], 2)

    @property
    def defect(self) -> float:
        """The largest residual."""
        return float(np.abs(self.residual).max())

    @cached_property
    def distance(self) -> float:
        """The residual relative to the path in a period, if equations do not depend on time.

        It decreases neither towards an equilibrium nor towards a period of 0, where the residual
        alone vanishes.
        """
        path = 1.0
        if self.shooting.nature.is_autonomous:
            rate = self.shooting.rate(self.point) / self.sizes
            path = float(np.linalg.norm(rate)) * self.point.period
        return float(np.linalg.norm(self.residual)) / max(path, TINY)

    def rows(self) -> Array:
        """Derivatives of the residual, less the part along which the path grows like it."""
        rows = np.concatenate([self.shot.rows / self._units[:, np.newaxis], self._held[1]])
        if self.shooting.nature.is_autonomous:
            rows -= np.outer(self.residual, self._path_growth())
        return rows

    def _path_growth(self) -> Array:
        """Derivatives of the logarithm of the path's length."""
        point, rate = self.point, self.shooting.rate(self.point) / self.sizes
        jacobian = self.shooting.module.jacobian(0.0, point.y.tolist(), point.params.tolist())
        along = (rate / self.sizes) @ np.array(jacobian) / max(float(rate @ rate), TINY)
        return np.array([*along, 1 / point.period, 0.0])


def solve(
    shooting: OrbitConditions,
    point: OrbitStart,
    fixed: Array,
    *,
    scales: Array | None = None,
    iterations: int | None = None,
    rcond: float | None = None,
    reach: float = np.inf,
) -> tuple[OrbitStart, Shot]:
    """The orbit that is nearest to a guess, and its shot.

    Each step is the shortest in units of `scales`, one for each column, that solves the linear
    equations, without those whose singular values, relative to the largest, are below `rcond`, and
    little of those whose singular values are small beside the residual; a step that does not
    decrease the residual relative to the path in a period is damped more (D. W. Marquardt, J. Soc.
    Indust. Appl. Math. 11 (1963) 431-441). Where equations depend on time, a residual of 0 is no
    equilibrium, and steps are not damped. Changes are orthogonal to the rows of `fixed`, of shape
    (conditions, state + 2). `NoPeriodicOrbitError` where the iteration does not converge within the
    distance `reach`. Residuals of components whose scales are above 1 are measured in these.
    """
    n, damping = len(point.y), DAMPING
    scales = np.ones(n + 2) if scales is None else scales
    sizes = np.maximum(scales[:n], 1.0)
    if shooting.reversal is not None:
        fixed = np.concatenate([fixed, np.eye(n, n + 2)[shooting.reversal.changed]])
    change, now, stalls = np.zeros(n + 2), Iterate.at(shooting, point, sizes), 0
    is_damped = shooting.nature.is_autonomous
    for _ in range(MAX_ITERATIONS if iterations is None else iterations):
        if now.defect <= shooting.atol or (now.defect < SMALL and stalls == STALLS):
            return now.point, now.shot
        step = _step(now, fixed, scales, damping if is_damped else 0.0, rcond)
        if np.linalg.norm(change + step) > reach:
            break
        new = now.moved(step * scales)
        if new and (new.distance < now.distance or (not is_damped and now.defect > SMALL)):
            now, change, damping, stalls = new, change + step, max(DAMPING, damping * LESS), 0
        else:
            stalls, damping = stalls + 1, damping * MORE
            if not is_damped:
                break
    else:
        stalls += 1  # rounding errors may still decrease a little
    if now.defect < SMALL and stalls:
        return now.point, now.shot
    at, way_out = "", "give a better guess"
    if shooting.energy_held is not None:
        at = f" with an energy of {shooting.energy_held} J"
    elif shooting.nature.is_conservative:
        way_out += ", or the energy"
    raise NoPeriodicOrbitError(
        f"the state{at} still changes, after the last iteration of Newton's method, by "
        f"{now.defect:.1e} in a period of {now.point.period} s: {way_out}"
    )


def _step(now: Iterate, fixed: Array, scales: Array, damping: float, rcond: float | None) -> Array:
    """The step of an iterate in units of `scales`."""
    shooting, free = now.shooting, now.shooting.unknowns(now.point)
    unfolding = None
    if shooting.reversal is None and shooting.nature.is_conservative:
        unfolding = shooting.unfolding(now.point) * now.sizes
        unfolding /= np.linalg.norm(unfolding)
    matrix = bordered(shooting, now.point, now.rows(), fixed[:0], scales, unfolding)
    conditions = np.zeros((len(fixed), matrix.shape[1]))
    conditions[:, : free.sum()] = fixed[:, free] * scales[free]
    directions = np.linalg.svd(conditions)[2][len(conditions) :].T
    left, sizes, right = np.linalg.svd(matrix @ directions, full_matrices=False)
    least = (np.finfo(float).eps * len(matrix) if rcond is None else rcond) * sizes[0]
    square = damping * float(now.residual @ now.residual)
    factors = np.where(sizes > least, sizes / (sizes**2 + square + TINY), 0.0)
    step = np.zeros(len(free))
    step[free] = (directions @ (right.T @ (factors * (left.T @ -now.residual))))[: free.sum()]
    return step


def bordered(
    shooting: OrbitConditions,
    point: OrbitStart,
    rows: Array,
    fixed: Array,
    scales: Array,
    unfolding: Array | None,
) -> Array:
    """Derivatives by the unknowns, in units of `scales`, above the rows of `fixed`.

    An unfolding follows as a last column, which affects the first rows.
    """
    free = shooting.unknowns(point)
    columns = np.concatenate([rows, fixed])[:, free] * scales[free]
    if unfolding is not None:
        last = np.zeros(len(columns))
        last[: len(point.y)] = SHARE * unfolding
        columns = np.column_stack([columns, last])
    return np.asarray(columns)
