"""Steps along a curve of periodic orbits, from its start to one of its ends."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq

from solvers.integration.orbits.curve import Curve, Node
from solvers.integration.orbits.special_points import FUNCTIONS, is_torus

#: First step and shortest step, relative to the longest.
FIRST, SHORTEST = 0.1, 1e-5
#: Angles between successive tangents in rad: the largest, and that which steps aim at.
LARGEST, INTENDED = 0.3, 0.1
#: Error of the distance at which a special point or a bound is located.
LOCATED = 1e-15
#: Norm of a monodromy matrix beyond which rounding errors decide on multipliers.
UNSTABLE = 1e10
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

    nodes: list[Node]
    special: list[list[tuple[str, Node]]] = field(default_factory=list)
    end: str = ""


def walk(curve: Curve, first: Node, limits: Limits) -> Walk:
    """Follow a curve in the direction of the tangent of its first node."""
    result, node, step = Walk([]), first, FIRST * limits.step
    while len(result.nodes) < limits.orbits:
        try:
            new = curve.after(node, step)
            angle = float(np.arccos(np.clip(node.tangent @ new.tangent, -1, 1)))
        except (ArithmeticError, np.linalg.LinAlgError):
            angle = np.pi
        if angle > LARGEST:
            step /= 2
            if step < SHORTEST * limits.step:
                result.end = "no orbit in the shortest step"
                return result
            continue
        if _reverses(node, new):
            result.end = "equilibrium"
            return result
        if np.linalg.norm(new.shot.monodromy) > UNSTABLE:
            result.end = f"perturbations grow by more than {UNSTABLE:.0e} in a period"
            return result
        if crossed := _crossed(new, limits):
            result.end, function = crossed
            new = _root(node, new, function)
        is_closed = len(result.nodes) > 2 and _passes(node, new, first)
        result.nodes.append(new)
        result.special.append(_special(node, new))
        if is_closed:
            result.end = "closed"
        if result.end:
            return result
        node, step = new, min(limits.step, step * np.clip(INTENDED / max(angle, 1e-9), 0.5, 2.0))
    result.end = "number of orbits"
    return result


def _reverses(node: Node, new: Node) -> bool:
    """Whether the curve passed an equilibrium, beyond which the same orbits follow."""
    shooting = node.curve.shooting
    rates = [shooting.rate(n.point) for n in (node, new)]
    return shooting.nature.is_autonomous and float(rates[0] @ rates[1]) < 0


def _crossed(new: Node, limits: Limits) -> tuple[str, Callable[[Node], float]] | None:
    """The limit that the new node is beyond, and a function that is 0 there."""
    if not limits.low <= new.value <= limits.high:
        bound = limits.low if new.value < limits.low else limits.high
        return "bound", lambda node: node.value - bound
    if new.point.period > limits.period:
        return "longest period", lambda node: node.point.period - limits.period
    return None


def _passes(node: Node, new: Node, first: Node) -> bool:
    """Whether a step passes the start of the curve."""
    chord, offset = new.difference(node), first.difference(node)
    share = float(offset @ chord / (chord @ chord))
    distance = float(np.linalg.norm(offset - share * chord))
    return 0 <= share <= 1 and distance < CLOSED * float(np.linalg.norm(chord))


def _special(node: Node, new: Node) -> list[tuple[str, Node]]:
    """The special nodes in a step, by their kinds."""
    found = []
    for kind, function in FUNCTIONS.items():
        if function(node) * function(new) < 0:
            there = _root(node, new, function)
            if kind != "Neimark-Sacker" or is_torus(there):
                found.append((float(there.difference(node) @ node.tangent), kind, there))
    return [(kind, there) for _, kind, there in sorted(found, key=lambda entry: entry[0])]


def _root(node: Node, new: Node, function: Callable[[Node], float]) -> Node:
    """The node between two others at which a function is 0."""
    length = float(new.difference(node) @ node.tangent)
    known = {0.0: node, length: new}

    def at(distance: float) -> Node:
        return known.get(distance) or node.curve.between(node, new, distance)

    return at(brentq(lambda s: function(at(s)), 0.0, length, xtol=LOCATED, rtol=1e-15))
