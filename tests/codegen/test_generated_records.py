"""Generated files of systems that do not ship."""

import constrained_systems as constrained
import sympy as sp
import velocity_constraints as mechanisms
from cart_pole import cart_pole
from recording import Record

from derive import (
    Block,
    Coordinate,
    Derivation,
    Parameter,
    PointMass,
    Rail,
    Rod,
    Spring,
    System,
    Thread,
    Wheel,
    reduced,
    velocity,
)
from derive.codegen.module_files import texts

x, y, P, F, V = sp.symbols("x y P F V", real=True)


def block() -> System:
    """A block with friction on a belt, a force that is chosen by its place, and a spring."""
    push = sp.Piecewise((P, x < V), (P * sp.exp(-x), True))
    units = {P: "N", F: "N", V: "m/s"}
    return System("block", "Block on a belt", [Coordinate(x, "m", "position")],
        [Parameter(symbol, unit, 0.5, "a constant") for symbol, unit in units.items()],
        [PointMass(1, (x, 0))], potential=0,
        links=[Spring((0, 0), 0), Rod((0, 1), 0), Thread((0, 2), (1, x), 0), Wheel(0, V, P),
            Block((x, 1), 2, V), Rail((0, 0), (1, 0))],
        forces=[F * sp.sign(V - velocity(x)) + push],
        outputs={"reach": sp.Max(x, 2 * P)})  # fmt: skip


def test_generated_files_are_as_recorded(record: Record) -> None:
    systems = (
        block(), cart_pole, constrained.swing(), constrained.lifted(), constrained.sleigh(),
        constrained.pinned(), mechanisms.yoke(),
    )  # fmt: skip
    found: dict[str, str] = {}
    for system in systems:
        found |= texts(Derivation(reduced(system)))
    record.check_digests(found)
