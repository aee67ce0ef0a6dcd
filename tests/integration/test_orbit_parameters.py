"""Families of periodic orbits in a parameter, beside closed forms and SciPy's integrators."""

from collections.abc import Mapping
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
import sympy as sp
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipk, mathieu_a, mathieu_b

import generated.driven_pendulum as driven
import generated.duffing as duffing
import generated.single_pendulum as single
from derive import TIME, Coordinate, Parameter, PointMass, System, velocity
from solvers.app.modules import build
from solvers.integration.orbits import continuation
from solvers.integration.orbits.family import SpecialOrbit
from solvers.integration.orbits.orbit_family import orbit_family
from solvers.integration.orbits.orbit_shooting import OrbitConditions, OrbitStart
from solvers.integration.orbits.periodic_orbit import periodic_orbit
from solvers.integration.orbits.symmetry import Nature, Reversal

DAMPED = {"a": 0.01, "Omega": 6.0, "c": 0.3}


@pytest.mark.long("other tests reach its code")
def test_resonances_of_the_driven_pendulum_are_mathieus() -> None:
    rest = periodic_orbit(driven, {"theta": 0.0}, 2 * np.pi / 5, {"a": 0.01, "Omega": 5.0})
    family = orbit_family(driven, rest, "a", (0.001, 3.0))
    assert family.ends == ("bound", "bound")
    assert family.values[[0, -1]] == pytest.approx([0.001, 3.0], rel=1e-12)
    # theta'' + (A - 2 q cos 2x) theta = 0 for 2x = Ωt, A = 4 g/(l Ω²), q = 2a/l
    stiffness = 4 * 9.81 / 25.0
    exact = [brentq(lambda q: mathieu_a(1, q) - stiffness, *ends) / 2 for ends in ((0, 2), (4, 6))]
    exact.append(brentq(lambda q: mathieu_b(2, q) - stiffness, 4, 6) / 2)
    kinds = [point.kind for point in family.special]
    assert kinds == ["period doubling", "period doubling", "branch point"]
    located = [point.orbit.params[2] for point in family.special]
    assert located == pytest.approx(exact, rel=1e-11)


