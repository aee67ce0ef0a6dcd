"""Families of periodic orbits, beside closed forms, expansions and another integrator."""

from types import ModuleType

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

import generated.double_pendulum as dp
import generated.duffing as duffing
import generated.elastic_pendulum as elastic
import generated.foucault_pendulum as foucault
import generated.henon_heiles as henon
import generated.single_pendulum as single
from solvers.equations.linearisation.equilibria import equilibria
from solvers.equations.linearisation.linear_system import linearise
from solvers.integration.orbits.normal_mode import backbone_slope, normal_mode_orbit
from solvers.integration.orbits.orbit_family import orbit_family
from solvers.integration.orbits.periodic_orbit import NoPeriodicOrbitError, periodic_orbit
from solvers.integration.problem.events import Event

#: Duffing's oscillator without force and friction.
FREE = {"c": 0.0, "F": 0.0, "beta": 2.0, "k": 3.0, "m": 0.5}


def pendulum_period(y: np.ndarray, length: float) -> mp.mpf:
    """The period of a swing through a state, with 30 digits."""
    with mp.workdps(30):
        square = mp.mpf(9.81) / mp.mpf(length)
        angle, rate = map(mp.mpf, y.tolist())
        modulus = mp.sin(angle / 2) ** 2 + rate**2 / (4 * square)
        return 4 * mp.ellipk(modulus) / mp.sqrt(square)


def duffing_period(y: np.ndarray) -> mp.mpf:
    """The period of m x'' + k x + beta x³ = 0 through a state, with 30 digits."""
    with mp.workdps(30):
        x, rate = map(mp.mpf, y.tolist())
        stiff, cubic = mp.mpf(FREE["k"] / FREE["m"]), mp.mpf(FREE["beta"] / FREE["m"])
        energy = rate**2 / 2 + stiff * x**2 / 2 + cubic * x**4 / 4
        top = (mp.sqrt(stiff**2 + 4 * cubic * energy) - stiff) / cubic  # amplitude squared
        scale = stiff + cubic * top
        return 4 * mp.ellipk(cubic * top / (2 * scale)) / mp.sqrt(scale)


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("symmetry", [(), ("theta_dot",)])
def test_the_backbone_of_the_pendulum_is_an_elliptic_integral(symmetry: tuple[str, ...]) -> None:
    start = periodic_orbit(single, {"theta": 0.4}, 2.0, {"l": 1.0}, symmetry=symmetry)
    family = orbit_family(single, start, bounds=(-np.inf, 9.8), rtol=1e-14, atol=1e-14)
    assert family.ends == ("equilibrium", "bound")
    assert family.special == []
    assert family.energy[-1] == pytest.approx(9.8, rel=1e-14)
    assert family.y[0].max() > 2.0
    assert family.period[-1] > 2.5 * family.period[0]
    for orbit in family.orbits:
        exact = pendulum_period(orbit.y, 1.0)
        assert abs(orbit.period / exact - 1) < 1e-12
        assert orbit.stability == "neutral"
    shown = family.sampled_motions()
    assert len({one.label for one in shown}) == 5
    for one in shown:  # one period each, which ends where it starts
        assert one.t[-1] == pytest.approx(float(pendulum_period(one.y[:, 0], 1.0)), rel=1e-11)
        assert one.y[:, -1] == pytest.approx(one.y[:, 0], abs=1e-7)
    assert shown[0].y[0].max() < 0.2 < 2.0 < shown[-1].y[0].max()


@pytest.mark.parametrize("bound", [-9.8, -9.805])
def test_a_family_ends_at_a_bound_close_to_an_equilibrium(bound: float) -> None:
    start = periodic_orbit(single, {"theta": 0.4}, 2.0, {"l": 1.0}, symmetry=("theta_dot",))
    family = orbit_family(single, start, bounds=(bound, 5.0))  # at rest the energy is -9.81 J
    assert family.ends == ("bound", "bound")
    assert family.energy[0] == pytest.approx(bound, rel=1e-13)


