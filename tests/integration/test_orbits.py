"""Transition matrices, periodic orbits and Lyapunov spectra, beside closed forms."""

from collections.abc import Mapping
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp
from scipy.special import ellipk
from velocity_constraints import CASES, stated

import generated.double_pendulum as dp
import generated.driven_pendulum as driven
import generated.elastic_pendulum as ep
import generated.four_bar as four_bar
import generated.henon_heiles as henon
import generated.single_pendulum as single
import generated.swinging_atwood as atwood
from derive import Coordinate, Parameter, PointMass, System
from solvers.app.modules import build
from solvers.equations.consistent_start import consistent_start
from solvers.equations.linearisation.normal_modes import Modes
from solvers.integration.integrate import integrate
from solvers.integration.orbits import orbit_shooting
from solvers.integration.orbits.periodic_orbit import NoPeriodicOrbitError, periodic_orbit
from solvers.integration.prepare import NotFinishedError
from solvers.integration.problem.events import Event
from solvers.integration.problem.status import Status
from solvers.integration.variations.lyapunov_spectrum import lyapunov_spectrum
from solvers.integration.variations.transition_matrix import Tangents, transition_matrix

DAMPED = {"a": 0.3, "Omega": 6.0, "c": 0.3}


def _by_differences(
    module: ModuleType, end: float, y0: np.ndarray, params: Mapping[str, float]
) -> np.ndarray:
    """The transition matrix by fourth-order differences of whole motions."""
    columns = []
    for change in 1e-3 * np.eye(len(y0)):
        ends = [
            integrate(
                module, (0, end), y0 + k * change, params, method="gauss8", rtol=1e-14, atol=1e-14
            ).y[:, -1]
            for k in (-2, -1, 1, 2)
        ]  # fmt: skip
        columns.append((ends[0] - 8 * ends[1] + 8 * ends[2] - ends[3]) / (12 * change.sum()))
    return np.array(columns).T


@pytest.mark.parametrize(
    ("module", "y0", "params"),
    [
        (dp, [1.0, 1.5, 0.2, -0.3], {"m2": 0.5}),
        (ep, [1.2, 0.3, 0.0, 0.5], {"k": 40.0}),
        (driven, [0.5, 0.1], DAMPED),
    ],
)
def test_a_transition_matrix_is_the_derivative_by_the_start(
    module: ModuleType, y0: list[float], params: Mapping[str, float]
) -> None:
    found = transition_matrix(module, (0, 1.5), y0, params)
    exact = _by_differences(module, 1.5, np.array(y0), params)
    assert np.abs(found.matrix - exact).max() < 1e-8 * np.abs(exact).max()


def test_transition_matrices_multiply() -> None:
    whole = transition_matrix(dp, (0, 2), [2.0, 1.0, 0.0, 0.0], {})
    first = transition_matrix(dp, (0, 1.3), [2.0, 1.0, 0.0, 0.0], {})
    second = transition_matrix(dp, (1.3, 2), first.y, {})
    assert second.y == pytest.approx(whole.y, abs=1e-10)
    assert np.abs(second.matrix @ first.matrix - whole.matrix).max() < 1e-9


def test_a_motion_that_stops_has_no_transition_matrix() -> None:
    with pytest.raises(NotFinishedError) as raised:  # the thread's length becomes 0
        transition_matrix(atwood, (0, 10), {"r": 1.0, "theta": 0.0, "r_dot": -30.0}, {})
    assert raised.value.status is Status.OUTSIDE_DOMAIN
    assert raised.value.t < 0.1


