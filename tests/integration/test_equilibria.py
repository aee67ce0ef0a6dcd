"""Equilibria: all of them, in closed form or in a box, with their stability and frequencies."""

import math
from collections.abc import Callable
from itertools import combinations_with_replacement
from operator import add, mul, sub, truediv
from typing import Any

import numpy as np
import pytest
import sympy as sp
from cart_pole import F, cart_pole, x
from numpy.testing import assert_allclose

from derive import Coordinate, Derivation, Parameter, PointMass, System, load, with_inputs
from derive.system.parts import SystemDefinitionError
from solvers import build, equilibria
from solvers import load as module_of
from solvers.equations.linearisation.intervals import FUNCTIONS, Interval, select

cart = build(cart_pole)
hoop = module_of("rotating_hoop")
#: The angular velocity at which a bead at the bottom of a hoop of 1 m becomes unstable.
CRITICAL = math.sqrt(9.81)


def test_a_double_pendulum_has_four() -> None:
    closed = Derivation(load("double_pendulum")).equilibria()
    angles = {tuple(map(float, equilibrium.values())) for equilibrium in closed}
    assert angles == {(a, b) for a in (0, math.pi) for b in (0, math.pi)}
    found = equilibria(module_of("double_pendulum"), {})
    assert_allclose([e.y[:2] for e in found], sorted(angles), atol=1e-9)
    assert [e.stability for e in found] == ["neutral", "unstable", "unstable", "unstable"]


def test_three_pendulums_on_a_cart_have_eight_for_every_position() -> None:
    found = Derivation(load("cart_3")).equilibria()
    assert len(found) == 8
    position = next(q for q in found[0] if q.name == "x")
    assert all(equilibrium[position] == position for equilibrium in found)


@pytest.mark.parametrize(("sign", "count"), [(1, 0), (-1, 1)])
def test_a_positive_coordinate_has_positive_values_alone(sign: int, count: int) -> None:
    r, s, m = sp.symbols("r s m", positive=True)
    coordinates = [Coordinate(one, "m", "distance") for one in (r, s)]
    system = System(
        "radial", "Radial", coordinates, [Parameter(m, "kg", 1, "mass")],
        [PointMass(m, (r, s))], potential=(r + sign * s) ** 2, gravity=(0, 0),
    )  # fmt: skip
    assert len(Derivation(system).equilibria()) == count


@pytest.mark.parametrize("ratio", [0.5, 0.999, 1.001, 1.5, 10.0])
def test_a_pitchfork_on_a_rotating_hoop_is_found(ratio: float) -> None:
    Omega = ratio * CRITICAL
    found = equilibria(hoop, {"Omega": Omega, "R": 1.0})
    angles = [float(e.y[0]) for e in found]
    if ratio < 1:
        assert_allclose(angles, [0.0, np.pi], atol=1e-7)
        assert [e.stability for e in found] == ["neutral", "unstable"]
        return
    tilted = math.acos(9.81 / Omega**2)
    assert_allclose(angles, [-tilted, 0.0, tilted, np.pi], atol=1e-7)
    assert [e.stability for e in found] == ["neutral", "unstable", "neutral", "unstable"]
    expected = Omega * math.sin(tilted) / (2 * math.pi)
    assert found[2].modes[0].frequency == pytest.approx(expected, rel=1e-6)


def test_the_pitchfork_has_a_closed_form() -> None:
    (angle,) = load("rotating_hoop").q
    found = [equilibrium[angle] for equilibrium in Derivation(load("rotating_hoop")).equilibria()]
    names = {s.name: s for s in load("rotating_hoop").params}
    tilted = sp.acos(names["g"] / (names["Omega"] ** 2 * names["R"]))
    assert {*found} == {sp.S.Zero, sp.pi, tilted, 2 * sp.pi - tilted}


