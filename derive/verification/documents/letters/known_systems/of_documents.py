"""Systems that documents treat, beside those that ship."""

from collections.abc import Iterator

import sympy as sp
from sympy import cos, sin, symbols

from derive.system.parts import PointMass
from derive.system.rigid_body import RigidBody
from derive.system.system import System
from derive.verification.documents.letters.known_systems.parts_by_name import (
    coordinates,
    g,
    parameters,
)


def systems_of_documents() -> Iterator[System]:
    """Systems that are tried for any document."""
    x, theta, theta1, theta2, x1, x2 = symbols("x theta theta1 theta2 x1 x2", real=True)
    m, l, k, M, r, G, I = symbols("m l k M r G I", positive=True)
    m1, m2, l1, r1, r2, I1, I2 = symbols("m1 m2 l1 r1 r2 I1 I2", positive=True)
    yield System(
        "oscillator",
        "Mass on a spring",
        coordinates((x, "m")),
        parameters(m="kg", k="N/m"),
        [PointMass(m, (x, 0))],
        potential=k * x**2 / 2,
    )
    yield System(
        "central_force",
        "Mass in the field of another that is fixed",
        coordinates((r, "m"), (theta, "rad")),
        parameters(m="kg", M="kg", G="m^3/(kg s^2)"),
        [PointMass(m, (r * cos(theta), r * sin(theta)))],
        potential=-G * M * m / r,
    )
    yield System(
        "field_of_a_centre",
        "Mass in an attracting field with the constant k",
        coordinates((r, "m"), (theta, "rad")),
        parameters(m="kg", k="J m"),
        [PointMass(m, (r * cos(theta), r * sin(theta)))],
        potential=-k / r,
    )
    yield System(
        "physical_pendulum",
        "Rigid body on a hinge",
        coordinates((theta, "rad")),
        parameters(m="kg", l="m", I="kg m^2", g="m/s^2"),
        [RigidBody(m, (l * sin(theta), -l * cos(theta)), I - m * l**2, theta)],
    )
    yield System(
        "cart_and_bar",
        "Cart with a hinged rigid body",
        coordinates((x, "m"), (theta, "rad")),
        parameters(M="kg", m="kg", l="m", I="kg m^2", g="m/s^2"),
        [PointMass(M, (x, 0)), RigidBody(m, (x + l * sin(theta), -l * cos(theta)), I, theta)],
    )
    heights = [l * cos(theta1), l * cos(theta2)]
    for name, title, stretch in (
        ("sideways_coupled_pendulums", "Two pendulums coupled by a spring that stays horizontal",
         l * sin(theta2) - l * sin(theta1)),
        ("twist_coupled_pendulums", "Two pendulums coupled by a torsion spring", theta2 - theta1),
    ):  # fmt: skip
        yield System(
            name, title,
            coordinates((theta1, "rad"), (theta2, "rad")),
            parameters(m="kg", l="m", k="N/m", g="m/s^2"),
            [PointMass(m, (l * sin(theta1), -heights[0])),
             PointMass(m, (l * sin(theta2), -heights[1]))],
            potential=k * stretch**2 / 2 - m * g * sum(heights),
        )  # fmt: skip
    yield System(
        "two_links", "Two hinged links with moments of inertia about their centres of mass",
        coordinates((theta1, "rad"), (theta2, "rad")),
        parameters(m1="kg", m2="kg", l1="m", r1="m", r2="m", I1="kg m^2", I2="kg m^2", g="m/s^2"),
        [RigidBody(m1, (r1 * sin(theta1), -r1 * cos(theta1)), I1, theta1),
         RigidBody(m2, (l1 * sin(theta1) + r2 * sin(theta2),
                        -l1 * cos(theta1) - r2 * cos(theta2)), I2, theta2)],
    )  # fmt: skip
    yield System(
        "two_links_about_joints", "Two hinged links with moments of inertia about their joints",
        coordinates((theta1, "rad"), (theta2, "rad")),
        parameters(m1="kg", m2="kg", l1="m", r1="m", r2="m", I1="kg m^2", I2="kg m^2", g="m/s^2"),
        [RigidBody(m1, (r1 * sin(theta1), -r1 * cos(theta1)), I1 - m1 * r1**2, theta1),
         RigidBody(m2, (l1 * sin(theta1) + r2 * sin(theta2),
                        -l1 * cos(theta1) - r2 * cos(theta2)), I2 - m2 * r2**2, theta2)],
    )  # fmt: skip
    Ir, gr = symbols("Ir gr", positive=True)
    yield System(
        "two_links_with_motors", "Two hinged links with moments of inertia and motors",
        coordinates((theta1, "rad"), (theta2, "rad")),
        parameters(m1="kg", m2="kg", l1="m", r1="m", r2="m", I1="kg m^2", I2="kg m^2",
                    Ir="kg m^2", gr="1", g="m/s^2"),
        [RigidBody(m1, (r1 * sin(theta1), -r1 * cos(theta1)), I1 - m1 * r1**2, theta1),
         RigidBody(m2, (l1 * sin(theta1) + r2 * sin(theta2),
                        -l1 * cos(theta1) - r2 * cos(theta2)), I2 - m2 * r2**2, theta2),
         # rotors turn gr times as fast as the joints, each held by the link before it
         PointMass(Ir, (gr * theta1, 0)), PointMass(Ir, (theta1 - gr * (theta2 - theta1), 0))],
        potential=g * (-m1 * r1 * cos(theta1) - m2 * (l1 * cos(theta1) + r2 * cos(theta2))),
    )  # fmt: skip
    yield System(
        "two_oscillators",
        "Two masses between springs",
        coordinates((x1, "m"), (x2, "m")),
        parameters(m1="kg", m2="kg", k1="N/m", k2="N/m", k3="N/m"),
        [PointMass(m1, (x1, 0)), PointMass(m2, (x2, 0))],
        potential=sum(
            sp.Symbol(name, positive=True) * length**2 / 2
            for name, length in (("k1", x1), ("k2", x2 - x1), ("k3", x2))
        ),
    )
    yield System(
        "bead_on_parabola",
        "Bead on a parabola",
        coordinates((x, "m")),
        parameters(m="kg", k="1/m", g="m/s^2"),
        [PointMass(m, (x, k * x**2))],
    )
    yield System(
        "projectile",
        "Mass in uniform gravity",
        coordinates((x1, "m"), (x2, "m")),
        parameters(m="kg", g="m/s^2"),
        [PointMass(m, (x1, x2))],
    )
    yield System(
        "cone",
        "Mass on a cone",
        coordinates((r, "m"), (theta, "rad")),
        parameters(m="kg", k="1", g="m/s^2"),
        [PointMass(m, (r * cos(theta), r * sin(theta), k * r))],
    )
    yield System(
        "atwood",
        "Two masses on a thread over a pulley",
        coordinates((x, "m")),
        parameters(m1="kg", m2="kg", g="m/s^2"),
        [PointMass(m1, (0, -x)), PointMass(m2, (0, x))],
    )