@pytest.mark.long("other tests reach its code")
def test_the_transition_matrix_of_two_springs() -> None:
    x = sp.Symbol("x", real=True)
    system = System(
        "two_springs", "", [Coordinate(x, "m", "position")], [], [PointMass(1, (x, 0))],
        sp.Max(0, x) ** 2, forces=(-x,),
    )  # fmt: skip
    # stiffness 3 where x > 0, else 1: from x = 1 at rest over half a period of each
    stiff = np.sqrt(3)
    period = np.pi / stiff + np.pi
    result = transition_matrix(build(system), (0, period), {"x": 1.0}, {})
    assert result.y == pytest.approx((1.0, 0.0), abs=1e-10)
    assert result.matrix == pytest.approx(np.eye(2), abs=1e-9)
    quarter = transition_matrix(build(system), (0, np.pi / (2 * stiff) + 1), {"x": 1.0}, {})
    expected = [[0.0, 1 / stiff], [-stiff, 0.0]]
    rest = [[np.cos(1), np.sin(1)], [-np.sin(1), np.cos(1)]]
    assert quarter.matrix == pytest.approx(np.array(rest) @ expected, abs=1e-10)


def test_compiled_and_python_tangents_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    ends = []
    for compiled in (True, False):
        two, fine = np.eye(4)[:, :2], {"rtol": 1e-11, "atol": 1e-11}
        motion = Tangents(dp, (0, 1), [1.0, 2.0, 0.0, 0.0], {}, two, **fine)
        if not compiled:
            motion._program = None
        motion.advance(0.4)
        motion.changes = motion.changes[:, ::-1]
        motion.advance(1.0)
        ends.append(np.column_stack([motion.y, motion.changes]))
    assert np.abs(ends[0] - ends[1]).max() < 1e-8


def test_the_period_of_a_pendulum_is_an_elliptic_integral() -> None:
    orbit = periodic_orbit(single, {"theta": 1.0}, 2.1, {"l": 1.0})
    energy = single.energy(0.0, orbit.y.tolist(), (1.0, 1.0, 9.81)) + 9.81
    modulus = energy / (2 * 9.81)
    assert orbit.y[0] == pytest.approx(1.0, abs=0.1)  # the nearest member of the family
    assert orbit.period == pytest.approx(4 * ellipk(modulus) / np.sqrt(9.81), rel=1e-11)
    assert orbit.multipliers == pytest.approx([1.0, 1.0], abs=1e-5)


@pytest.mark.parametrize("symmetry", [(), ("theta",)])
@pytest.mark.parametrize("speed", [8.0, -8.0])
def test_a_rotation_returns_after_a_whole_turn(symmetry: tuple[str, ...], speed: float) -> None:
    start = {"theta": 0.0, "theta_dot": speed}
    orbit = periodic_orbit(single, start, 1.0, {"l": 1.0}, symmetry=symmetry)
    assert orbit.y[1] == pytest.approx(speed, abs=1.0)  # the nearest member of the family
    energy = single.energy(0.0, orbit.y.tolist(), (1.0, 1.0, 9.81)) + 9.81
    square = 2 * 9.81 / energy
    assert orbit.period == pytest.approx(2 * ellipk(square) * np.sqrt(2 / energy), rel=1e-11)


def test_orbits_are_born_at_normal_modes() -> None:
    modes = Modes.at_rest(dp, dp.DEFAULTS)
    for frequency, shape in zip(modes.frequencies, modes.shapes.T, strict=True):
        start = 0.02 * shape / np.abs(shape).max()
        orbit = periodic_orbit(dp, [*start, 0.0, 0.0], 2 * np.pi / frequency, {})
        assert orbit.defect < 1e-10
        assert np.abs(orbit.y[:2]).max() > 0.01  # not the equilibrium
        assert orbit.period == pytest.approx(2 * np.pi / frequency, rel=1e-3)
        assert np.abs(orbit.multipliers) == pytest.approx([1.0] * 4, abs=1e-4)