@pytest.mark.long("other tests reach its code")
def test_the_backbone_of_duffings_oscillator_is_an_elliptic_integral() -> None:
    start = periodic_orbit(duffing, {"x": 0.5}, 2.5, FREE)
    assert start.multipliers.tolist() == [1.0, 1.0]  # no force, no explicit time
    family = orbit_family(duffing, start, bounds=(-np.inf, 100.0))
    assert family.ends == ("equilibrium", "bound")
    assert family.period[-1] < family.period[0] / 2
    for orbit in family.orbits:
        assert abs(orbit.period / duffing_period(orbit.y) - 1) < 1e-12


def expansion(q: list[sp.Symbol], v: list[sp.Symbol], lagrangian: sp.Expr, k: int) -> list[float]:
    """dT/da² of each normal mode, slowest first, by the mean of the Lagrangian over the mode.

    With q = a s cos(ωt) the mean of L is a² (ω² m - κ)/4 + a⁴ c, and stationary in a; terms of
    order a³ of the motion do not change it at this order. `k` is the coordinate with amplitude a.
    """
    e, phase = sp.symbols("e phase")
    scaled = lagrangian.subs({x: e * x for x in (*q, *v)}, simultaneous=True)
    quartic = sp.expand(sp.series(scaled, e, 0, 5).removeO())
    assert quartic.coeff(e, 3) == 0
    second, fourth = quartic.coeff(e, 2), quartic.coeff(e, 4)
    mass, stiffness = sp.hessian(second, v), -sp.hessian(second, q)
    slopes = []
    matrices = [np.array(matrix.tolist(), float) for matrix in (stiffness, mass)]
    for square, vector in zip(*map(np.transpose, eigh(*matrices)), strict=True):
        shape, frequency = vector / vector[k], float(np.sqrt(square))
        values = {x: s * sp.cos(phase) for x, s in zip(q, shape, strict=True)}
        values |= {x: -frequency * s * sp.sin(phase) for x, s in zip(v, shape, strict=True)}
        mean = sp.integrate(sp.expand(fourth.subs(values)), (phase, 0, 2 * sp.pi)) / (2 * sp.pi)
        inertia = shape @ matrices[1] @ shape
        slopes.append(float(8 * sp.pi * mean / (inertia * frequency**3)))
    return slopes


def test_families_are_born_at_both_normal_modes_of_the_double_pendulum() -> None:
    q, v = list(sp.symbols("q1:3")), list(sp.symbols("v1:3"))
    m2, l2, g = sp.Rational(1, 2), sp.Rational(3, 2), sp.Rational(981, 100)
    kinetic = 2 * (1 + m2) * v[0] ** 2 + m2 * l2**2 * v[1] ** 2 / 2
    kinetic += 2 * m2 * l2 * v[0] * v[1] * sp.cos(q[0] - q[1])
    potential = -2 * (1 + m2) * g * sp.cos(q[0]) - m2 * g * l2 * sp.cos(q[1])
    rest = linearise(dp, {"theta1": 0.0, "theta2": 0.0}, {"m2": 0.5, "l2": 1.5})
    for n, mode in enumerate(rest.modes):
        k = int(np.argmax(np.abs(mode.shape)))
        exact = expansion(q, v, kinetic - potential, k)[n]
        assert backbone_slope(dp, rest, mode) == pytest.approx(exact, rel=1e-8)
        orbit = normal_mode_orbit(dp, rest, mode, 0.2)
        assert orbit.y[k] == pytest.approx(0.2, rel=1e-14)