@pytest.mark.parametrize("stiffness", [1.0, 30.0, 100.0])
def test_indices_on_a_torus_add_up_to_zero(stiffness: float) -> None:
    """Poincaré and Hopf: no equilibrium is missing. The bobs, far apart, never meet."""
    found = equilibria(module_of("coupled_pendulums"), {"k": stiffness, "d": 3.0, "l": 1.0})
    indices = [np.sign(np.linalg.det(e.A[2:, :2])) for e in found]
    assert len(found) >= 4
    assert sum(indices) == 0
    assert max(np.abs(e.rate).max() for e in found) < 1e-8


def test_equilibria_of_other_systems_are_known() -> None:
    saddles = [(-math.sqrt(3) / 2, -0.5), (0, 0), (0, 1), (math.sqrt(3) / 2, -0.5)]
    found = equilibria(module_of("henon_heiles"), {}, {"x": (-2, 2), "y": (-2, 2)})
    assert_allclose([e.y[:2] for e in found], saddles, atol=1e-9)
    assert equilibria(module_of("henon_heiles"), {}, {"x": (0.1, 0.5), "y": (-2, 2)}) == []
    spring = module_of("elastic_pendulum")
    m, k, length, g = (spring.DEFAULTS[spring.PARAMETERS.index(p)] for p in "mklg")
    found = equilibria(spring, {}, {"r": (0.05, 5)})
    assert_allclose(
        [e.y[:2] for e in found],
        [(length - m * g / k, math.pi), (length + m * g / k, 0)],
        atol=1e-9,
    )


def test_singular_points_are_no_equilibria() -> None:
    mass, c = sp.symbols("m c", positive=True)
    bead = System(
        "bead", "A bead with a singular potential", [Coordinate(x, "m", "position")],
        [Parameter(mass, "kg", 1.0, ""), Parameter(c, "N", 4.0, "")],
        [PointMass(mass, (x, 0))], potential=1 / x + c * x,
    )  # fmt: skip
    roots = {equilibrium[x] for equilibrium in Derivation(bead).equilibria()}
    assert roots == {1 / sp.sqrt(c), -1 / sp.sqrt(c)}
    found = equilibria(build(bead), {}, {"x": (-1.3, 1.0)})
    assert_allclose([e.y[0] for e in found], [-0.5, 0.5], atol=1e-9)


def test_saturated_feedback_has_equilibria_on_both_branches() -> None:
    """Where the torque is saturated: m g l sin θ ± 0.1 cos θ = 0."""
    feedback = {"F": "cosh(x_dot) - 1", "T": "max(-0.1, min(0.1, 2*theta))"}
    closed = build(with_inputs(cart_pole, feedback))
    tilt = math.pi - math.atan(0.1 / (0.2 * 9.81 * 0.3))
    found = equilibria(closed, {}, {"x": 0.0})
    assert_allclose([e.y[1] for e in found], [-tilt, 0.0, tilt], atol=1e-9)
    assert found[1].A[3, 1] > found[0].A[3, 1]
    unknown = build(with_inputs(cart_pole, {"T": "atan2(2, theta)"}))
    with pytest.raises(ValueError, match="their functions must be among sin, cos"):
        equilibria(unknown, {}, {"x": 0.0})


def test_inputs_move_equilibria() -> None:
    """A torque T cos θ on the pole: m g l sin θ + T cos θ = 0."""
    found = equilibria(cart, {}, {"x": 0.0}, inputs={"T": 0.1})
    tilt = math.atan(0.1 / (0.2 * 9.81 * 0.3))
    assert_allclose([e.y[1] for e in found], [-tilt, math.pi - tilt], atol=1e-9)
    assert [e.stability for e in found] == ["unstable", "neutral"]
    closed = Derivation(cart_pole).equilibria({"F": 0})
    values = {
        s: sp.Float(str(v))
        for s, v in zip(cart_pole.params, (0.5, 0.2, 0.3, 0.1, 9.81, 0, 0.1), strict=True)
    }
    angles = sorted(float(e[cart_pole.q[1]].subs(values)) for e in closed)
    assert_allclose(angles, [-tilt, math.pi - tilt], atol=1e-9)
    assert all(equilibrium[x] == x for equilibrium in closed)
    assert equilibria(cart, {}, {"x": 0.0}, inputs={"F": 0.1}) == []
    assert Derivation(cart_pole).equilibria() == []
    assert F in cart_pole.u


