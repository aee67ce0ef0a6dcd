"""Masses in fields, in programs that state accelerations alone."""

from collections.abc import Iterator
from itertools import combinations

from sympy import Expr, Symbol, cos, sin, sqrt, symbols

from derive.system.parts import PointMass
from derive.system.symbols import TIME, velocity
from derive.system.system import System
from derive.verification.documents.letters.known_systems.parts_by_name import g, lengths, parameters

x, y, z = symbols("x y z", real=True)
m, M, G, k, l, c, mu, q, B, r = symbols("m M G k l c mu q B r", positive=True)
Omega, latitude = symbols("Omega latitude", positive=True)


def systems_in_fields() -> Iterator[System]:
    """Masses in fields: of centres, of each other, uniform ones."""
    for name, strength, constants in (
        ("mass", G * M * m, parameters(m="kg", M="kg", G="m^3/(kg s^2)")),
        ("unit_mass", k * m, parameters(m="kg", k="m^3/s^2")),
    ):
        yield System(
            f"falling_{name}", "Mass that falls to a centre", lengths(r), constants,
            [PointMass(m, (r, 0))], potential=-strength / r,
        )  # fmt: skip
    for place in ((x, y), (x, y, z)):
        yield from _about_a_centre(place)
        yield from _in_uniform_gravity(place)
        yield _of_three_bodies(place)
        yield _charged(place)
    yield System(
        "cubic_potential", "Henon and Heiles' star with a parameter of its cubic potential",
        lengths(x, y), parameters(m="kg", k="1/m"), [PointMass(m, (x, y))],
        potential=(x**2 + y**2) / 2 * m + k * m * (x**2 * y - y**3 / 3),
    )  # fmt: skip
    for count, dimension in ((2, 2), (3, 2), (2, 3)):
        yield _attracting(count, dimension)
    yield System(
        "small_foucault", "Foucault's pendulum at small angles", lengths(x, y),
        parameters(g="m/s^2", l="m", Omega="rad/s", latitude="rad"), [PointMass(1, (x, y))],
        potential=g * (x**2 + y**2) / (2 * l),
        forces=[2 * Omega * sin(latitude) * velocity(y), -2 * Omega * sin(latitude) * velocity(x)],
    )  # fmt: skip


def _distance(place: tuple[Symbol, ...]) -> Expr:
    return sqrt(sum(one**2 for one in place))


def _about_a_centre(place: tuple[Symbol, ...]) -> Iterator[System]:
    where, n = "in the plane" if len(place) == 2 else "in space", len(place)
    distance = _distance(place)
    yield System(
        f"attracted_mass_{n}", f"Mass {where}, in the field of another that is fixed",
        lengths(*place), parameters(m="kg", M="kg", G="m^3/(kg s^2)"), [PointMass(m, place)],
        potential=-G * M * m / distance,
    )  # fmt: skip
    yield System(
        f"attracted_unit_mass_{n}", f"Mass {where}, in the field of a centre", lengths(*place),
        parameters(m="kg", k="m^3/s^2"), [PointMass(m, place)], potential=-k * m / distance,
    )  # fmt: skip
    yield System(
        f"mass_on_spring_{n}", f"Mass on a spring {where}, in gravity", lengths(*place),
        parameters(m="kg", k="N/m", l="m", g="m/s^2"), [PointMass(m, place)],
        potential=k * (distance - l)**2 / 2 + m * g * place[-1],
    )  # fmt: skip


def _in_uniform_gravity(place: tuple[Symbol, ...]) -> Iterator[System]:
    speed = _distance(tuple(map(velocity, place)))
    for name, title, drag, constants in (
        ("drag", "quadratic drag", c * speed, parameters(m="kg", c="kg/m", g="m/s^2")),
        ("drag_by_mass", "quadratic drag by mass", c * m * speed,
         parameters(m="kg", c="1/m", g="m/s^2")),
        ("linear_drag_by_mass", "drag by mass", c * m, parameters(m="kg", c="1/s", g="m/s^2")),
    ):  # fmt: skip
        yield System(
            f"projectile_with_{name}_{len(place)}", f"Mass in uniform gravity with {title}",
            lengths(*place), constants, [PointMass(m, place)],
            potential=m * g * place[-1], forces=[-drag * velocity(one) for one in place],
        )  # fmt: skip
    if len(place) == 3:
        yield System(
            "thrown_mass", "Mass in uniform gravity, in space", lengths(*place),
            parameters(m="kg", g="m/s^2"), [PointMass(m, place)], potential=m * g * z,
        )  # fmt: skip


def _of_three_bodies(place: tuple[Symbol, ...]) -> System:
    """The restricted problem of three bodies in the rotating frame, in its usual units."""
    first, *rest = place
    turned = (x * cos(TIME) - y * sin(TIME), x * sin(TIME) + y * cos(TIME), *place[2:])
    return System(
        f"restricted_three_bodies_{len(place)}",
        "Circular restricted problem of three bodies, in the rotating frame",
        lengths(*place), parameters(mu="1"), [PointMass(1, turned)],
        potential=-(1 - mu) / _distance((first + mu, *rest))
        - mu / _distance((first - 1 + mu, *rest)),
    )  # fmt: skip


def _charged(place: tuple[Symbol, ...]) -> System:
    return System(
        f"charged_mass_{len(place)}", "Charge in a uniform magnetic field", lengths(*place),
        parameters(m="kg", q="C", B="T"), [PointMass(m, place)], potential=0,
        forces=[q * B * velocity(y), -q * B * velocity(x), *(0 for _ in place[2:])],
    )  # fmt: skip


def _attracting(count: int, dimension: int) -> System:
    where = "in a plane" if dimension == 2 else "in space"
    places = [symbols(f"x{i} y{i} z{i}", real=True)[:dimension] for i in range(1, count + 1)]
    masses = [Symbol(f"m{i}", positive=True) for i in range(1, count + 1)]
    pairs = combinations(zip(masses, places, strict=True), 2)
    potential = sum(
        -G * a * b / _distance(tuple(u - v for u, v in zip(p, q, strict=True)))
        for (a, p), (b, q) in pairs
    )
    units = {one.name: "kg" for one in masses}
    return System(
        f"bodies_{count}_{dimension}", f"{count} masses {where} that attract each other",
        lengths(*(one for place in places for one in place)),
        parameters(**units, G="m^3/(kg s^2)"),
        [PointMass(a, p) for a, p in zip(masses, places, strict=True)], potential=potential,
    )  # fmt: skip