def dop853_matrix(
    a: float, guess: np.ndarray, period: float, image: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    """An orbit of the driven pendulum, and its monodromy matrix, by SciPy's DOP853.

    With `image` = -1 the orbit is symmetric: y(t + period) = -y(t).
    """

    def rhs(t: float, z: np.ndarray) -> list[float]:
        theta, rate, *changes = z
        lift = 9.81 - a * 36.0 * np.cos(6.0 * t)
        c, d = changes[:2], changes[2:]
        slopes = [-lift * np.cos(theta) * x - 0.3 * v for x, v in zip(c, d, strict=True)]
        return [rate, -lift * np.sin(theta) - 0.3 * rate, *d, *slopes]

    y = guess.copy()
    for _ in range(12):
        start = [*y, 1.0, 0.0, 0.0, 1.0]
        end = solve_ivp(rhs, (0, period), start, method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
        end *= image
        matrix = end[2:].reshape(2, 2)
        step = np.linalg.solve(matrix - np.eye(2), y - end[:2])
        y += step
        if np.abs(step).max() < 1e-11:
            break
    return y, matrix


def branch(point: SpecialOrbit, high: float) -> SpecialOrbit:
    """The first special orbit of the family that branches off, up to an amplitude."""
    family = orbit_family(driven, point, "a", (0.0, high), direction=1)
    return next(found for found in family.special if found.kind != "turning point")


@pytest.mark.long("other tests reach its code")
def test_the_period_of_the_driven_pendulum_doubles() -> None:
    rest = periodic_orbit(driven, {"theta": 0.0}, 2 * np.pi / 6, DAMPED)
    (loses_rest,) = orbit_family(driven, rest, "a", (0.0, 0.2)).special
    assert loses_rest.kind == "period doubling"
    symmetric = branch(loses_rest, 1.0)  # in long steps
    assert symmetric.kind == "branch point"
    assert symmetric.orbit.period == pytest.approx(2 * rest.period, rel=1e-14)
    doubles = branch(symmetric, 0.32)
    assert doubles.kind == "period doubling"
    again = branch(doubles, 0.3215)
    assert again.kind == "period doubling"
    assert again.orbit.period == pytest.approx(4 * rest.period, rel=1e-14)

    y = doubles.orbit.y

    def multiplier(a: float) -> float:  # the determinant of the matrix plus 1
        nonlocal y
        y, matrix = dop853_matrix(a, y, 2 * rest.period)
        return float(np.linalg.det(matrix + np.eye(2)))

    # the symmetric orbit is one of the map y -> -y(T), whose period doubles where symmetry breaks
    half = symmetric.orbit.y

    def symmetric_multiplier(a: float) -> float:
        nonlocal half
        half, matrix = dop853_matrix(a, half, rest.period, -1.0)
        return float(np.linalg.det(matrix + np.eye(2)))

    a = symmetric.orbit.params[2]
    exact = brentq(symmetric_multiplier, a - 1e-4, a + 1e-4, xtol=1e-12)
    assert a == pytest.approx(exact, abs=1e-9)
    a = doubles.orbit.params[2]
    exact = brentq(multiplier, a - 1e-4, a + 1e-4, xtol=1e-12)
    assert a == pytest.approx(exact, abs=1e-9)


@pytest.mark.long("other tests reach its code")
def test_the_response_of_duffings_oscillator_turns_twice() -> None:
    params = {"Omega": 0.9, "F": 0.3}
    start = periodic_orbit(duffing, {"x": 0.3}, 2 * np.pi / 0.9, params)
    family = orbit_family(
        duffing, start, "Omega", (0.9, 2.5), period=lambda p: 2 * np.pi / p["Omega"]
    )
    assert family.ends == ("bound", "bound")
    assert [point.kind for point in family.special] == ["turning point"] * 2
    assert set(family.stability) == {"asymptotically stable", "unstable"}
    for point in family.special:
        orbit = point.orbit
        assert orbit.period == pytest.approx(2 * np.pi / orbit.params[5], rel=1e-14)
        # friction contracts areas by exp(-c T/m), and one multiplier is 1
        contraction = np.exp(-0.1 * orbit.period)
        assert orbit.multipliers == pytest.approx([1.0, contraction], abs=1e-7)
        assert np.trace(differences(orbit.y, orbit.period, duffing, orbit.params)) == pytest.approx(
            1 + contraction, abs=1e-7
        )


def differences(
    y: np.ndarray, period: float, module: ModuleType, params: tuple[float, ...]
) -> np.ndarray:
    """The monodromy matrix by differences of motions of SciPy's DOP853."""

    def end(start: np.ndarray) -> np.ndarray:
        options = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-13}
        return np.asarray(
            solve_ivp(module.rhs, (0, period), start, args=(params,), **options).y[:, -1]
        )

    columns = [
        (8 * (end(y + s) - end(y - s)) - end(y + 2 * s) + end(y - 2 * s)) / 12e-3
        for s in 1e-3 * np.eye(len(y))
    ]
    return np.array(columns).T


def van_der_pol() -> ModuleType:
    """x'' - mu (1 - x²) x' + x = F cos(Ωt)."""
    x, F = sp.symbols("x F", real=True)
    mu, Omega = sp.symbols("mu Omega", positive=True)
    return build(
        System(
            "forced_van_der_pol",
            "",
            [Coordinate(x, "m", "position")],
            [
                Parameter(mu, "1", 0.2, "damping"),
                Parameter(F, "N", 0.0, "force"),
                Parameter(Omega, "rad/s", 1.1, "frequency"),
            ],
            [PointMass(1, (x, 0))],
            x**2 / 2,
            forces=(mu * (1 - x**2) * velocity(x) + F * sp.cos(Omega * TIME),),
        )
    )


def test_limit_cycles_and_their_tori() -> None:
    module = van_der_pol()
    free = periodic_orbit(module, {"x": 2.0}, 6.3, {"mu": 1.0})
    assert free.period == pytest.approx(6.663286859323130, rel=1e-12)  # known to 16 digits
    assert free.stability == "asymptotically stable"
    family = orbit_family(module, free, "mu", (0.01, 2.0))
    assert family.ends == ("bound", "bound")
    assert family.special == []
    assert family.period[0] == pytest.approx(2 * np.pi * (1 + 0.01**2 / 16), rel=1e-8)
    # a strong force entrains the oscillation, a weaker one leaves a torus
    period = 2 * np.pi / 1.3
    forced = periodic_orbit(module, {"x": 0.0, "x_dot": -2.0}, period, {"F": 2.5, "Omega": 1.3})
    assert forced.stability == "asymptotically stable"
    family = orbit_family(module, forced, "F", (0.1, 2.5))
    tori = [point.orbit for point in family.special if point.kind == "Neimark-Sacker"]
    assert len(tori) == 1
    matrix = differences(tori[0].y, period, module, tori[0].params)
    assert np.linalg.det(matrix) == pytest.approx(1.0, abs=1e-8)
    assert abs(np.trace(matrix)) < 2


def test_orbits_of_one_period_in_a_parameter() -> None:
    start = periodic_orbit(single, {"theta": 1.0}, 2.2, {"l": 1.0}, symmetry=("theta_dot",))
    family = orbit_family(single, start, "l", (0.5, 2.0))
    assert family.ends[0] == "bound"
    assert family.period == pytest.approx(start.period, rel=1e-15)
    for orbit in family.orbits:
        modulus = np.sin(orbit.y[0] / 2) ** 2
        exact = 4 * ellipk(modulus) * np.sqrt(orbit.params[1] / 9.81)
        assert orbit.period == pytest.approx(exact, rel=1e-11)


def test_subharmonic_responses_form_a_closed_family() -> None:
    def period(by_name: Mapping[str, float]) -> float:
        return 6 * np.pi / by_name["Omega"]

    params = {"c": 0.02, "F": 1.0, "Omega": 4.5}
    start = periodic_orbit(duffing, {"x": 1.3}, period(params), params)
    family = orbit_family(duffing, start, "Omega", period=period)
    assert family.ends == ("closed", "closed")
    low, high = sorted(point.orbit.params[5] for point in family.special)
    assert family.values.min() >= low
    assert family.values.max() <= high
    for point in family.special:
        assert point.kind == "turning point"
        matrix = differences(point.orbit.y, point.orbit.period, duffing, point.orbit.params)
        assert np.linalg.det(matrix - np.eye(2)) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(
    ("module", "params", "y", "symmetry", "parameter"),
    [
        (driven, {"a": 0.2, "Omega": 6.0}, [0.8, 0.0], ("theta_dot",), "a"),
        (driven, {"a": 0.2, "Omega": 6.0}, [0.0, 2.0], ("theta",), "Omega"),
        (duffing, {"F": 0.3, "c": 0.0, "Omega": 1.3}, [0.5, 0.0], ("x_dot",), "beta"),
    ],
)
def test_half_a_period_has_the_derivatives_of_the_whole(
    module: ModuleType,
    params: dict[str, float],
    y: list[float],
    symmetry: tuple[str, ...],
    parameter: str,
) -> None:
    constants, index = np.array(module.params(**params)), module.PARAMETERS.index(parameter)

    def period(by_name: Mapping[str, float]) -> float:
        return 2 * np.pi / by_name["Omega"]

    orbit = periodic_orbit(module, y, period(params), params, symmetry=symmetry)
    point = OrbitStart(orbit.y, orbit.period, constants)
    nature = Nature.of(module, orbit.y, constants, index)
    reversal = Reversal.of(module, symmetry, orbit.y, constants)
    whole, half = (
        OrbitConditions(module, nature, 1e-12, 1e-12, r, index, period)(point)
        for r in (None, reversal)
    )
    assert np.abs(whole.residual).max() < 1e-10
    columns = [0, 1, 3]  # by the start and the parameter
    assert half.change[:, columns] == pytest.approx(whole.change[:, columns], abs=1e-8)


def test_arguments_of_families_are_checked() -> None:
    orbit = periodic_orbit(single, {"theta": 1.0}, 2.2, {"l": 1.0})
    with pytest.raises(ValueError, match=r"parameter = 'energi' \(did you mean 'energy'\?\)"):
        orbit_family(single, orbit, "energi")
    with pytest.raises(ValueError, match="exclude the start, energy"):
        orbit_family(single, orbit, bounds=(0.0, 1.0))
    with pytest.raises(ValueError, match="direction = 2 must be 0, 1 or -1"):
        orbit_family(single, orbit, direction=2)
    with pytest.raises(ValueError, match=r"start = 3\.0 must be a PeriodicOrbit or a SpecialOrbit"):
        orbit_family(single, 3.0)  # type: ignore[arg-type]
    rest = periodic_orbit(driven, {"theta": 0.0}, 2 * np.pi / 6, DAMPED)
    with pytest.raises(ValueError, match="driven_pendulum does not conserve its energy"):
        orbit_family(driven, rest)
    with pytest.raises(ValueError, match=r"period = .* is not one of driven_pendulum"):
        orbit_family(driven, rest, "Omega", (5.0, 7.0))


def test_families_of_more_than_one_dimension_are_refused() -> None:
    x, y = sp.symbols("x y", real=True)
    coordinates = [Coordinate(q, "m", "position") for q in (x, y)]
    masses = [PointMass(1, (q, 0)) for q in (x, y)]
    free = build(System("free_pair", "", coordinates, [], masses, (x - y) ** 2 + (x - y) ** 4))
    orbit = periodic_orbit(free, {"x": 0.4, "y": -0.4}, 2.4, {})
    assert orbit.defect < 1e-11
    with pytest.raises(ValueError, match="another quantity is conserved"):
        orbit_family(free, orbit)


def test_a_figure_marks_stability_and_special_orbits() -> None:
    rest = periodic_orbit(driven, {"theta": 0.0}, 2 * np.pi / 6, DAMPED)
    family = orbit_family(driven, rest, "a", (0.0, 0.2))
    (doubling,) = family.special
    branch = orbit_family(driven, doubling, "a", (0.0, 0.2), direction=1)
    (axes,) = family.figure("theta_dot", [branch]).axes
    assert axes.get_xlabel() == "$a$ / m"
    assert axes.get_ylabel() == r"$\dot{\theta}$ / (rad/s)"
    assert [text.get_text() for text in axes.get_legend().get_texts()] == [
        "stable", "unstable", "period doubling", "turning point",
    ]  # fmt: skip
    stable, unstable, *_ = axes.get_lines()
    assert (stable.get_linestyle(), unstable.get_linestyle()) == ("-", "--")
    assert stable.get_color() != unstable.get_color()
    located = doubling.orbit.params[2]
    assert stable.get_xdata()[-1] == unstable.get_xdata()[0] == located
    with pytest.raises(ValueError, match=r"quantity = 'perod' \(did you mean 'period'\?\)"):
        family.figure("perod")


def test_a_figure_shows_amplitudes_over_the_energy() -> None:
    # a pendulum of energy E swings to the angle at which its potential energy is E
    orbit = periodic_orbit(single, {"theta": 0.5}, 3.0, {})
    family = orbit_family(single, orbit, bounds=(-19.0, 15.0))
    (axes,) = family.figure().axes
    (line,) = axes.get_lines()
    energies, amplitudes = line.get_data()
    assert amplitudes == pytest.approx(np.arccos(-energies / (2 * 9.81)), rel=1e-8)
    assert np.array_equal(amplitudes, family.amplitudes[0])
    assert axes.get_ylabel() == r"amplitude of $\theta$ / rad"
    assert axes.get_xlabel() == "energy / J"
    # the drawn curve fills the axes
    for limits, values in ((axes.get_xlim(), energies), (axes.get_ylim(), amplitudes)):
        assert np.ptp(values) > 0.85 * np.ptp(limits)
    assert np.array_equal(
        family.figure("amplitude of theta").axes[0].lines[0].get_ydata(), amplitudes
    )
    with pytest.raises(ValueError, match="did you mean 'amplitude of theta'"):
        family.figure("amplitude of thet")


def test_a_table_of_a_family() -> None:
    rest = periodic_orbit(driven, {"theta": 0.0}, 2 * np.pi / 6, DAMPED)
    family = orbit_family(driven, rest, "a", (0.0, 0.2))
    table = family.to_table()
    assert list(table) == [
        "theta", "theta_dot", "period", "energy", "a", "multiplier_1", "multiplier_2", "stability",
    ]  # fmt: skip
    assert {len(column) for column in table.values()} == {len(family.orbits)}
    assert "period doubling at 0.0680894450" in repr(family)
    assert "unstable" in repr(family.orbits[-1])


def test_multipliers_decide_on_special_orbits() -> None:
    rng = np.random.default_rng(5)
    basis = rng.normal(size=(4, 4))

    def node(*multipliers: complex) -> Any:
        blocks = np.zeros((4, 4))
        k = 0
        for value in multipliers:
            if isinstance(value, complex):  # and its conjugate
                blocks[k : k + 2, k : k + 2] = [[value.real, value.imag], [-value.imag, value.real]]
            else:
                blocks[k, k] = value
            k += 1 + isinstance(value, complex)
        matrix = basis @ blocks @ np.linalg.inv(basis)
        shot, point = SimpleNamespace(monodromy=matrix), SimpleNamespace(y=np.zeros(4))
        return SimpleNamespace(shot=shot, point=point, reduced=matrix)

    one = node(-2.0, 0.5, -1.0, -0.4)
    direction = continuation.doubling_direction(one)
    assert np.linalg.norm(direction) > 0.1
    assert direction[4:].tolist() == [0.0, 0.0]
    assert_allclose(one.shot.monodromy @ direction[:4], -direction[:4], atol=1e-12)
    assert continuation.period_doubling(one) == pytest.approx(0.0, abs=1e-12)
    one = node(-2.0, 0.5, -0.9, -0.4)
    assert continuation.period_doubling(one) == pytest.approx(-1.0 * 1.5 * 0.1 * 0.6)
    # a pair on the circle, inside and outside
    pairs = [node(size * np.exp(0.7j), 0.3, -0.2) for size in (0.9, 1.0, 1.1)]
    inside, on, outside = map(continuation.neimark_sacker, pairs)
    assert on == pytest.approx(0.0, abs=1e-12)
    assert inside * outside < 0
    others = np.prod([abs(value * 1.1 * np.exp(0.7j) - 1) ** 2 for value in (0.3, -0.2)])
    assert outside == pytest.approx((1.21 - 1) * (-0.06 - 1) * others)


@pytest.mark.parametrize(("beta", "largest"), [(0.0, 0.1), (0.5, 0.05), (2.0, 0.2)])
def test_steps_in_a_parameter_without_bounds_are_relative_to_its_start_or_to_one(
    beta: float, largest: float
) -> None:
    params = {"beta": beta, "F": 0.01, "Omega": 4.0, "c": 0.1}  # a response that hardly changes
    start = periodic_orbit(duffing, {"x": 0.0}, np.pi / 2, params)
    family = orbit_family(duffing, start, "beta", direction=1, max_orbits=6, max_step=0.1)
    assert np.diff(family.values).max() == pytest.approx(largest, rel=1e-3)