def test_floquet_multipliers_of_a_driven_pendulum_multiply_to_liouvilles_factor() -> None:
    period = 4 * np.pi / 6
    orbit = periodic_orbit(driven, {"theta": 1.0}, period, DAMPED)
    assert orbit.period == period
    again = integrate(driven, (0, 5 * period), orbit.y, DAMPED, rtol=1e-12, atol=1e-12).y[:, -1]
    turns = np.round((again - orbit.y)[0] / (2 * np.pi)) * 2 * np.pi
    assert again - orbit.y == pytest.approx([turns, 0.0], abs=1e-8)
    # m l^2 = 1, so that the friction c = 0.3 contracts areas by exp(-0.3 t)
    assert np.prod(orbit.multipliers).real == pytest.approx(np.exp(-0.3 * period), rel=1e-9)


def test_no_orbit_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(NoPeriodicOrbitError, match="equilibrium"):
        periodic_orbit(single, {"theta": 1e-9}, 2.0, {"l": 1.0})
    with monkeypatch.context() as patch:
        patch.setattr("solvers.integration.orbits.orbit_newton.MAX_ITERATIONS", 1)
        with pytest.raises(NoPeriodicOrbitError, match=r"still changes.*better guess"):
            periodic_orbit(single, {"theta": 1.0}, 2.0, {"l": 1.0})
    with pytest.raises(ValueError, match=r"period = 0.9 s is not one of driven_pendulum"):
        periodic_orbit(driven, {"theta": 1.0}, 0.9, DAMPED)
    with pytest.raises(ValueError, match="period = -1"):
        periodic_orbit(single, {"theta": 1.0}, -1.0, {})


def test_exponents_of_a_system_without_friction_come_in_pairs() -> None:
    found = lyapunov_spectrum(dp, [np.pi / 2, np.pi, 0.0, 0.0], {}, 1000.0)
    assert abs(found.exponents.sum()) < 1e-7
    assert found.exponents[0] == pytest.approx(-found.exponents[3], abs=0.01)
    assert found.exponents[0] == pytest.approx(0.9, abs=5 * found.errors[0])
    assert np.abs(found.exponents[1:3]).max() < 0.02


def test_exponents_at_an_equilibrium_are_those_of_its_linearisation() -> None:
    # upright pendulum: theta'' = g/l theta
    found = lyapunov_spectrum(single, {"theta": np.pi}, {"l": 1.0}, 10.0, interval=0.5)
    assert found.exponents == pytest.approx([np.sqrt(9.81), -np.sqrt(9.81)], abs=0.2)
    # friction makes them add up to its coefficient
    fine = {"rtol": 1e-12, "atol": 1e-12}
    damped = lyapunov_spectrum(driven, {"theta": 1.0}, DAMPED, 100.0, **fine)
    assert damped.exponents.sum() == pytest.approx(-0.3, abs=1e-9)


def test_a_spectrum_needs_enough_intervals() -> None:
    with pytest.raises(ValueError, match=r"duration = 10 s must be at least 20 intervals of 2.0 s"):
        lyapunov_spectrum(dp, {"theta1": 1.0, "theta2": 1.0}, {}, 10)


def energy_of(module: ModuleType, y: object) -> float:
    """The energy of a state with the default parameters."""
    return float(module.energy(0.0, list(np.asarray(y)), module.DEFAULTS))


@pytest.mark.parametrize(
    ("energy", "y", "y_dot"),
    [(0.01, -0.08, 0.05), (0.05, 0.2, -0.1), (0.08, -0.1, -0.02), (0.12, 0.1, 0.15)],
)
def test_a_section_holds_the_energy_of_the_guess(energy: float, y: float, y_dot: float) -> None:
    x_dot = np.sqrt(2 * energy - y**2 + 2 * y**3 / 3 - y_dot**2)
    section = Event(henon, "x", 0.0, direction=1)
    orbit = periodic_orbit(henon, [0.0, y, x_dot, y_dot], section, {})
    assert orbit.y[0] == 0.0
    assert orbit.energy == pytest.approx(energy, abs=1e-12)
    # an independent integrator, with the equations by hand
    motion = solve_ivp(
        lambda t, s: [s[2], s[3], -s[0] - 2 * s[0] * s[1], -s[1] - s[0] ** 2 + s[1] ** 2],
        (0, orbit.period), orbit.y, "DOP853", rtol=1e-13, atol=1e-13,
    )  # fmt: skip
    assert motion.y[:, -1] == pytest.approx(orbit.y, abs=1e-9)


