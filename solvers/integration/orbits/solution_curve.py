"""A curve of periodic orbits: tangents, and the orbit at a distance along one."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solvers.integration.orbits.orbit_newton import bordered, solve
from solvers.integration.orbits.orbit_shooting import OrbitConditions, OrbitStart, Shot
from solvers.integration.orbits.periodic_orbit import PeriodicOrbit, reduced
from solvers.runge_kutta.stepper import Array

#: Most iterations of Newton's method from a prediction, and the largest distance from it, relative
#: to the step.
ITERATIONS, FARTHEST = 8, 0.5
#: Singular values, relative to the largest, of equations that are singular at a branch point.
SINGULAR = 1e-6
#: Smallest singular value of the equations, relative to the largest, where the curve is unique.
UNIQUE = 1e-10


@dataclass(frozen=True)
class SolutionCurve:
    """Solutions of the conditions `shooting`; all columns are in units of `scales`."""

    shooting: OrbitConditions
    scales: Array

    def equations(self, point: OrbitStart, rows: Array, *, half: bool) -> Array:
        """Derivatives of the equations by the unknowns, and that of the phase.

        The tangent of the curve is orthogonal to all rows. With `half`, `rows` are those of a
        symmetric orbit, whose symmetry determines the phase.
        """
        unfolds = not half and self.shooting.nature.is_conservative
        unfolding = self.shooting.unfolding(point) if unfolds else None
        phase = self.phase(point)[: 0 if half else 1]
        return bordered(self.shooting, point, rows, phase, self.scales, unfolding)

    def phase(self, point: OrbitStart) -> Array:
        """A row: changes orthogonal to it do not shift the start along the orbit."""
        n = len(point.y)
        row = np.zeros((1, n + 2))
        if not self.shooting.nature.is_autonomous:
            return row[:0]
        row[0, :n] = self.shooting.rate(point) / self.scales[:n]
        return np.asarray(row / np.linalg.norm(row) / self.scales)

    def node(self, point: OrbitStart, shot: Shot, before: Array) -> "CurveNode":
        """The node at an orbit, with the tangent whose angle with `before` is less than 90°."""
        shooting = self.shooting
        matrix = self.equations(point, shot.rows, half=shooting.reversal is not None)
        free, (_, sizes, rows) = shooting.unknowns(point), np.linalg.svd(matrix)
        tangent = np.zeros(len(free))
        tangent[free] = rows[-1][: free.sum()]
        tangent *= np.sign(tangent @ before or 1.0) / np.linalg.norm(tangent)
        reference = before if before.any() else tangent
        return CurveNode(self, point, shot, tangent, reference, float(sizes[-1] / sizes[0]))

    def after(self, node: "CurveNode", distance: float) -> "CurveNode":
        """The orbit at a distance along the tangent of `node`; `ArithmeticError` without one."""
        return self._near(node, distance * node.tangent, None)

    def between(
        self, node: "CurveNode", end: "CurveNode", distance: float, rcond: float | None = SINGULAR
    ) -> "CurveNode":
        """The orbit at a distance along the tangent of `node`, which is less than that of `end`.

        The guess is a cubic; so equations with singular values below `rcond`, as at branch points,
        need not be solved.
        """
        chord = end.difference(node)
        length = float(chord @ node.tangent)
        s, slope = distance / length, end.tangent * length / float(end.tangent @ node.tangent)
        start = node.tangent * length
        guess = (
            s * start + s**2 * (3 * chord - 2 * start - slope) + s**3 * (start + slope - 2 * chord)
        )
        return self._near(node, guess, rcond)

    def _near(self, node: "CurveNode", change: Array, rcond: float | None) -> "CurveNode":
        guess = self.shooting.moved(node.point, change * self.scales)
        phase = self.phase(node.point)[: 0 if self.shooting.reversal else 1]
        fixed = np.concatenate([phase, [node.tangent / self.scales]])
        point, shot = solve(
            self.shooting,
            guess,
            fixed,
            scales=self.scales,
            iterations=ITERATIONS,
            rcond=rcond,
            reach=FARTHEST * float(np.linalg.norm(change)),
        )
        return self.node(point, shot, node.tangent)


@dataclass(frozen=True)
class CurveNode:
    """An orbit of a curve.

    Attributes
    ----------
    tangent : ndarray of shape (state + 2,)
        The tangent of unit length, which is not unique at branch points.
    reference : ndarray of shape (state + 2,)
        A vector, such as the tangent nearby, whose angle with the tangent is less than 90°.
    uniqueness : float
        Smallest singular value of the equations over the largest: 0 at branch points.
    """

    curve: SolutionCurve
    point: OrbitStart
    shot: Shot
    tangent: Array
    reference: Array
    uniqueness: float

    def difference(self, other: "CurveNode") -> Array:
        """The distance from another node in units of the curve's scales."""
        a, b, parameter = self.point, other.point, self.curve.shooting.parameter
        change = 0.0 if parameter is None else a.params[parameter] - b.params[parameter]
        return np.array([*(a.y - b.y), a.period - b.period, change]) / self.curve.scales

    @property
    def orbit(self) -> PeriodicOrbit:
        """The orbit, with its multipliers."""
        return PeriodicOrbit.of(self.curve.shooting, self.point, self.shot)

    @property
    def value(self) -> float:
        """The parameter, or the energy."""
        parameter = self.curve.shooting.parameter
        if parameter is not None:
            return float(self.point.params[parameter])
        return self.curve.shooting.energy(self.point)

    @property
    def rate_of_value(self) -> float:
        """Its derivative along the curve."""
        change, shooting = self.tangent * self.curve.scales, self.curve.shooting
        if shooting.parameter is not None:
            return float(change[-1])
        return float(shooting.energy_gradient(self.point) @ change[: len(self.point.y)])

    @cached_property
    def reduced(self) -> Array:
        """The monodromy matrix without the multipliers that are always 1."""
        return reduced(self.curve.shooting, self.point, self.shot.monodromy)