@pytest.mark.long("other tests reach its code")
def test_slopes_at_birth_of_closed_forms() -> None:
    rest = linearise(single, {"theta": 0.0}, {"l": 1.0})
    exact = np.pi / 8 / np.sqrt(9.81)
    assert backbone_slope(single, rest, rest.modes[0]) == pytest.approx(exact, rel=1e-9)
    free = linearise(duffing, {"x": 0.0}, FREE)  # ω² = k/m + 3 beta a²/4m
    slope = -np.pi / np.sqrt(6.0) ** 3 * 3.0
    assert backbone_slope(duffing, free, free.modes[0]) == pytest.approx(slope, rel=1e-9)
    springs = linearise(elastic, {"r": 1.0 + 9.81 / 90.0, "theta": 0.0}, {"k": 90.0})
    assert backbone_slope(elastic, springs, springs.modes[1]) == pytest.approx(0.0, abs=1e-10)


def test_a_mode_without_a_family_is_an_error() -> None:
    damped = linearise(duffing, {"x": 0.0}, {"F": 0.0, "c": 0.1})
    with pytest.raises(ValueError, match="must oscillate without damping"):
        normal_mode_orbit(duffing, damped, damped.modes[0], 0.1)
    driven = linearise(duffing, {"x": 0.0}, {"F": 0.0, "c": -0.1})  # it grows
    with pytest.raises(ValueError, match="must oscillate without damping"):
        normal_mode_orbit(duffing, driven, driven.modes[0], 0.1)
    resonant = linearise(elastic, {"r": 4 / 3, "theta": 0.0}, {"k": 3 * 9.81, "l": 1.0})
    with pytest.raises(ValueError, match="in resonance"):
        normal_mode_orbit(elastic, resonant, resonant.modes[0], 0.1)
    moving = linearise(single, {"theta": 0.5}, {})
    with pytest.raises(ValueError, match="is no equilibrium"):
        normal_mode_orbit(single, moving, moving.modes[0], 0.1)


def test_families_of_the_double_pendulum_end_at_its_equilibria() -> None:
    rest = equilibria(dp, {})[0]
    for mode, end in zip(rest.modes, (58.86, 58.86), strict=True):
        family = orbit_family(dp, normal_mode_orbit(dp, rest, mode, 0.1))
        assert family.ends[0] == "equilibrium"
        assert family.ends[1].startswith("perturbations grow by more than 1e+10")
        assert family.energy[-1] == pytest.approx(end, rel=0.02)  # of the upright equilibrium
        assert family.energy[0] == pytest.approx(-58.86, rel=1e-3)


def dop853_monodromy(y: np.ndarray, period: float, module: ModuleType) -> np.ndarray:
    """The monodromy matrix by differences of motions of SciPy's DOP853."""

    def end(start: np.ndarray) -> np.ndarray:
        options = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-13}
        solution = solve_ivp(module.rhs, (0, period), start, args=(module.DEFAULTS,), **options)
        return np.asarray(solution.y[:, -1])

    steps = 1e-3 * np.eye(len(y))
    columns = [
        (8 * (end(y + s) - end(y - s)) - end(y + 2 * s) + end(y - 2 * s)) / 12e-3 for s in steps
    ]
    return np.array(columns).T


@pytest.mark.long("other tests reach its code")
def test_a_branch_point_is_where_a_third_multiplier_is_1() -> None:
    rest = equilibria(dp, {})[0]
    start = normal_mode_orbit(dp, rest, rest.modes[0], 1.4)
    found = []
    for orbit in (start, periodic_orbit(dp, start.y, start.period, {})):
        family = orbit_family(dp, orbit, bounds=(-np.inf, 25.0), direction=1)
        (point,) = family.special
        assert point.kind == "branch point"
        found.append(point.orbit.energy)
        before, after = family.stability[point.index], family.stability[point.index + 1]
        assert {before, after} == {"neutral", "unstable"}
        # the trace is the sum of two pairs: 1, 1 and the pair that meets at 1
        matrix = dop853_monodromy(point.orbit.y, point.orbit.period, dp)
        assert np.trace(matrix) == pytest.approx(4.0, abs=1e-7)
    assert found[0] == pytest.approx(found[1], rel=1e-9)


