"""Continuation along a curve of periodic orbits, and its special points: roots of functions.

Yu. A. Kuznetsov, Elements of Applied Bifurcation Theory, 2004, section 10.2.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np
import scipy

from solvers.integration.orbits.orbit_newton import NoPeriodicOrbitError
from solvers.integration.orbits.solution_curve import CurveNode, SolutionCurve
from solvers.runge_kutta.stepper import Array

#: Largest distance from the unit circle of a pair of multipliers, and smallest imaginary part.
CRITICAL = 1e-6
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
    return node.curve.shooting.nature.is_conservative or difference < max(CRITICAL, ERROR * size**2)


def is_torus(node: CurveNode) -> bool:
    """Whether a pair of complex multipliers is on the unit circle."""
    values = np.linalg.eigvals(node.reduced)
    return bool(np.any((np.abs(np.abs(values) - 1) < CRITICAL) & (np.abs(values.imag) > CRITICAL)))


#: First step and shortest step, relative to the longest.
FIRST, SHORTEST = 0.1, 1e-5
#: Angles between successive tangents in rad: the largest; the largest with an estimate of the first
#: tangent; that which steps aim at.
LARGEST, LARGEST_ESTIMATE, INTENDED = 0.3, 1.0, 0.1
#: Distance, relative to the step, of nodes between which a special point or a bound is located; its
#: error, relative to the distance of the nodes, and the first one.
CLOSE, LOCATED, ROUGH = 0.02, 1e-12, 1e-3
#: Norm of a monodromy matrix beyond which rounding errors decide on multipliers.
UNSTABLE = 1e10
#: The end of a family that shrinks to an equilibrium.
EQUILIBRIUM = "equilibrium"
#: Distance from the start, relative to the step, at which a curve is closed.
CLOSED = 0.1


@dataclass(frozen=True)
class Limits:
    """Where a walk ends."""

    low: float
    high: float
    period: float
    orbits: int
    step: float


@dataclass
class Walk:
    """Nodes after the first, the special nodes before each by their kinds, and why they end."""

    nodes: list[CurveNode]
    special: list[list[tuple[str, CurveNode]]] = field(default_factory=list)
    end: str = ""


def walk(
    curve: SolutionCurve, first: CurveNode, limits: Limits, *, branches_off: bool = False
) -> Walk:
    """Follow a curve in the direction of the tangent of its first node.

    If it `branches_off` there from another one, its direction is an estimate, and the first node is
    not a special one of this curve.
    """
    result, node, step = Walk([]), first, FIRST * limits.step
    while len(result.nodes) < limits.orbits:
        is_estimate = branches_off and not result.nodes
        try:
            new = curve.after(node, step)
            angle = float(np.arccos(np.clip(node.tangent @ new.tangent, -1, 1)))
            if angle > (LARGEST_ESTIMATE if is_estimate else LARGEST):
                raise NoPeriodicOrbitError(f"the curve turns by {angle} rad in a step")
            if end := _last(node, new):
                if end == EQUILIBRIUM and not limits.low <= _at_rest(node, new) <= limits.high:
                    raise NoPeriodicOrbitError("a bound is between the orbit and the equilibrium")
                return replace(result, end=end)
            crossed = _crossed(new, limits)
            if crossed:
                new = _root(node, new, crossed[1])
            special = [] if is_estimate else _special(node, new)
        except (ArithmeticError, ValueError):  # also of a mass or length that is not positive
            step /= 2
            if step < SHORTEST * limits.step:
                return replace(result, end="no orbit in the shortest step")
            continue
        is_closed = len(result.nodes) > 2 and _passes(node, new, first)
        result.nodes.append(new)
        result.special.append(special)
        if crossed or is_closed:
            return replace(result, end=crossed[0] if crossed else "closed")
        node, step = new, min(limits.step, step * np.clip(INTENDED / max(angle, 1e-9), 0.5, 2.0))
    return replace(result, end="number of orbits")


def _last(node: CurveNode, new: CurveNode) -> str:
    """The reason why a node is the last one: the next has no meaning; empty if it has."""
    shooting = node.curve.shooting
    rates = [shooting.rate(n.point) for n in (node, new)]
    if shooting.nature.is_autonomous and float(rates[0] @ rates[1]) < 0:
        return EQUILIBRIUM  # the same orbits follow
    if np.linalg.norm(new.shot.monodromy) > UNSTABLE:
        return f"perturbations grow by more than {UNSTABLE:.0e} in a period"
    return ""


def _at_rest(node: CurveNode, new: CurveNode) -> float:
    """The value at an equilibrium between two nodes, where it is extreme along the curve."""
    rates = [np.linalg.norm(n.curve.shooting.rate(n.point)) for n in (node, new)]
    distance = float(new.difference(node) @ node.tangent) * rates[0] / sum(rates)
    return float(node.value + node.rate_of_value * distance / 2)


def _crossed(new: CurveNode, limits: Limits) -> tuple[str, Callable[[CurveNode], float]] | None:
    """The limit that the new node is beyond, and a function that is 0 there."""
    if not limits.low <= new.value <= limits.high:
        bound = limits.low if new.value < limits.low else limits.high
        return "bound", lambda node: node.value - bound
    if new.point.period > limits.period:
        return "longest period", lambda node: node.point.period - limits.period
    return None


def _passes(node: CurveNode, new: CurveNode, first: CurveNode) -> bool:
    """Whether a step passes the start of the curve."""
    chord, offset = new.difference(node), first.difference(node)
    share = float(offset @ chord / (chord @ chord))
    distance = float(np.linalg.norm(offset - share * chord))
    return 0 <= share <= 1 and distance < CLOSED * float(np.linalg.norm(chord))


def _special(node: CurveNode, new: CurveNode) -> list[tuple[str, CurveNode]]:
    """The special nodes in a step, by their kinds."""
    result = []
    for kind, function in FUNCTIONS.items():
        is_neimark = kind == "Neimark-Sacker"
        if is_neimark and keeps_volume(node) and keeps_volume(new):
            continue
        if function(node) * function(new) < 0:
            there = _root(node, new, function)
            if not is_neimark or is_torus(there):
                result.append((float(there.difference(node) @ node.tangent), kind, there))
    return [(kind, there) for _, kind, there in sorted(result, key=lambda entry: entry[0])]


def _root(node: CurveNode, new: CurveNode, function: Callable[[CurveNode], float]) -> CurveNode:
    """The node between two others at which a function is 0.

    It is located again between nodes close to it, from which it is predicted more accurately.
    """
    distance, length = _between(node, new, function, ROUGH)
    near = [max(0.0, distance - CLOSE * length), min(length, distance + CLOSE * length)]
    inner = [node.curve.between(node, new, s, None) for s in near]
    if function(inner[0]) * function(inner[1]) < 0:
        node, new = inner
    return node.curve.between(node, new, _between(node, new, function, LOCATED)[0])


def _between(
    node: CurveNode, new: CurveNode, function: Callable[[CurveNode], float], accuracy: float
) -> tuple[float, float]:
    """Distance from a node, along its tangent, where a function is 0, and that of the next node."""
    length = float(new.difference(node) @ node.tangent)
    known = {0.0: node, length: new}

    def value(distance: float) -> float:
        return function(known.get(distance) or node.curve.between(node, new, distance))

    return float(scipy.optimize.brentq(value, 0.0, length, xtol=accuracy * length)), length
