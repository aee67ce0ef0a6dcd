"""A system with friction, forces that are chosen by place, and links of many kinds."""

import sympy as sp

from derive import (
    Block,
    Coordinate,
    Parameter,
    Plate,
    PointMass,
    Rail,
    Rod,
    Spring,
    System,
    Thread,
    Wheel,
    velocity,
)

x, P, F, V = sp.symbols("x P F V", real=True)


def block() -> System:
    """A block with friction on a belt, a force that is chosen by its place, and a spring."""
    push = sp.Piecewise((P, x < V), (P * sp.exp(-x), True))
    units = {P: "N", F: "N", V: "m/s"}
    return System("block", "Block on a belt", [Coordinate(x, "m", "position")],
        [Parameter(symbol, unit, 0.5, "a constant") for symbol, unit in units.items()],
        [PointMass(1, (x, 0))], potential=0,
        links=[Spring((0, 0), 0), Rod((0, 1), 0), Thread((0, 2), (1, x), 0), Wheel(0, V, P),
            Block((x, 1), 2, V), Rail((0, 0), (1, 0)), Plate((0, 0), (1, 0), (x, 1))],
        forces=[F * sp.sign(V - velocity(x)) + push],
        outputs={"reach": sp.Max(x, 2 * P)})  # fmt: skip
