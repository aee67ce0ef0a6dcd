"""Pendulums and oscillators of programs that state accelerations alone."""

from collections.abc import Iterator

from sympy import Expr, cos, sin, symbols

from derive.system.parts import PointMass
from derive.system.symbols import TIME, velocity
from derive.system.system import System
from derive.verification.documents.letters.known_systems.parts_by_name import (
    coordinates,
    g,
    lengths,
    parameters,
)

x, x1, x2, x3, theta = symbols("x x1 x2 x3 theta", real=True)
m, I, l, k, a, A, Omega, omega0 = symbols("m I l k a A Omega omega0", positive=True)
m1, m2, m3, k1, k2, c1, c2, epsilon = symbols("m1 m2 m3 k1 k2 c1 c2 epsilon", positive=True)
alpha, beta, gamma, delta, mu, zeta = symbols("alpha beta gamma delta mu zeta", positive=True)
w = symbols("w", positive=True)

#: A harmonic function of the time in its usual phases.
PHASES = (("cosine", cos(Omega * TIME)), ("sine", sin(Omega * TIME)))


def oscillating_systems() -> Iterator[System]:
    """Pendulums and oscillators."""
    yield from _pendulums()
    yield from _oscillators()
    yield from _coupled()


def _pendulums() -> Iterator[System]:
    angle = coordinates((theta, "rad"))
    yield System(
        "scaled_pendulum", "Pendulum by its angular frequency", angle,
        parameters(omega0="rad/s"), [PointMass(1, (theta, 0))],
        potential=-(omega0**2) * cos(theta),
    )  # fmt: skip
    yield System(
        "pendulum_by_arc", "Pendulum by the length of its arc", lengths(x),
        parameters(m="kg", l="m", g="m/s^2"), [PointMass(m, (l * sin(x / l), -l * cos(x / l)))],
    )  # fmt: skip
    for phase, drive in PHASES:
        yield System(
            f"forced_pendulum_{phase}", "Pendulum with a harmonic torque", angle,
            parameters(m="kg", l="m", g="m/s^2", A="N m", Omega="rad/s"),
            [PointMass(m, (l * theta, 0))], potential=-m * g * l * cos(theta) - A * theta * drive,
        )  # fmt: skip
        for size, fall in (("", -cos(theta)), ("small_", theta**2 / 2)):
            yield System(
                f"{size}accelerated_pendulum_{phase}", "Pendulum with a harmonic acceleration",
                angle, parameters(l="m", g="m/s^2", A="1/s^2", Omega="rad/s"),
                [PointMass(1, (theta, 0))], potential=g / l * fall - A * theta * drive,
            )  # fmt: skip
        yield System(
            f"scaled_forced_pendulum_{phase}", "Pendulum with a harmonic acceleration", angle,
            parameters(A="1/s^2", Omega="rad/s", omega0="rad/s"), [PointMass(1, (theta, 0))],
            potential=-(omega0**2) * cos(theta) - A * theta * drive,
        )  # fmt: skip
        for direction, pivot in (("up", a * drive), ("down", -a * drive)):
            yield System(
                f"shaken_pendulum_{phase}_{direction}",
                "Pendulum whose pivot oscillates vertically", angle,
                parameters(m="kg", l="m", a="m", Omega="rad/s", g="m/s^2"),
                [PointMass(m, (l * sin(theta), pivot - l * cos(theta)))],
            )  # fmt: skip


