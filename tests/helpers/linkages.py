"""Closed linkages of bars, with a constraint at their end."""

from collections.abc import Sequence

import sympy as sp

from derive import Coordinate, Parameter, PointMass, RigidBody, System

phi, psi, theta, x, g = sp.symbols("phi psi theta x g", real=True)
a, b, c, d, m, M = sp.symbols("a b c d m M", positive=True)
UNITS = {a: "m", b: "m", c: "m", d: "m", m: "kg", M: "kg", g: "m/s^2"}
CRANK = a * sp.Matrix([sp.cos(phi), sp.sin(phi)])


def linkage(
    name: str,
    coordinates: Sequence[sp.Symbol],
    values: dict[sp.Symbol, float],
    end: tuple[sp.Expr, sp.Expr],
) -> System:
    """A crank, a rod at its end whose angle is the second coordinate, and a mass at `end`."""
    along = sp.Matrix([sp.cos(coordinates[1]), sp.sin(coordinates[1])])
    rod = RigidBody(m, tuple(CRANK + b * along / 2), m * b**2 / 12, coordinates[1])
    return System(
        name,
        name,
        [Coordinate(q, "m" if q == x else "rad", "of a part") for q in coordinates],
        [Parameter(s, UNITS[s], value, "of a part") for s, value in values.items()],
        [rod, PointMass(M, end)],
        coincide=[(tuple(CRANK + b * along), end)],
        keep_coordinates=True,
    )


def slider_crank() -> System:
    """A crank and a rod whose end slides on a line."""
    values = {a: 0.25, b: 0.75, m: 2.0, M: 1.0, g: 9.75}
    return linkage("slider_crank", (phi, psi, x), values, (x, 0))


def four_bar() -> System:
    """A crank, a rod and a rocker."""
    values = {a: 0.25, b: 0.75, c: 0.5, d: 0.75, m: 2.0, M: 1.0, g: 9.75}
    rocker = (d + c * sp.cos(psi), c * sp.sin(psi))
    return linkage("four_bar", (phi, theta, psi), values, rocker)


def ring(n: int) -> System:
    """Links of lengths l1 to ln with a mass at each joint, from the origin to a fixed point."""
    angles = sp.symbols(f"q1:{n + 1}", real=True)
    lengths = sp.symbols(f"l1:{n + 1}", positive=True)
    ends, end = [], sp.zeros(2, 1)
    for length, angle in zip(lengths, angles, strict=True):
        end = end + length * sp.Matrix([sp.sin(angle), -sp.cos(angle)])
        ends.append(tuple(end))
    values = [(m, 1.0), (g, 9.81), (d, 1.0), *((length, 1.0) for length in lengths)]
    return System(
        f"ring_{n}",
        "A ring of links",
        [Coordinate(angle, "rad", "from the vertical") for angle in angles],
        [Parameter(s, UNITS.get(s, "m"), value, "of a part") for s, value in values],
        [PointMass(m, place) for place in ends],
        coincide=[(ends[-1], (0, d))],
        keep_coordinates=True,
    )