def test_invalid_searches_are_refused() -> None:
    invalid: list[tuple[Any, dict[str, Any], Any, str]] = [
        (cart, {}, {}, "box lacks x: give its range"),
        (cart, {}, {"x": (1, 0)}, r"box\['x'\] = .1, 0. must be a pair"),
        (cart, {}, {"x": 0, "y": 1}, "box has 'y'"),
        (cart, {}, {"x": (0, np.nan)}, "must be a finite real number in m"),
        (cart, {}, {"x": (-1, 1)}, "not isolated"),
        (module_of("heavy_top"), {}, {}, "such as box={'phi': 0.0}"),
        (module_of("driven_pendulum"), {}, {}, "depend on time"),
    ]
    for module, params, box, message in invalid:
        with pytest.raises(ValueError, match=message):
            equilibria(module, params, box)
    with pytest.raises(SystemDefinitionError, match=r"no closed form .*solvers\.equilibria"):
        Derivation(load("coupled_pendulums")).equilibria()


@pytest.mark.parametrize("name", FUNCTIONS)
def test_intervals_contain_all_values_and_little_more(name: str) -> None:
    generator = np.random.default_rng(3)
    ends = np.sort(generator.uniform(0.01, 9, (2, 400)) * (1 if name in ("log", "sqrt") else -1), 0)
    if name == "tan":
        ends[1] = np.minimum(ends[1], ends[0] + 0.3)
    values = FUNCTIONS[name](Interval(*ends))
    exact = np.vectorize(getattr(math, name))
    inner = exact(np.linspace(*ends, 101))
    assert (values.low <= inner.min(axis=0)).all()
    assert (values.high >= inner.max(axis=0)).all()
    if name != "tan":
        width = np.abs(inner).max(axis=0) + 1e-3
        assert (values.high - inner.max(axis=0) <= 0.02 * width).all()
        assert (inner.min(axis=0) - values.low <= 0.02 * width).all()


def test_intervals_of_arithmetic_contain_all_values() -> None:
    generator = np.random.default_rng(4)
    a, b = (np.sort(generator.uniform(-3, 3, (2, 300)), 0) for _ in range(2))
    for u, v in ((a[0], b[1]), (a[1], b[0]), (a.mean(0), b.mean(0))):
        p, q = Interval(*a), Interval(*b)
        for interval, value in (
            (p + q, u + v), (p - q, u - v), (p * q, u * v), (p / q, u / v),
            (2.0 - p, 2 - u), (1.0 / q, 1 / v), (p * 3.0 - 1.0, 3 * u - 1), (-p, -u),
        ):  # fmt: skip
            assert ((interval.low <= value) & (value <= interval.high)).all()


#: Intervals between these numbers, and numbers within each of them.
ENDS = (-math.inf, -7.0, -2.0, -0.5, 0.0, 0.5, 2.0, 7.0, math.inf)
SPECIAL = np.array([(a, b) for a, b in combinations_with_replacement(ENDS, 2)
                    if a < math.inf and b > -math.inf]).T  # fmt: skip
WITHIN = np.clip([*np.linspace(-9, 9, 73), -300.0, 300.0], *SPECIAL[..., np.newaxis])


def check_bounds(found: Interval, values: np.ndarray, is_tight: np.ndarray) -> None:
    """Whether intervals contain the values in rows, and no others where they are tight."""
    values = np.where(np.isfinite(values), values, np.nan)
    low, high = np.nanmin(values, axis=1), np.nanmax(values, axis=1)
    assert not ((found.low > low) | (found.high < high)).any()
    assert not (np.isnan(found.low) | np.isnan(found.high)).any()
    close = 1e-12 * (1 + np.abs(low) + np.abs(high))
    assert (low - found.low <= close)[is_tight].all()
    assert (found.high - high <= close)[is_tight].all()