def test_orbits_from_a_section_and_with_a_symmetry_agree() -> None:
    section = Event(henon, "x", 0.0, direction=1)
    start = {"x": 0.0, "y": 0.0, "x_dot": 0.3}
    half = periodic_orbit(henon, start, 6.3, {}, symmetry=("x", "y_dot"))
    assert half.y[0] == half.y[3] == 0.0
    whole = periodic_orbit(henon, half.y, section, {})
    assert whole.period == pytest.approx(half.period, rel=1e-11)
    assert whole.multipliers == pytest.approx(half.multipliers, abs=1e-9)
    assert np.abs(whole.monodromy - half.monodromy).max() < 1e-9
    twice = periodic_orbit(henon, half.y, section, {}, returns=2)
    assert twice.period == pytest.approx(2 * half.period, rel=1e-10)
    with pytest.raises(ValueError, match="equations of henon_heiles change if time is reversed"):
        periodic_orbit(henon, start, 6.3, {}, symmetry=("y", "x_dot"))
    with pytest.raises(NoPeriodicOrbitError, match=r"does not meet x = 5\.0 again") as caught:
        periodic_orbit(henon, half.y, Event(henon, "x", 5.0), {})
    assert "max_steps" not in str(caught.value)  # which is no argument


def test_a_family_that_breaks_the_symmetry_branches_off() -> None:
    rest = equilibria(dp, {})[0]
    start = normal_mode_orbit(dp, rest, rest.modes[1], 0.9)
    found = []
    for orbit in (start, periodic_orbit(dp, start.y, start.period, {})):
        parent = orbit_family(dp, orbit, bounds=(-60.0, -28.0))
        (point,) = parent.special
        family = orbit_family(dp, point, bounds=(-60.0, 0.0), direction=1)
        assert family.orbits[0].energy == pytest.approx(-30.78800220, abs=1e-7)
        assert family.orbits[1].stability == "neutral"
        assert np.abs(family.y[2:, -1]).max() > 0.1  # not at rest
        found.append([special.orbit.energy for special in family.special])
    assert found[0] == pytest.approx(found[1], rel=1e-8)
    # the figure marks the branch point, between two orbits
    (axes,) = parent.figure("amplitude of theta1").axes
    (marker,) = (line for line in axes.lines if len(line.get_xdata()) == 1)
    beside = parent.amplitudes[0, [point.index, point.index + 1]]
    assert marker.get_xdata()[0] == point.orbit.energy
    assert beside.min() < marker.get_ydata()[0] < beside.max()


def test_a_family_ends_at_the_longest_period() -> None:
    start = periodic_orbit(single, {"theta": 0.4}, 2.0, {"l": 1.0}, symmetry=("theta_dot",))
    family = orbit_family(single, start, direction=1, max_period=2.1)
    assert family.ends == ("start", "longest period")
    assert family.period[-1] == pytest.approx(2.1, rel=1e-12)


def test_normal_modes_of_foucaults_pendulum_are_conical_motions() -> None:
    amplitude, length = 0.1, 1.0
    rest = linearise(foucault, {"x": 0.0, "y": 0.0}, {"l": length})
    height = np.sqrt(length**2 - amplitude**2)
    for mode in rest.modes:  # the rotation of the Earth separates both senses
        orbit = normal_mode_orbit(foucault, rest, mode, amplitude)
        exact = 2 * np.pi / mode.eigenvalue.imag * np.sqrt(height / length)
        assert orbit.period == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("quantity", ["period", "energy"])
def test_the_figure_of_a_family_shows_the_chosen_quantity(quantity: str) -> None:
    start = periodic_orbit(single, {"theta": 0.4}, 2.0, {"l": 1.0}, symmetry=("theta_dot",))
    family = orbit_family(single, start, direction=1, max_period=2.1)
    (line,) = family.figure(quantity).axes[0].lines
    shown = {"period": family.period, "energy": family.energy}
    assert np.asarray(line.get_xdata()).tolist() == family.values.tolist()
    assert np.asarray(line.get_ydata()).tolist() == shown[quantity].tolist()
