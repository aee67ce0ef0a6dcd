"""Systems without constraints of their own, which documents add."""

from collections.abc import Iterator

import sympy as sp
from sympy import cos, sin, symbols

from derive.system.parts import PointMass
from derive.system.rigid_body import RigidBody
from derive.system.system import System
from derive.verification.documents.letters.known_systems.parts_by_name import (
    coordinates,
    parameters,
)


def free_bodies() -> Iterator[System]:
    """Systems to which documents add constraints."""
    x, y, z, theta = symbols("x y z theta", real=True)
    r, a, m, J = symbols("r a m J", positive=True)
    yield System(
        "polar_mass", "Mass in polar coordinates", coordinates((r, "m"), (theta, "rad")),
        parameters(m="kg", g="m/s^2"), [PointMass(m, (r * sin(theta), -r * cos(theta)))],
    )  # fmt: skip
    yield System(
        "mass_in_space", "Mass in space in uniform gravity",
        coordinates((x, "m"), (y, "m"), (z, "m")),
        parameters(m="kg", g="m/s^2"), [PointMass(m, (x, y, z))],
    )  # fmt: skip
    place = coordinates((x, "m"), (y, "m"), (theta, "rad"))
    body = [RigidBody(m, (x, y), J, theta)]
    inertia = parameters(m="kg", J="kg m^2", g="m/s^2")
    yield System("body_in_plane", "Rigid body in a vertical plane", place, inertia, body)
    yield System(
        "body_on_plane", "Rigid body in a plane without gravity", place, inertia[:2], body,
        potential=sp.S.Zero,
    )  # fmt: skip
    yield System(
        "body_by_point", "Rigid body in a plane without gravity, by the place of one of its points",
        place, [*inertia[:2], *parameters(a="m")],
        [RigidBody(m, (x + a * cos(theta), y + a * sin(theta)), J, theta)], potential=sp.S.Zero,
    )  # fmt: skip
