"""A system that has everything at once, which no system of the catalogue does."""

from sympy import cos, exp, sin, sqrt, symbols

from derive import TIME, Coordinate, Parameter, PointMass, RigidBody, System, velocity

x, theta, g = symbols("x theta g", real=True)
y, m, M, l, c, F = symbols("y m M l c F", positive=True)  # noqa: E741
v, w, h = velocity(x), velocity(theta), velocity(y)
pivot = x + sin(2 * TIME) / 3

system = System(
    name="strange",
    title="A cart with a bar on a moving rail, a mass on a thread, friction and forces",
    coordinates=[Coordinate(x, "m", ""), Coordinate(theta, "rad", ""), Coordinate(y, "m", "")],
    parameters=[Parameter(s, "1", 1.5, "") for s in (m, M, l, c, F, g)],
    masses=[
        PointMass(M, (pivot, TIME**2 / 5)),
        RigidBody(m, (pivot + l * sin(theta), -l * cos(theta)), m * l**2 / 3, theta + x / l),
        PointMass(M, (y * cos(theta), sqrt(1 + y**2))),
    ],
    potential=c * (x - y) ** 2 * (1 + TIME) / 2,
    gravity=(g / 7, -g),
    dissipation=c * (v - w * cos(theta)) ** 2 * (1 + y**2) / 2 + c * h**4 / 4,
    forces=[F * cos(TIME) * exp(-(x**2)), -F * v * theta, F * w * h * sin(theta)],
)