def _oscillators() -> Iterator[System]:
    place = lengths(x)
    spring = k * x**2 / 2
    yield System(
        "hanging_mass", "Mass that hangs on a spring", place,
        parameters(m="kg", k="N/m", g="m/s^2"), [PointMass(m, (0, x))],
    potential=spring + m * g * x)  # fmt: skip
    yield System(
        "torsion_oscillator", "Body on a torsion spring", coordinates((theta, "rad")),
        parameters(I="kg m^2", k="N m"), [PointMass(I, (theta, 0))], potential=k * theta**2 / 2,
    )  # fmt: skip
    yield System(
        "damped_oscillator", "Oscillator by its angular frequency and damping ratio", place,
        parameters(omega0="rad/s", zeta="1"), [PointMass(1, (x, 0))],
        potential=omega0**2 * x**2 / 2, dissipation=zeta * omega0 * velocity(x)**2,
    )  # fmt: skip
    for name, title, drive, own in (
        ("damped", "Oscillator by its angular frequency and its rate of damping", 0, {}),
        ("driven", "Oscillator by rates with a harmonic force", A * cos(Omega * TIME),
         {"A": "N", "Omega": "rad/s"}),
    ):  # fmt: skip
        yield System(
            f"{name}_oscillator_by_rates", title, place,
            parameters(m="kg", omega0="rad/s", gamma="1/s", **own), [PointMass(m, (x, 0))],
            potential=m * omega0**2 * x**2 / 2 - x * drive, dissipation=m * gamma * velocity(x)**2,
        )  # fmt: skip
    yield System(
        "van_der_pol", "Van der Pol's oscillator", place, parameters(mu="1"),
        [PointMass(1, (x, 0))], potential=x**2 / 2, forces=[mu * (1 - x**2) * velocity(x)],
    )  # fmt: skip
    for phase, drive in PHASES:
        yield System(
            f"driven_oscillator_{phase}", "Mass on a spring with a harmonic force", place,
            parameters(m="kg", k="N/m", A="N", Omega="rad/s"), [PointMass(m, (x, 0))],
            potential=spring - A * x * drive,
        )  # fmt: skip
        for sign, stiffness, own in (
            ("", alpha, {"alpha": ""}),
            ("two_wells_", -alpha, {"alpha": ""}),
            ("unit_wells_", -1, {}),
            ("by_frequency_", omega0**2, {"omega0": "rad/s"}),
        ):
            yield System(
                f"duffing_{sign}{phase}", "Duffing's oscillator of a unit mass", place,
                parameters(**own, beta="", gamma="", delta="", Omega="rad/s"),
                [PointMass(1, (x, 0))], dissipation=delta * velocity(x)**2 / 2,
                potential=stiffness * x**2 / 2 + beta * x**4 / 4 - gamma * x * drive,
            )  # fmt: skip


def _coupled() -> Iterator[System]:
    for name, title, ground in (
        ("quarter_car", "Two masses on springs and dampers, on a given road", w),
        ("two_damped_oscillators", "Two masses on springs and dampers", 0),
    ):
        road = parameters(w="m") if ground else []
        yield System(
            name, title, lengths(x1, x2),
            [*parameters(m1="kg", m2="kg", k1="N/m", k2="N/m", c2="N s/m"), *road],
            [PointMass(m1, (x1, 0)), PointMass(m2, (x2, 0))],
            potential=k1 * (x1 - ground)**2 / 2 + k2 * (x2 - x1)**2 / 2,
            dissipation=c2 * (velocity(x2) - velocity(x1))**2 / 2,
        )  # fmt: skip
    yield System(
        "pendulum_on_spring_cart", "Pendulum on a cart that a spring holds",
        coordinates((x, "m"), (theta, "rad")),
        parameters(m1="kg", m2="kg", k="N/m", l="m", g="m/s^2"),
        [PointMass(m1, (x, 0)), PointMass(m2, (x + l * sin(theta), -l * cos(theta)))],
        potential=k * x**2 / 2 - m2 * g * l * cos(theta),
    )  # fmt: skip
    yield System(
        "three_oscillators", "Three masses between springs", lengths(x1, x2, x3),
        parameters(m1="kg", m2="kg", m3="kg", k="N/m"),
        [PointMass(m1, (x1, 0)), PointMass(m2, (x2, 0)), PointMass(m3, (x3, 0))],
        potential=k * (x1**2 + (x2 - x1)**2 + (x3 - x2)**2 + x3**2) / 2,
    )  # fmt: skip
    for name, inertias, stiffness in (
        ("wilberforce", parameters(m="kg", I="kg m^2", k="N/m", delta="N m", epsilon="N"),
         (k, delta)),
        ("resonant_wilberforce", parameters(m="kg", I="kg m^2", omega0="rad/s", epsilon="N"),
         (m * omega0**2, I * omega0**2)),
    ):  # fmt: skip
        energy: Expr = stiffness[0] * x**2 / 2 + stiffness[1] * theta**2 / 2
        yield System(
            name, "Wilberforce's pendulum: a mass on a spring that moves and turns",
            coordinates((x, "m"), (theta, "rad")), inertias,
            [PointMass(m, (x, 0)), PointMass(I, (theta, 0))],
            potential=energy + epsilon * x * theta / 2,
        )  # fmt: skip