@pytest.mark.parametrize("operation", [add, sub, mul, truediv])
def test_arithmetic_of_intervals_with_zeros_and_infinite_ends(
    operation: Callable[[Any, Any], Any],
) -> None:
    n = len(SPECIAL[0])
    first, second = np.repeat(np.arange(n), n), np.tile(np.arange(n), n)
    with np.errstate(all="ignore"):
        found = operation(Interval(*SPECIAL[:, first]), Interval(*SPECIAL[:, second]))
        few = WITHIN[:, ::3]
        values = operation(few[first][:, :, np.newaxis], few[second][:, np.newaxis])
        both = np.isfinite(SPECIAL).all(axis=0)
        divides = (SPECIAL > 0).all(axis=0) | (SPECIAL < 0).all(axis=0)
        is_tight = both[first] & both[second]
        if operation is truediv:
            is_tight &= divides[second]
        known = np.isfinite(values).any(axis=(1, 2))  # not those over 0 alone
        check_bounds(Interval(found.low[known], found.high[known]),
                     values.reshape(n * n, -1)[known], is_tight[known])  # fmt: skip
        for number in (-3.0, 0.0, 2.5):
            whole = Interval(*SPECIAL)
            check_bounds(operation(whole, number or 1.0), operation(WITHIN, number or 1.0), both)
            if operation is not truediv:
                check_bounds(operation(number, whole), operation(number, WITHIN), both)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_of_intervals_with_zeros_and_infinite_ends(name: str) -> None:
    ordinary = np.vectorize(getattr(math, name))
    low, high = SPECIAL
    domain = {"log": high > 0, "sqrt": high >= 0}.get(name, high > -math.inf)
    inner = {"log": low > 0, "sqrt": low >= 0, "tan": low == high}.get(name, low > -math.inf)
    least = {"log": 1e-30, "sqrt": 0.0}.get(name, -200.0)
    with np.errstate(all="ignore"):
        found = FUNCTIONS[name](Interval(*SPECIAL))
    values = ordinary(np.clip(WITHIN, least, 200.0)[domain])
    is_exact = inner & np.isfinite(SPECIAL).all(axis=0)
    if name in ("sin", "cos"):
        is_exact &= low == high
        assert found.low.min() >= -1 - 1e-12
        assert found.high.max() <= 1 + 1e-12
    check_bounds(Interval(found.low[domain], found.high[domain]), values, is_exact[domain])


@pytest.mark.parametrize("pair", [((-1.0, 2.0), (1.0, 4.0)), ((1.0, 4.0), (-1.0, 2.0))])
def test_a_choice_of_intervals_is_made_where_the_condition_has_one_sign(
    pair: tuple[tuple[float, float], tuple[float, float]],
) -> None:
    (low, high), n = SPECIAL, len(SPECIAL[0])
    chosen, other = (Interval(*np.tile(np.transpose([ends]), n)) for ends in pair)
    found = select(Interval(low, high), chosen, other)
    for k in range(n):
        expected = pair[0] if low[k] > 0 else pair[1] if high[k] < 0 else (-1.0, 4.0)
        assert (found.low[k], found.high[k]) == expected


def test_a_denominator_of_several_coordinates_is_no_equation() -> None:
    y, k = sp.symbols("y k", real=True)
    well = System(
        "well", "", [Coordinate(x, "m", ""), Coordinate(y, "m", "")], [Parameter(k, "J", 1.0, "")],
        [PointMass(1, (x, y))], k * sp.log(1 + x**2 + y**2),
    )  # fmt: skip
    assert Derivation(well).equilibria() == [{x: 0, y: 0}]


