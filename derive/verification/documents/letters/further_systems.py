"""Systems that documents treat, beside those that ship: what a document's letters can mean."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import sympy as sp
from sympy import cos, sin, symbols

from derive.system.files.system_catalogue import load
from derive.system.parts import Coordinate, Parameter, PointMass
from derive.system.rigid_body import RigidBody
from derive.system.symbols import TIME
from derive.system.system import System

#: Systems that ship and are tried, the commonest first.
SHIPPED = (
    "double_pendulum single_pendulum cart_1 elastic_pendulum spherical_pendulum chain_3 cart_2 "
    "double_bar_pendulum swinging_atwood rotating_hoop driven_pendulum coupled_pendulums "
    "henon_heiles foucault_pendulum"
).split()

#: Systems of uniform rods, whose moments of inertia have no letter.
RODS = frozenset(
    "uniform_rod half_rod pushed_rod cart_and_half_rod cart_and_uniform_rod two_half_rods".split()
)

#: Systems without constraints of their own, which documents add.
FREE = frozenset("polar_mass mass_in_space body_in_plane body_on_plane body_by_point".split())
#: Systems that are tried where no energy is stated, as in programs.
OF_EQUATIONS = frozenset(
    "forced_pendulum scaled_forced_pendulum attracted_mass attracted_unit_mass "
    "cubic_potential two_bodies".split()
)


def templates(
    count: int, has_rods: bool = True, is_free: bool = False, has_energies: bool = True
) -> Iterator[System]:
    """Yield the systems with so many coordinates: with uniform rods, free ones, or without."""
    left_out = (frozenset() if has_rods else RODS) | (frozenset() if is_free else FREE)
    left_out |= OF_EQUATIONS if has_energies else frozenset()
    for system in _all():
        if len(system.coordinates) == count and system.name not in left_out:
            yield system


def named(name: str | Path) -> System:
    """The system of a name, also one that does not ship, or of a path.

    Inputs are parameters, since a document has letters for both.
    """
    own = next((one for one in (*_free(), *_others()) if one.name == name), None)
    system = own or load(name)
    inputs = [Parameter(one.symbol, one.unit, 1.0, one.meaning) for one in system.inputs]
    return replace(system, parameters=(*system.parameters, *inputs), inputs=())


@cache
def _all() -> tuple[System, ...]:
    return (*_free(), *map(load, SHIPPED), *_others())


def _coordinates(*pairs: tuple[sp.Symbol, str]) -> list[Coordinate]:
    return [Coordinate(symbol, unit, "a coordinate") for symbol, unit in pairs]


def _parameters(**units: str) -> list[Parameter]:
    """Positive parameters by their names, and gravity, which can be negative."""
    return [
        Parameter(sp.Symbol(name, **{"real" if name == "g" else "positive": True}), unit, 1.0, "")
        for name, unit in units.items()
    ]


def _others() -> Iterator[System]:
    x, theta, theta1, theta2, x1, x2 = symbols("x theta theta1 theta2 x1 x2", real=True)
    m, l, k, M, r, G, I = symbols("m l k M r G I", positive=True)
    m1, m2, l1, l2, r1, r2, I1, I2 = symbols("m1 m2 l1 l2 r1 r2 I1 I2", positive=True)
    yield System(
        "oscillator",
        "Mass on a spring",
        _coordinates((x, "m")),
        _parameters(m="kg", k="N/m"),
        [PointMass(m, (x, 0))],
        potential=k * x**2 / 2,
    )
    yield System(
        "central_force",
        "Mass in the field of another that is fixed",
        _coordinates((r, "m"), (theta, "rad")),
        _parameters(m="kg", M="kg", G="m^3/(kg s^2)"),
        [PointMass(m, (r * cos(theta), r * sin(theta)))],
        potential=-G * M * m / r,
    )
    yield System(
        "field_of_a_centre",
        "Mass in an attracting field with the constant k",
        _coordinates((r, "m"), (theta, "rad")),
        _parameters(m="kg", k="J m"),
        [PointMass(m, (r * cos(theta), r * sin(theta)))],
        potential=-k / r,
    )
    yield System(
        "physical_pendulum",
        "Rigid body on a hinge",
        _coordinates((theta, "rad")),
        _parameters(m="kg", l="m", I="kg m^2", g="m/s^2"),
        [RigidBody(m, (l * sin(theta), -l * cos(theta)), I - m * l**2, theta)],
    )
    yield System(
        "cart_and_bar",
        "Cart with a hinged rigid body",
        _coordinates((x, "m"), (theta, "rad")),
        _parameters(M="kg", m="kg", l="m", I="kg m^2", g="m/s^2"),
        [PointMass(M, (x, 0)), RigidBody(m, (x + l * sin(theta), -l * cos(theta)), I, theta)],
    )
    for name, title, part in (
        ("uniform_rod", "Uniform rod on a hinge", 2),
        ("half_rod", "Uniform rod on a hinge, twice as long as its letter", 1),
    ):
        yield System(
            name, title,
            _coordinates((theta, "rad")),
            _parameters(m="kg", l="m", g="m/s^2"),
            [RigidBody(m, (l * sin(theta) / part, -l * cos(theta) / part),
                       m * (2 * l / part)**2 / 12, theta)],
        )  # fmt: skip
    A, W, W0 = symbols("A Omega omega0", positive=True)
    g = sp.Symbol("g", real=True)
    for name, title, mass, pull, constants in (
        (
            "forced_pendulum",
            "Pendulum with a harmonic torque",
            m,
            m * g * l,
            _parameters(m="kg", l="m", g="m/s^2", A="N m", Omega="1/s"),
        ),
        (
            "scaled_forced_pendulum",
            "Pendulum with a harmonic acceleration",
            1,
            W0**2,
            _parameters(A="1/s^2", Omega="1/s", omega0="1/s"),
        ),
    ):
        yield System(
            name, title, _coordinates((theta, "rad")), constants,
            [PointMass(mass, (l * theta if mass == m else theta, 0))],
            potential=-pull * cos(theta) - A * theta * cos(W * TIME),
        )  # fmt: skip
    for name, title, potential, constants in (
        (
            "attracted_mass",
            "Mass in the plane, in the field of another that is fixed",
            -G * M * m / sp.sqrt(x1**2 + x2**2),
            _parameters(m="kg", M="kg", G="m^3/(kg s^2)"),
        ),
        (
            "attracted_unit_mass",
            "Mass in the plane, in the field of a centre",
            -k * m / sp.sqrt(x1**2 + x2**2),
            _parameters(m="kg", k="m^3/s^2"),
        ),
        (
            "cubic_potential",
            "Henon and Heiles' star with a parameter of its cubic potential",
            (x1**2 + x2**2) / 2 * m + k * m * (x1**2 * x2 - x2**3 / 3),
            _parameters(m="kg", k="1/m"),
        ),
    ):
        yield System(
            name, title, _coordinates((x1, "m"), (x2, "m")), constants,
            [PointMass(m, (x1, x2))], potential=potential,
        )  # fmt: skip
    y1, y2 = symbols("y1 y2", real=True)
    yield System(
        "two_bodies", "Two masses in a plane that attract each other",
        _coordinates(*((one, "m") for one in (x1, y1, x2, y2))),
        _parameters(m1="kg", m2="kg", G="m^3/(kg s^2)"),
        [PointMass(m1, (x1, y1)), PointMass(m2, (x2, y2))],
        potential=-G * m1 * m2 / sp.sqrt((x2 - x1)**2 + (y2 - y1)**2),
    )  # fmt: skip
    a = sp.Symbol("a", real=True)
    yield System(
        "pushed_rod", "Uniform rod on a hinge with a given acceleration",
        _coordinates((theta, "rad")),
        [*_parameters(m="kg", l="m", g="m/s^2"), Parameter(a, "N/kg", 1.0, "")],
        [RigidBody(m, (l * sin(theta) / 2, -l * cos(theta) / 2), m * l**2 / 12, theta)],
        potential=m * l * (a * sin(theta) - g * cos(theta)) / 2,
    )  # fmt: skip
    for name, title, part in (
        ("cart_and_half_rod", "Cart with a uniform rod, twice as long as its letter", 1),
        ("cart_and_uniform_rod", "Cart with a uniform rod", 2),
    ):
        yield System(
            name, title,
            _coordinates((x, "m"), (theta, "rad")),
            _parameters(M="kg", m="kg", l="m", g="m/s^2"),
            [PointMass(M, (x, 0)),
             RigidBody(m, (x + l * sin(theta) / part, -l * cos(theta) / part),
                       m * (2 * l / part)**2 / 12, theta)],
        )  # fmt: skip
    yield System(
        "two_half_rods", "Two hinged uniform rods, twice as long as their letters",
        _coordinates((theta1, "rad"), (theta2, "rad")),
        _parameters(m1="kg", m2="kg", l1="m", l2="m", g="m/s^2"),
        [RigidBody(m1, (l1 * sin(theta1), -l1 * cos(theta1)), m1 * l1**2 / 3, theta1),
         RigidBody(m2, (2 * l1 * sin(theta1) + l2 * sin(theta2),
                        -2 * l1 * cos(theta1) - l2 * cos(theta2)), m2 * l2**2 / 3, theta2)],
    )  # fmt: skip
    heights = [l * cos(theta1), l * cos(theta2)]
    for name, title, stretch in (
        ("sideways_coupled_pendulums", "Two pendulums coupled by a spring that stays horizontal",
         l * sin(theta2) - l * sin(theta1)),
        ("twist_coupled_pendulums", "Two pendulums coupled by a torsion spring", theta2 - theta1),
    ):  # fmt: skip
        yield System(
            name, title,
            _coordinates((theta1, "rad"), (theta2, "rad")),
            _parameters(m="kg", l="m", k="N/m", g="m/s^2"),
            [PointMass(m, (l * sin(theta1), -heights[0])),
             PointMass(m, (l * sin(theta2), -heights[1]))],
            potential=k * stretch**2 / 2 - m * g * sum(heights),
        )  # fmt: skip
    yield System(
        "two_links", "Two hinged links with moments of inertia about their centres of mass",
        _coordinates((theta1, "rad"), (theta2, "rad")),
        _parameters(m1="kg", m2="kg", l1="m", r1="m", r2="m", I1="kg m^2", I2="kg m^2", g="m/s^2"),
        [RigidBody(m1, (r1 * sin(theta1), -r1 * cos(theta1)), I1, theta1),
         RigidBody(m2, (l1 * sin(theta1) + r2 * sin(theta2),
                        -l1 * cos(theta1) - r2 * cos(theta2)), I2, theta2)],
    )  # fmt: skip
    yield System(
        "two_links_about_joints", "Two hinged links with moments of inertia about their joints",
        _coordinates((theta1, "rad"), (theta2, "rad")),
        _parameters(m1="kg", m2="kg", l1="m", r1="m", r2="m", I1="kg m^2", I2="kg m^2", g="m/s^2"),
        [RigidBody(m1, (r1 * sin(theta1), -r1 * cos(theta1)), I1 - m1 * r1**2, theta1),
         RigidBody(m2, (l1 * sin(theta1) + r2 * sin(theta2),
                        -l1 * cos(theta1) - r2 * cos(theta2)), I2 - m2 * r2**2, theta2)],
    )  # fmt: skip
    Ir, gr = symbols("Ir gr", positive=True)
    yield System(
        "two_links_with_motors", "Two hinged links with moments of inertia and motors",
        _coordinates((theta1, "rad"), (theta2, "rad")),
        _parameters(m1="kg", m2="kg", l1="m", r1="m", r2="m", I1="kg m^2", I2="kg m^2",
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
        _coordinates((x1, "m"), (x2, "m")),
        _parameters(m1="kg", m2="kg", k1="N/m", k2="N/m", k3="N/m"),
        [PointMass(m1, (x1, 0)), PointMass(m2, (x2, 0))],
        potential=sum(
            sp.Symbol(name, positive=True) * length**2 / 2
            for name, length in (("k1", x1), ("k2", x2 - x1), ("k3", x2))
        ),
    )
    yield System(
        "bead_on_parabola",
        "Bead on a parabola",
        _coordinates((x, "m")),
        _parameters(m="kg", k="1/m", g="m/s^2"),
        [PointMass(m, (x, k * x**2))],
    )
    yield System(
        "projectile",
        "Mass in uniform gravity",
        _coordinates((x1, "m"), (x2, "m")),
        _parameters(m="kg", g="m/s^2"),
        [PointMass(m, (x1, x2))],
    )
    yield System(
        "cone",
        "Mass on a cone",
        _coordinates((r, "m"), (theta, "rad")),
        _parameters(m="kg", k="1", g="m/s^2"),
        [PointMass(m, (r * cos(theta), r * sin(theta), k * r))],
    )
    yield System(
        "atwood",
        "Two masses on a thread over a pulley",
        _coordinates((x, "m")),
        _parameters(m1="kg", m2="kg", g="m/s^2"),
        [PointMass(m1, (0, -x)), PointMass(m2, (0, x))],
    )


def _free() -> Iterator[System]:
    """Systems to which documents add constraints."""
    x, y, z, theta = symbols("x y z theta", real=True)
    r, a, m, J = symbols("r a m J", positive=True)
    yield System(
        "polar_mass", "Mass in polar coordinates", _coordinates((r, "m"), (theta, "rad")),
        _parameters(m="kg", g="m/s^2"), [PointMass(m, (r * sin(theta), -r * cos(theta)))],
    )  # fmt: skip
    yield System(
        "mass_in_space", "Mass in space in uniform gravity",
        _coordinates((x, "m"), (y, "m"), (z, "m")),
        _parameters(m="kg", g="m/s^2"), [PointMass(m, (x, y, z))],
    )  # fmt: skip
    place = _coordinates((x, "m"), (y, "m"), (theta, "rad"))
    body = [RigidBody(m, (x, y), J, theta)]
    inertia = _parameters(m="kg", J="kg m^2", g="m/s^2")
    yield System("body_in_plane", "Rigid body in a vertical plane", place, inertia, body)
    yield System(
        "body_on_plane", "Rigid body in a plane without gravity", place, inertia[:2], body,
        potential=sp.S.Zero,
    )  # fmt: skip
    yield System(
        "body_by_point", "Rigid body in a plane without gravity, by the place of one of its points",
        place, [*inertia[:2], *_parameters(a="m")],
        [RigidBody(m, (x + a * cos(theta), y + a * sin(theta)), J, theta)], potential=sp.S.Zero,
    )  # fmt: skip