@pytest.mark.parametrize(
    ("start", "period"),
    [
        ((-0.24, -0.04, -0.01), 6.0),
        ((0.14, 0.27, -0.13), 5.5),
        ((0.05, -0.02, 0.16), 6.6),
        ((0.28, -0.12, -0.11), 5.5),
    ],
)
def test_a_guess_of_the_period_leads_to_no_equilibrium(
    start: tuple[float, float, float], period: float
) -> None:
    # the periods of small motions are near 2π: undamped steps lead to the origin
    orbit = periodic_orbit(henon, [0.0, *start], period, {})
    assert orbit.energy > 0.01
    assert orbit.defect < 1e-12


def test_an_orbit_of_a_given_energy() -> None:
    # -g l cos(theta) of the pendulum with m = l = 1 at its turning point
    amplitude, g = 2.0, 9.81
    orbit = periodic_orbit(single, {"theta": 1.9}, 2.5, {"l": 1.0}, energy=-g * np.cos(amplitude))
    assert orbit.energy == pytest.approx(-g * np.cos(amplitude), abs=1e-11)
    exact = 4 * ellipk(np.sin(amplitude / 2) ** 2) / np.sqrt(g)
    assert orbit.period == pytest.approx(exact, rel=1e-11)


@pytest.fixture(scope="module")
def kepler() -> ModuleType:
    """A planet of mass 1 about a fixed centre."""
    (x, y), mu = sp.symbols("x y", real=True), sp.Symbol("mu", positive=True)
    coordinates = [Coordinate(x, "m", "position"), Coordinate(y, "m", "position")]
    parameters = [Parameter(mu, "m^3/s^2", 1, "mass of the centre, times the constant of gravity")]
    potential = -mu / sp.sqrt(x**2 + y**2)
    return build(System("planet", "", coordinates, parameters, [PointMass(1, (x, y))], potential))


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("eccentricity", [0.0, 0.3, 0.6, 0.9])
def test_keplers_orbits_are_all_periodic(kepler: ModuleType, eccentricity: float) -> None:
    start = [1 - eccentricity, 0.0, 0.0, np.sqrt((1 + eccentricity) / (1 - eccentricity))]
    guesses: list[tuple[float | Event, dict[str, tuple[str, ...]]]] = [
        (Event(kepler, "y", 0.0, direction=1), {}),
        (6.0, {}),
        (6.0, {"symmetry": ("y", "x_dot")}),
    ]
    for guess, options in guesses:
        orbit = periodic_orbit(kepler, start, guess, {}, **options)
        assert orbit.energy == pytest.approx(-0.5, abs=1e-12 if isinstance(guess, Event) else 0.02)
        assert orbit.period == pytest.approx(2 * np.pi * (-2 * orbit.energy) ** -1.5, rel=1e-8)
        assert orbit.multipliers == pytest.approx([1.0] * 4, abs=1e-5)


@pytest.mark.parametrize("eccentricity", [0.0, 0.3, 0.7])
def test_periods_on_a_section_may_be_hours(kepler: ModuleType, eccentricity: float) -> None:
    lowest, mu = 7e6, 3.986e14  # of a satellite of the earth
    start = (lowest, 0, 0, np.sqrt(mu * (1 + eccentricity) / lowest))
    section = Event(kepler, "y", 0.0, direction=1)
    orbit = periodic_orbit(kepler, start, section, {"mu": mu})
    third_law = 2 * np.pi * np.sqrt((lowest / (1 - eccentricity)) ** 3 / mu)
    assert orbit.period == pytest.approx(third_law, rel=1e-12)


