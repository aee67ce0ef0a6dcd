"""Random systems as textbooks treat them, from which documents are written."""

from collections.abc import Callable, Sequence
from random import Random

import sympy as sp
from sympy import Rational, cos, log, sin

from derive.system.parts import Coordinate, Parameter, PointMass
from derive.system.rigid_body import RigidBody
from derive.system.system import System

theta, theta1, theta2, phi, x, y, x1, x2, r, s = sp.symbols(
    "theta theta1 theta2 phi x y x1 x2 r s", real=True
)
m, m1, m2, l, l1, l2, k, k1, k2, k3, a, R, J = sp.symbols(  # noqa: E741
    "m m1 m2 l l1 l2 k k1 k2 k3 a R J", positive=True
)
g, alpha, Omega = sp.symbols("g alpha Omega", positive=True)

ANGLES = (theta, theta1, theta2, phi)
#: Angles from the vertical, which can also be measured from elsewhere.
TURNING = (theta, theta1, theta2)
UNITS = {"m": "kg", "l": "m", "k": "N/m", "a": "m", "R": "m", "J": "kg m^2", "g": "m/s^2"}

#: Coordinates, masses, and the potential energy beside that of the weight; None without weight.
Parts = tuple[Sequence[sp.Symbol], Sequence[PointMass], sp.Expr | None, sp.Expr]
Family = Callable[[Random], Parts]


def treated_system(family: Family, pick: Random, shift: sp.Expr = sp.S.Zero) -> System:
    """A system of a family, with angles from hanging plus a shift."""
    q, masses, gravity, potential = family(pick)
    turned = {one: one + shift for one in q if one in TURNING}
    masses = [one.mapped(lambda e: e.xreplace(turned)) for one in masses]
    weight = sp.Add(*((gravity or 0) * one.mass * one.position[-1] for one in masses))
    V = sp.expand(sp.sympify(potential).xreplace(turned) + weight)
    V = V.func(*(term for term in sp.Add.make_args(V) if term.free_symbols & {*q}))
    terms = [V, *(e for one in masses for e in (one.mass, *one.position))]
    terms += [one.inertia for one in masses if isinstance(one, RigidBody)]
    parameters = sorted(sp.Tuple(*terms).free_symbols - {*q}, key=str)
    return System(
        family.__name__, family.__name__.replace("_", " "),
        [Coordinate(one, "rad" if one in ANGLES else "m", "a coordinate") for one in q],
        [Parameter(p, UNITS.get(p.name[0], "1"), 1.0, "a parameter") for p in parameters],
        masses, potential=V, gravity=(sp.S.Zero,) * len(masses[0].position),
    )  # fmt: skip


def pendulum(pick: Random) -> Parts:
    return (theta,), [_hung(m, l, theta)], g, pick.choice((0, k * theta**2 / 2))


def body_on_a_hinge(pick: Random) -> Parts:
    return (theta,), [RigidBody(m, (a * sin(theta), -a * cos(theta)), J, theta)], g, sp.S.Zero


def double_pendulum(pick: Random) -> Parts:
    ends = [l1 * sin(theta1), -l1 * cos(theta1)]
    second = (ends[0] + l2 * sin(theta2), ends[1] - l2 * cos(theta2))
    return (theta1, theta2), [PointMass(m1, ends), PointMass(m2, second)], g, sp.S.Zero


def cart_with_a_pendulum(pick: Random) -> Parts:
    bob = PointMass(m2, (x + l * sin(theta), -l * cos(theta)))
    return (x, theta), [PointMass(m1, (x, 0)), bob], g, pick.choice((0, k * x**2 / 2))


def spring_pendulum(pick: Random) -> Parts:
    return (r, theta), [_hung(m, r, theta)], g, k * (r - a) ** 2 / 2


def bead_on_a_curve(pick: Random) -> Parts:
    curve = pick.choice((alpha * x**2 / 2, alpha * x**3, a * cos(alpha * x), alpha * x**4))
    return (x,), [PointMass(m, (x, curve))], g, pick.choice((0, k * x**2 / 2))


def bead_on_a_turning_hoop(pick: Random) -> Parts:
    """In the potential of the weight and of the centrifugal force."""
    V = -m * R**2 * Omega**2 * sin(theta) ** 2 / 2
    return (theta,), [_hung(m, R, theta)], g, V


