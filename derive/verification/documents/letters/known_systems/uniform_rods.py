"""Systems of uniform rods, whose moments of inertia have no letter."""

from collections.abc import Iterator

import sympy as sp
from sympy import cos, sin, symbols

from derive.system.parts import Parameter, PointMass
from derive.system.rigid_body import RigidBody
from derive.system.system import System
from derive.verification.documents.letters.known_systems.parts_by_name import (
    coordinates,
    g,
    parameters,
)


def uniform_rods() -> Iterator[System]:
    """Systems that are tried where a third or a twelfth of m l² can occur."""
    x, theta, theta1, theta2 = symbols("x theta theta1 theta2", real=True)
    m, M, l, m1, m2, l1, l2, r1, r2 = symbols("m M l m1 m2 l1 l2 r1 r2", positive=True)
    for name, title, part in (
        ("uniform_rod", "Uniform rod on a hinge", 2),
        ("half_rod", "Uniform rod on a hinge, twice as long as its letter", 1),
    ):
        yield System(
            name, title,
            coordinates((theta, "rad")),
            parameters(m="kg", l="m", g="m/s^2"),
            [RigidBody(m, (l * sin(theta) / part, -l * cos(theta) / part),
                       m * (2 * l / part)**2 / 12, theta)],
        )  # fmt: skip
    a = sp.Symbol("a", real=True)
    yield System(
        "pushed_rod", "Uniform rod on a hinge with a given acceleration",
        coordinates((theta, "rad")),
        [*parameters(m="kg", l="m", g="m/s^2"), Parameter(a, "N/kg", 1.0, "")],
        [RigidBody(m, (l * sin(theta) / 2, -l * cos(theta) / 2), m * l**2 / 12, theta)],
        potential=m * l * (a * sin(theta) - g * cos(theta)) / 2,
    )  # fmt: skip
    for name, title, part in (
        ("cart_and_half_rod", "Cart with a uniform rod, twice as long as its letter", 1),
        ("cart_and_uniform_rod", "Cart with a uniform rod", 2),
    ):
        yield System(
            name, title,
            coordinates((x, "m"), (theta, "rad")),
            parameters(M="kg", m="kg", l="m", g="m/s^2"),
            [PointMass(M, (x, 0)),
             RigidBody(m, (x + l * sin(theta) / part, -l * cos(theta) / part),
                       m * (2 * l / part)**2 / 12, theta)],
        )  # fmt: skip
    yield System(
        "two_half_rods", "Two hinged uniform rods, twice as long as their letters",
        coordinates((theta1, "rad"), (theta2, "rad")),
        parameters(m1="kg", m2="kg", l1="m", l2="m", g="m/s^2"),
        [RigidBody(m1, (l1 * sin(theta1), -l1 * cos(theta1)), m1 * l1**2 / 3, theta1),
         RigidBody(m2, (2 * l1 * sin(theta1) + l2 * sin(theta2),
                        -2 * l1 * cos(theta1) - l2 * cos(theta2)), m2 * l2**2 / 3, theta2)],
    )  # fmt: skip
    yield System(
        "two_rods_by_centres", "Two hinged uniform rods with letters for their centres",
        coordinates((theta1, "rad"), (theta2, "rad")),
        [*parameters(m1="kg", m2="kg", l1="m", l2="m", g="m/s^2"),
         Parameter(r1, "m", 0.5, ""), Parameter(r2, "m", 0.5, "")],
        [RigidBody(m1, (r1 * sin(theta1), -r1 * cos(theta1)), m1 * (l1**2 / 3 - r1**2), theta1),
         RigidBody(m2, (l1 * sin(theta1) + r2 * sin(theta2), -l1 * cos(theta1) - r2 * cos(theta2)),
                   m2 * (l2**2 / 3 - r2**2), theta2)],
    )  # fmt: skip