@pytest.mark.parametrize("options", [{}, {"symmetry": ("y", "x_dot")}])
def test_a_guessed_period_may_be_hours(kepler: ModuleType, options: dict[str, Any]) -> None:
    lowest, mu, eccentricity = 7e6, 3.986e14, 0.6
    start = (lowest, 0, 0, np.sqrt(mu * (1 + eccentricity) / lowest))
    guess = 1.05 * 2 * np.pi * np.sqrt((lowest / (1 - eccentricity)) ** 3 / mu)
    orbit = periodic_orbit(kepler, start, guess, {"mu": mu}, **options)
    third_law = 2 * np.pi * np.sqrt((-mu / (2 * orbit.energy)) ** 3 / mu)
    assert orbit.period == pytest.approx(third_law, rel=1e-12)


@pytest.mark.long("another kind of constraints")
def test_an_orbit_keeps_constraints() -> None:
    # it has one degree of freedom, and each motion between two points of rest is periodic
    start = consistent_start(four_bar, {"phi": 2.0}, {}).y
    at_rest = Event(four_bar, "phi_dot", 0.0, direction=1)
    motion = integrate(four_bar, (0, 2), start, {}, events=at_rest, rtol=1e-12, atol=1e-12)
    period = float(motion.t_events[0][0])
    held = energy_of(four_bar, start)
    orbit = periodic_orbit(four_bar, start, 1.03 * period, {}, energy=held)
    assert orbit.period == pytest.approx(period, abs=1e-9)
    residuals = four_bar.constraints(0.0, orbit.y.tolist(), four_bar.DEFAULTS)
    assert np.abs(residuals).max() < 1e-12
    with pytest.raises(ValueError, match="four_bar, which has constraints"):
        periodic_orbit(four_bar, start, period, {}, symmetry=four_bar.STATE[3:])


def test_an_orbit_keeps_integrals_of_constraints() -> None:
    wheel = build(stated("wheel", *CASES["wheel"][:2]))
    start = consistent_start(wheel, CASES["wheel"][2], {}).y
    # (M + J/R²) x'' = -k x + ..., whatever the amplitude and the integral x - R phi
    period = 2 * np.pi * np.sqrt((1.5 + 0.04 / 0.3**2) / 6.0)
    orbit = periodic_orbit(wheel, start, 1.1 * period, {})
    assert orbit.period == pytest.approx(period, rel=1e-11)
    assert orbit.y[0] - 0.3 * orbit.y[1] == pytest.approx(start[0] - 0.3 * start[1], abs=1e-11)


def test_an_energy_that_cannot_be_held_is_refused() -> None:
    with pytest.raises(ValueError, match=r"energy = 1.0 cannot be held: driven_pendulum does not"):
        periodic_orbit(driven, {"theta": 1.0}, 4 * np.pi / 6, DAMPED, energy=1.0)
    with pytest.raises(ValueError, match="energy"):
        periodic_orbit(single, {"theta": 1.0}, 2.0, {}, energy=np.nan)
    below = -20.0  # that of the equilibrium is -9.81 J
    with pytest.raises(NoPeriodicOrbitError, match=r"with an energy of -20\.0 J"):
        periodic_orbit(single, {"theta": 1.0}, 2.0, {}, energy=below)


def test_motions_of_very_many_steps_are_no_way_to_an_orbit(monkeypatch: pytest.MonkeyPatch) -> None:
    """A swing of 2 s from rest at 1 rad takes more than 5 steps at 1e-12."""
    monkeypatch.setattr(orbit_shooting, "MOST_STEPS", 5)
    with pytest.raises(NotFinishedError, match="the maximum number of steps was reached"):
        periodic_orbit(single, {"theta": 1.0}, 2.0, {})


def test_a_guess_need_not_be_on_the_section() -> None:
    section = Event(henon, "x", 0.0, direction=1)
    guess = [0.02, -0.08, 0.1, 0.05]
    orbit = periodic_orbit(henon, guess, section, {})
    assert orbit.y[0] == 0.0
    assert orbit.y[2] > 0.0
    assert orbit.energy == pytest.approx(energy_of(henon, guess), rel=1e-8)
