"""Mechanisms of control, in programs that state accelerations alone."""

from collections.abc import Iterator

from sympy import cos, sin, symbols

from derive.system.orientation import rotations
from derive.system.parts import PointMass
from derive.system.rigid_body import RigidBody
from derive.system.system import System
from derive.verification.documents.letters.known_systems.parts_by_name import (
    coordinates,
    g,
    parameters,
)

x, y, theta, phi, psi, q1, q2 = symbols("x y theta phi psi q1 q2", real=True)
m, M, m1, m2, l, L, l1, R = symbols("m M m1 m2 l L l1 R", positive=True)
r, I, J, I1, I2, I3, mu = symbols("r I J I1 I2 I3 mu", positive=True)
F, tau, F1, F2 = symbols("F tau F1 F2", positive=True)


def mechanisms() -> Iterator[System]:
    """Balls on beams, arms, wheels, flying bodies, tops."""
    yield from _balls_on_beams()
    yield from _wheels()
    yield from _arms()
    yield from _flying()
    theta_r = coordinates((r, "m"), (theta, "rad"))
    yield System(
        "swinging_atwood_by_ratio", "Swinging Atwood machine by the ratio of its masses", theta_r,
        parameters(mu="1", g="m/s^2"),
        [PointMass(mu, (0, r)), PointMass(1, (r * sin(theta), -r * cos(theta)))],
        potential=mu * g * r - g * r * cos(theta),
    )  # fmt: skip
    axes = rotations("zxz", (phi, theta, psi))
    yield System(
        "top_about_its_tip", "Heavy top with moments of inertia about its tip",
        coordinates((phi, "rad"), (theta, "rad"), (psi, "rad")),
        parameters(m="kg", l="m", I1="kg m^2", I3="kg m^2", g="m/s^2"),
        [RigidBody(1, (0, 0, 0), (I1, I1, I3), axes)], potential=m * g * l * cos(theta),
    )  # fmt: skip


def _balls_on_beams() -> Iterator[System]:
    x_theta = coordinates((x, "m"), (theta, "rad"))
    place, beam = (x * cos(theta), x * sin(theta)), PointMass(J, (theta, 0))
    for name, title, rolling, constants in (
        ("sliding", "Mass that slides on a beam", 0, {}),
        ("solid", "Solid ball on a beam", 2 * m / 5, {}),
        ("rolling", "Ball with a moment of inertia on a beam", I / R**2, {"I": "kg m^2", "R": "m"}),
    ):
        ball = [PointMass(m, place), *([PointMass(rolling, (x, 0))] if rolling else [])]
        yield System(
            f"{name}_ball_on_beam", title, x_theta,
            parameters(m="kg", J="kg m^2", g="m/s^2", **constants), [*ball, beam],
            potential=m * g * x * sin(theta),
        )  # fmt: skip
    yield System(
        "mass_on_hinged_rod", "Mass that slides on a hinged rod with a force at its tip", x_theta,
        parameters(m1="kg", m2="kg", l="m", F="N", g="m/s^2"),
        [PointMass(m1, place), PointMass(m2 * l**2 / 3, (theta, 0))],
        potential=g * (m1 * x + m2 * l / 2) * sin(theta), forces=[0, F * l * cos(theta)],
    )  # fmt: skip


def _wheels() -> Iterator[System]:
    constants = parameters(M="kg", m="kg", I="kg m^2", J="kg m^2", r="m", l="m", g="m/s^2")
    for name, start, unit in (("path", x, "m"), ("turn", r * phi, "rad")):
        own = x if unit == "m" else phi
        yield System(
            f"wheeled_pendulum_by_{name}", "Pendulum on wheels with a motor between them",
            coordinates((own, unit), (theta, "rad")), [*constants, *parameters(tau="N m")],
            [PointMass(M + J / r**2, (start, 0)),
             RigidBody(m, (start + l * sin(theta), l * cos(theta)), I, theta)],
            forces=[tau / r if unit == "m" else tau, -tau], potential=m * g * l * cos(theta),
        )  # fmt: skip
    yield System(
        "reaction_wheel_pendulum", "Pendulum with a wheel and a motor at its end",
        coordinates((q1, "rad"), (q2, "rad")),
        parameters(m1="kg", m2="kg", r="m", l1="m", I1="kg m^2", I2="kg m^2", g="m/s^2"),
        [RigidBody(m1, (r * sin(q1), r * cos(q1)), I1, q1),
         RigidBody(m2, (l1 * sin(q1), l1 * cos(q1)), I2, q1 + q2)],
    )  # fmt: skip


def _arms() -> Iterator[System]:
    """Furuta's pendulum with a point mass, of uniform rods, with a centre in the middle."""
    arm, axes = rotations("z", [phi]), rotations("zx", (phi, theta))
    for name, reach, across, inertia, own in (
        ("point_mass", l, 0, J, {"J": "kg m^2"}),
        ("uniform_rods", l / 2, m * l**2 / 12, M * L**2 / 3, {"M": "kg"}),
        ("uniform_rod", l / 2, m * l**2 / 12, J, {"J": "kg m^2"}),
        ("half_rod", l / 2, I, J, {"J": "kg m^2", "I": "kg m^2"}),
    ):
        place = arm.turned((L, reach * sin(theta), -reach * cos(theta)))
        rod = RigidBody(m, place, (across, across, 0), axes) if across else PointMass(m, place)
        yield System(
            f"furuta_with_{name}", f"Furuta's pendulum with a {name.replace('_', ' ')}",
            coordinates((phi, "rad"), (theta, "rad")),
            parameters(m="kg", L="m", l="m", g="m/s^2", **own),
            [rod, PointMass(inertia, (phi, 0, 0))], potential=-m * g * reach * cos(theta),
        )  # fmt: skip


def _flying() -> Iterator[System]:
    place = coordinates((x, "m"), (y, "m"), (theta, "rad"))
    for name, thrust, torque, own in (
        ("thrust", F, tau, {"F": "N", "tau": "N m"}),
        ("rotors", F1 + F2, r * (F1 - F2), {"F1": "N", "F2": "N", "r": "m"}),
    ):
        yield System(
            f"planar_quadrotor_by_{name}", "Rigid body in a vertical plane with rotors", place,
            parameters(m="kg", I="kg m^2", g="m/s^2", **own), [RigidBody(m, (x, y), I, theta)],
            potential=m * g * y, forces=[-thrust * sin(theta), thrust * cos(theta), torque],
        )  # fmt: skip