def test_steady_motions_of_a_spherical_pendulum() -> None:
    spherical, g = module_of("spherical_pendulum"), 9.81
    rate = 5.0
    cone, *others = equilibria(
        spherical, {"l": 0.8}, {"theta": (0.1, 3.1)}, velocities={"phi_dot": rate}
    )
    assert not others
    angle = math.acos(g / (0.8 * rate**2))
    assert cone.y == pytest.approx((angle, 0.0, 0.0, rate), abs=1e-12)
    assert abs(cone.rate[2:]).max() < 1e-12
    # about it the angle oscillates with this frequency, at constant angular momentum
    frequency = rate * math.sqrt(1 + 3 * math.cos(angle) ** 2) / (2 * math.pi)
    assert cone.modes[-1].frequency == pytest.approx(frequency, rel=1e-9)
    assert cone.stability == "neutral"
    # the angle is given, and the velocity results
    (turning,) = equilibria(spherical, {}, {"theta": 0.7}, velocities={"phi_dot": (0.1, 20)})
    length = dict(zip(spherical.PARAMETERS, spherical.DEFAULTS, strict=True))["l"]
    assert turning.y[3] == pytest.approx(math.sqrt(g / (length * math.cos(0.7))), rel=1e-12)
    closed = Derivation(load("spherical_pendulum")).equilibria({"phi_dot": rate})
    cosines = [sp.cos(e[sp.Symbol("theta", real=True)]) for e in closed]
    assert any(
        c == sp.Symbol("g", real=True) / (25 * sp.Symbol("l", positive=True)) for c in cosines
    )


def test_a_pole_on_a_cart_that_moves() -> None:
    moving = equilibria(module_of("cart_1"), {}, velocities={"x_dot": 3.0})
    angles = [point.y[1] for point in moving]
    assert angles == pytest.approx([0.0, math.pi])
    assert [point.y[2] for point in moving] == [3.0, 3.0]
    assert [point.stability for point in moving] == ["neutral", "unstable"]


@pytest.mark.parametrize(
    ("velocities", "message"),
    [
        ({"theta_dot": 1.0}, "forces depend on theta"),
        ({"phi": 1.0}, "velocities has 'phi'"),
        ({"phi_dot": "fast"}, r"velocities\['phi_dot'\]"),
        ({"phi_dot": (2.0, 1.0)}, r"velocities\['phi_dot'\] = \(2.0, 1.0\) must be a pair"),
    ],
)
def test_invalid_velocities_are_refused(velocities: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        equilibria(module_of("spherical_pendulum"), {}, velocities=velocities)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_constraint_may_have_one_sign_in_the_whole_box(sign: int) -> None:
    """A bead rests at the bottom of a parabola, below which the box is."""
    y, g = sp.symbols("y g", real=True)
    parabola = System(
        "parabola", "", [Coordinate(s, "m", "position") for s in (x, y)],
        [Parameter(g, "m/s^2", 9.81, "gravity")], [PointMass(1, (x, y))],
        constraints=[sign * (y - 500 * x**2)], keep_coordinates=True,
    )  # fmt: skip
    (bottom,) = equilibria(build(parabola), {}, {"x": (-2e-3, 1e-3), "y": (-1e-3, 0.0)})
    assert_allclose(bottom.y, 0.0, atol=1e-12)
    frequency = math.sqrt(2 * 500 * 9.81) / (2 * math.pi)
    assert bottom.modes[-1].frequency == pytest.approx(frequency, rel=1e-9)


@pytest.mark.parametrize("length", [1.3e-9, 1.3, 1.3e6])
def test_all_accelerations_can_vanish_in_the_box(length: float) -> None:
    """A pendulum in Cartesian coordinates, on the vertical through its pivot."""
    y, pivot, g, rod = sp.symbols("y pivot g rod", real=True)
    pendulum = System(
        "pendulum", "", [Coordinate(s, "m", "position") for s in (x, y)],
        [Parameter(g, "m/s^2", 9.81, "gravity"), Parameter(rod, "m", length, "length"),
         Parameter(pivot, "m", 0.37 * length, "place of the pivot")],
        [PointMass(0.7, (x, y))], constraints=[(x - pivot) ** 2 + y**2 - rod**2],
        keep_coordinates=True,
    )  # fmt: skip
    box = {"x": 0.37 * length, "y": (-2 * length, 2 * length)}
    heights = sorted(float(one.y[1]) for one in equilibria(build(pendulum), {}, box))
    assert_allclose(heights, [-length, length], rtol=1e-12)