def central_force(pick: Random) -> Parts:
    field = pick.choice((-k / r, k * r**2 / 2, alpha * r**4, k * log(r / a), -k / r**2, 0))
    return (r, phi), [PointMass(m, (r * cos(phi), r * sin(phi)))], None, sp.sympify(field)


def spherical_pendulum(pick: Random) -> Parts:
    place = (l * sin(theta) * cos(phi), l * sin(theta) * sin(phi), -l * cos(theta))
    return (theta, phi), [PointMass(m, place)], g, sp.S.Zero


def two_masses_between_springs(pick: Random) -> Parts:
    V = k1 * x1**2 / 2 + k2 * (x2 - x1) ** 2 / 2 + pick.choice((0, k3 * x2**2 / 2))
    return (x1, x2), [PointMass(m1, (x1, 0)), PointMass(m2, (x2, 0))], None, V


def swinging_weights(pick: Random) -> Parts:
    return (r, theta), [PointMass(m1, (0, r)), _hung(m2, r, theta)], g, sp.S.Zero


def block_on_a_wedge(pick: Random) -> Parts:
    block = PointMass(m2, (x + s * cos(alpha), -s * sin(alpha)))
    return (x, s), [PointMass(m1, (x, 0)), block], g, pick.choice((0, k * s**2 / 2))


def rolling_disc(pick: Random) -> Parts:
    disc = RigidBody(m, (x * cos(alpha), -x * sin(alpha)), m * R**2 / 2, x / R)
    return (x,), [disc], g, pick.choice((0, k * x**2 / 2))


def support_on_a_spring(pick: Random) -> Parts:
    bob = PointMass(m2, (l * sin(theta), y - l * cos(theta)))
    return (y, theta), [PointMass(m1, (0, y)), bob], g, k * y**2 / 2


def disc_with_a_pendulum(pick: Random) -> Parts:
    """A disc that turns about its centre, with a pendulum on its rim."""
    disc = RigidBody(m1, (0, 0), m1 * R**2 / 2, theta1)
    bob = (R * sin(theta1) + l * sin(theta2), -R * cos(theta1) - l * cos(theta2))
    return (theta1, theta2), [disc, PointMass(m2, bob)], g, sp.S.Zero


def mass_on_a_surface(pick: Random) -> Parts:
    height = pick.choice((alpha * r, alpha * r**2 / 2, -a / r))
    return (r, phi), [PointMass(m, (r * cos(phi), r * sin(phi), height))], g, sp.S.Zero


def nonlinear_spring(pick: Random) -> Parts:
    V = pick.choice((k * x**2 / 2, -k * x**2 / 2, 0)) + alpha * x**4 / 4
    return (x,), [PointMass(m, (x, 0))], None, V


def cart_with_spring_pendulum(pick: Random) -> Parts:
    bob = PointMass(m2, (x + r * sin(theta), -r * cos(theta)))
    return (x, r, theta), [PointMass(m1, (x, 0)), bob], g, k * (r - a) ** 2 / 2


def mass_in_space(pick: Random) -> Parts:
    V = k * (x**2 + y**2 + s**2) / 2 + pick.choice((0, alpha * x * y, alpha * x**2 * s))
    return (x, y, s), [PointMass(m, (x, y, s))], None, V


def turning_rod_with_a_slider(pick: Random) -> Parts:
    rod = RigidBody(m1, (0, 0), m1 * a**2 * Rational(1, 12), phi)
    slider = PointMass(m2, (r * cos(phi), r * sin(phi)))
    return (r, phi), [rod, slider], None, pick.choice((0, k * (r - a) ** 2 / 2))


FAMILIES: tuple[Family, ...] = (
    pendulum, body_on_a_hinge, double_pendulum, cart_with_a_pendulum, spring_pendulum,
    bead_on_a_curve, bead_on_a_turning_hoop, central_force, spherical_pendulum,
    two_masses_between_springs, swinging_weights, block_on_a_wedge, rolling_disc,
    support_on_a_spring, disc_with_a_pendulum, mass_on_a_surface, nonlinear_spring,
    cart_with_spring_pendulum, mass_in_space, turning_rod_with_a_slider,
)  # fmt: skip


def _hung(mass: sp.Symbol, length: sp.Symbol, angle: sp.Symbol) -> PointMass:
    return PointMass(mass, (length * sin(angle), -length * cos(angle)))
