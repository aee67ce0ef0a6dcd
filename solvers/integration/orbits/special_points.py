"""Special points of a curve of periodic orbits: roots of functions of an orbit.

Yu. A. Kuznetsov, Elements of Applied Bifurcation Theory, 2004, section 10.2.
"""

from collections.abc import Callable
from dataclasses import replace
from itertools import combinations

import numpy as np

from solvers.integration.orbits.solution_curve import CurveNode
from solvers.runge_kutta.stepper import Array

#: Largest distance from the unit circle of a pair of multipliers, and smallest imaginary part.
CLOSE = 1e-6
#: Relative error of products of multipliers.
ERROR = 1e-10


def turning_point(node: CurveNode) -> float:
    """The derivative of the parameter, or of the energy, along the curve."""
    return node.rate_of_value


def branch_point(node: CurveNode) -> float:
    """The determinant of the equations over a period and a vector near the tangent."""
    curve, free = node.curve, node.curve.shooting.unknowns(node.point)
    equations = curve.equations(node.point, node.shot.change, half=False)
    row = np.zeros(equations.shape[1])
    row[: free.sum()] = node.reference[free]
    return float(np.linalg.det(np.vstack([equations, row])))


def crossing_direction(node: CurveNode) -> Array:
    """The direction of the family that crosses at a branch point, if symmetry breaks there.

    The parameter, or the energy, is then extreme on that family.
    """
    curve, free = node.curve, node.curve.shooting.unknowns(node.point)
    equations = curve.equations(node.point, node.shot.change, half=False)
    null = np.zeros((2, len(free)))
    null[:, free] = np.linalg.svd(equations)[2][-2:, : free.sum()]
    a, b = (replace(node, tangent=vector).rate_of_value for vector in null)
    direction = (b * null[0] - a * null[1]) * curve.scales
    return np.asarray(direction / np.linalg.norm(direction))


def doubling_direction(node: CurveNode) -> Array:
    """The perturbation with the multiplier -1, along which a family of twice the period starts."""
    n = len(node.point.y)
    values, vectors = np.linalg.eig(node.shot.monodromy)
    direction = np.zeros(n + 2)
    direction[:n] = vectors[:, np.argmin(np.abs(values + 1))].real
    return direction


def period_doubling(node: CurveNode) -> float:
    """The determinant of the monodromy matrix plus 1."""
    return float(np.linalg.det(node.reduced + np.eye(len(node.reduced))))


def neimark_sacker(node: CurveNode) -> float:
    """The product, over all pairs of multipliers, of their product minus 1."""
    pairs = combinations(np.linalg.eigvals(node.reduced), 2)
    return float(np.prod([a * b - 1 for a, b in pairs]).real)


#: Functions that change their sign at special points, by their kinds.
FUNCTIONS: dict[str, Callable[[CurveNode], float]] = {
    "turning point": turning_point,
    "branch point": branch_point,
    "period doubling": period_doubling,
    "Neimark-Sacker": neimark_sacker,
}


def keeps_volume(node: CurveNode) -> bool:
    """Whether pairs of multipliers stay on the unit circle until they meet: without friction."""
    size = float(np.linalg.norm(node.reduced))
    difference = abs(np.linalg.det(node.reduced) - 1)
    return node.curve.shooting.nature.is_conservative or difference < max(CLOSE, ERROR * size**2)


def is_torus(node: CurveNode) -> bool:
    """Whether a pair of complex multipliers is on the unit circle."""
    values = np.linalg.eigvals(node.reduced)
    return bool(np.any((np.abs(np.abs(values) - 1) < CLOSE) & (np.abs(values.imag) > CLOSE)))
