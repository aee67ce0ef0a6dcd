"""Systems with constraints that several tests use."""

from math import cos, sin

import sympy as sp

import generated.double_pendulum as dp
from derive import (
    TIME,
    Constraint,
    Coordinate,
    Input,
    Parameter,
    PointMass,
    RigidBody,
    System,
    pin,
    velocity,
)
from derive import load as load_system

x, y, theta, phi, g = sp.symbols("x y theta phi g", real=True)
m, length = sp.symbols("m l", positive=True)
KG, ROD = Parameter(m, "kg", 1.5, "mass"), Parameter(length, "m", 0.8, "length")
GRAVITY = Parameter(g, "m/s^2", 9.81, "gravity")
PLANE = [Coordinate(x, "m", "to the right"), Coordinate(y, "m", "upwards")]
START = (sin(1.0) * 0.8, -cos(1.0) * 0.8, 0.0, 0.0)


def swing() -> System:
    """A pendulum by Cartesian coordinates and a rod."""
    rod = Constraint(x**2 + y**2 - length**2, "rod", "N/m", "half the tension per length, negative")
    return System("swing", "Pendulum in Cartesian coordinates", PLANE, [KG, ROD, GRAVITY],
        [PointMass(m, (x, y))], constraints=[rod])  # fmt: skip


def pinned() -> System:
    """The same with an angle, too: the mass is at the end of the rod."""
    q = [*PLANE, Coordinate(theta, "rad", "of the rod")]
    end = (length * sp.sin(theta), -length * sp.cos(theta))
    return System("pinned", "Pendulum with a pin", q, [KG, ROD, GRAVITY],
        [PointMass(m, (x, y))], coincide=[((x, y), end)], keep_coordinates=True)  # fmt: skip


def lifted() -> System:
    """A pendulum whose rod becomes longer with time."""
    return System("lifted", "Pendulum of growing length", PLANE, [KG, ROD, GRAVITY],
        [PointMass(m, (x, y))], constraints=[x**2 + y**2 - (length + TIME / 10) ** 2])  # fmt: skip


def two_rods() -> System:
    """The double pendulum by Cartesian coordinates."""
    x1, y1, x2, y2, g = sp.symbols("x1 y1 x2 y2 g", real=True)
    m1, m2, l1, l2 = sp.symbols("m1 m2 l1 l2", positive=True)
    units = {m1: "kg", m2: "kg", l1: "m", l2: "m", g: "m/s^2"}
    return System(
        "two_rods",
        "Double pendulum in Cartesian coordinates",
        [Coordinate(q, "m", "of a bob") for q in (x1, y1, x2, y2)],
        [Parameter(s, u, dp.DEFAULTS[k], "as usual") for k, (s, u) in enumerate(units.items())],
        [PointMass(m1, (x1, y1)), PointMass(m2, (x2, y2))],
        constraints=[x1**2 + y1**2 - l1**2, (x2 - x1) ** 2 + (y2 - y1) ** 2 - l2**2],
    )


def sleigh() -> System:
    """Chaplygin's sleigh: a body on a blade that does not slip sideways."""
    x, y, theta, F = sp.symbols("x y theta F", real=True)
    m, a, inertia = sp.symbols("m a I", positive=True)
    vx, vy = velocity(x), velocity(y)
    forward, sideways = (sp.cos(theta), sp.sin(theta)), (-sp.sin(theta), sp.cos(theta))
    centre = (x + a * forward[0], y + a * forward[1])
    return System("sleigh", "Sleigh on a blade",
        [Coordinate(x, "m", "of the blade"), Coordinate(y, "m", "of the blade"),
         Coordinate(theta, "rad", "heading")],
        [Parameter(m, "kg", 2.0, "mass"), Parameter(a, "m", 0.3, "from blade to centre of mass"),
         Parameter(inertia, "kg m^2", 0.1, "about the centre of mass")],
        [RigidBody(m, centre, inertia, theta)], potential=0,
        forces=(F * forward[0], F * forward[1], 0), inputs=[Input(F, "N", "thrust")],
        constraints=[vx * sideways[0] + vy * sideways[1]])  # fmt: skip


def bars() -> System:
    """Two bars from the positions of the bodies, and two pins."""
    names = "x1 y1 theta1 x2 y2 theta2"
    x1, y1, theta1, x2, y2, theta2 = q = sp.symbols(names, real=True)
    m1, m2, l1, l2 = sp.symbols("m1 m2 l1 l2", positive=True)
    h1 = (l1 * sp.sin(theta1) / 2, -l1 * sp.cos(theta1) / 2)  # from the middle to the lower end
    h2 = (l2 * sp.sin(theta2) / 2, -l2 * sp.cos(theta2) / 2)
    units = {"x": "m", "y": "m", "t": "rad"}
    return System("bars", "Two bars", [Coordinate(s, units[s.name[0]], "of a bar") for s in q],
        load_system("double_bar_pendulum").parameters,
        [RigidBody(m1, (x1, y1), m1 * l1**2 / 12, theta1),
         RigidBody(m2, (x2, y2), m2 * l2**2 / 12, theta2)],
        constraints=[*pin("A", (x1 - h1[0], y1 - h1[1]), (0, 0)),
            *pin("B", (x2 - h2[0], y2 - h2[1]), (x1 + h1[0], y1 + h1[1]))])  # fmt: skip
