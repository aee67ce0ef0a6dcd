"""Mechanisms with a constraint of velocities and its integral."""

import sympy as sp

from derive import (
    Coordinate,
    Parameter,
    PointMass,
    RigidBody,
    System,
    velocity,
)

x, y, phi, theta, g, c0 = sp.symbols("x y phi theta g c0", real=True)
m, M, J, R, a, k = sp.symbols("m M J R a k", positive=True)
VALUES = {m: ("kg", 1.0), M: ("kg", 1.5), J: ("kg m^2", 0.04), R: ("m", 0.3), a: ("m", 0.2),
    k: ("N/m", 6.0), g: ("m/s^2", 9.81), c0: ("m", 0.1)}  # fmt: skip
LENGTHS = (x, y)


def mechanism(
    name: str, q: tuple[sp.Symbol, ...], masses: list[PointMass], *constraints: sp.Expr,
    **options: object,
) -> System:  # fmt: skip
    """A system of these coordinates, with the parameters above."""
    coordinates = [Coordinate(s, "m" if s in LENGTHS else "rad", "of a part") for s in q]
    parameters = [Parameter(s, unit, value, "of a part") for s, (unit, value) in VALUES.items()]
    return System(name, name, coordinates, parameters, masses, constraints=constraints,
        keep_coordinates=True, **options)  # fmt: skip


def yoke() -> System:
    """A Scotch yoke with its constraint of velocities."""
    return stated("yoke", *CASES["yoke"][:2])


def stated(name: str, integral: sp.Expr, rate: sp.Expr | None) -> System:
    """One of the mechanisms, with its constraint of velocities or with that of positions."""
    constraint = integral - c0 if rate is None else rate
    name = f"{name}_{'by_position' if rate is None else 'by_velocity'}"
    if name.startswith("wheel"):  # on a slope of 3 in 4, with a spring
        body, spring = RigidBody(M, (4 * x / 5, -3 * x / 5), J, -phi), k * x**2 / 2
        return mechanism(name, (x, phi), [body], constraint, potential=spring - M * g * 3 * x / 5)
    if name.startswith("swing"):
        return mechanism(name, (x, y), [PointMass(m, (x, y))], constraint)
    # a rack with a spring, and a gear with a mass on its rim
    pin = PointMass(m, (R * sp.cos(phi), R * sp.sin(phi)))
    spring = k * x**2 / 2 + m * g * R * sp.sin(phi)
    return mechanism(name, (x, phi), [PointMass(M, (x, 0)), pin], constraint, potential=spring)


dx, dy, dphi = map(velocity, (x, y, phi))
#: Integral, constraint of velocities, and a start of each mechanism: a rolling wheel; a rack on a
#: gear whose pitch radius depends on its angle; a Scotch yoke; a pendulum.
CASES: dict[str, tuple[sp.Expr, sp.Expr, dict[str, float]]] = {
    "wheel": (x - R * phi, dx - R * dphi, {"x": 0.7, "phi": 0.2, "phi_dot": -3.0}),
    "rack": (
        x - R * phi - a * sp.sin(phi),
        dx - (R + a * sp.cos(phi)) * dphi,
        {"x": 0.4, "phi": 0.9, "phi_dot": 0.5},
    ),
    "yoke": (x - a * sp.cos(phi), dx + a * sp.sin(phi) * dphi, {"x": 0.3, "phi": -1.0}),
    "swing": ((x**2 + y**2) / 2, x * dx + y * dy, {"x": 0.3, "y": -0.4, "x_dot": 1.0}),
}
