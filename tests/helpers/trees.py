"""Systems whose equations are sums along branches: chains with joints, open and closed."""

from collections.abc import Sequence

from sympy import Expr, Symbol, cos, pi, sin, symbols

from derive import Constraint, Coordinate, Parameter, PointMass, RigidBody, System, velocity

l, m, M, J, k, c, g, d = symbols("l m M J k c g d", positive=True)  # noqa: E741
x = Symbol("x", real=True)
s = symbols("s1:5", real=True)
a = symbols("a1:5", real=True)
b = symbols("b1:4", real=True)
Point = tuple[Expr, Expr]


def arm(start: Point, angles: Sequence[Expr]) -> tuple[list[PointMass], Point]:
    """Bars with joints, of which each angle is measured from the bar before; and the last end."""
    bars: list[PointMass] = []
    for n, direction in enumerate(sum(angles[: k + 1]) for k in range(len(angles))):
        length = l if n % 2 else 2 * l
        step = (length * sin(direction), -length * cos(direction))
        centre = (start[0] + step[0] / 2, start[1] + step[1] / 2)
        bars.append(RigidBody(m, centre, J, direction))
        start = (start[0] + step[0], start[1] + step[1])
    return [*bars, PointMass(M, start)], start


def sliders() -> list[PointMass]:
    """Masses in curved slots of links, each on the mass before; tangents are not orthogonal."""
    masses, place = list[PointMass](), (sin(0), sin(0))
    for angle, along in zip(a, s, strict=True):
        below, beside = l + along, along**2 / (2 * l)
        x_step = beside * cos(angle) + below * sin(angle)
        place = (place[0] + x_step, place[1] + beside * sin(angle) - below * cos(angle))
        masses.append(PointMass(m, place))
    return masses


def parameters(*others: tuple[Symbol, float]) -> list[Parameter]:
    values = [(l, 1.0), (m, 1.5), (M, 0.7), (J, 0.2), (g, 9.8), *others]
    return [Parameter(symbol, "1", value, "") for symbol, value in values]


def coordinates(*angles: Symbol) -> list[Coordinate]:
    return [Coordinate(angle, "rad", "") for angle in angles]


#: A cart with two arms, springs in joints, friction, and a force at one joint.
branching = System(
    name="branching",
    title="A cart with two arms",
    coordinates=[Coordinate(x, "m", ""), *coordinates(*a, *b)],
    parameters=parameters((k, 2.0), (c, 0.3)),
    masses=[
        PointMass(M, (x, 0)),
        *arm((x, 0), a)[0],
        *arm((x + l, l), (b[0] + pi, b[1], b[2]))[0],
    ],
    potential=k * (a[1] ** 2 + (b[1] - x / l) ** 2) / 2,
    gravity=(0, -g),
    dissipation=c * (velocity(a[2]) - velocity(b[0])) ** 2 / 2,
    forces=[-k * x, k * sin(b[0]), 0, 0, 0, velocity(x) * c, 0, k * a[3]],
)
#: Four bars of which the last end stands still.
closed = System(
    name="closed",
    title="A ring of bars",
    coordinates=coordinates(*a),
    parameters=parameters((d, 2.3)),
    masses=arm((0, 0), a)[0],
    constraints=[
        Constraint(arm((0, 0), a)[1][0] - d, "horizontal", "N"),
        Constraint(arm((0, 0), a)[1][1], "vertical", "N"),
    ],
)
#: Four masses on springs, in slots.
sliding = System(
    name="sliding",
    title="A chain of masses that slide in links",
    coordinates=[*coordinates(*a), *(Coordinate(one, "m", "") for one in s)],
    parameters=[Parameter(one, "1", 1.5, "") for one in (l, m, k, g)],
    masses=sliders(),
    potential=k * sum(one**2 for one in s) / 2,
    gravity=(0, -g),
)
