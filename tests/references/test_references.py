"""References agree with each other: three families of methods that share only the physics."""

from decimal import Decimal, localcontext
from math import pi, sqrt
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from mpmath import mp
from scipy.special import ellipk
from sympy import symbols
from valid_files import HILL

import generated.coupled_pendulums as coupled
import generated.double_pendulum as dp
import generated.driven_pendulum as driven
import generated.foucault_pendulum as foucault
import generated.four_bar as four_bar
import generated.free_body as free_body
import generated.single_pendulum as sp
from holonomic import Coordinate, Parameter, PointMass, System, build
from solvers.app.modules import load as load_module
from solvers.equations.consistent_start import consistent_start
from solvers.equations.module import ELEMENTARY
from solvers.references.decimal_numbers import sine_and_cosine, with_exact_literals
from solvers.references.elliptic import jacobi, pendulum, swing
from solvers.references.extrapolation import extrapolated
from solvers.references.power_series import PowerSeries, series_functions
from solvers.references.taylor import taylor

REPORT = (pi / 2, pi, 0.0, 0.0)
EXTENDED = np.finfo(np.longdouble).nmant > 60


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(
    ("module", "start"),
    [
        (dp, REPORT),
        (dp, (0.02, 0.01, 0.0, 0.0)),
        (dp, (-4.0, 9.0, 2.0, -1.0)),
        (sp, (2.0, 1.0)),
    ],
)
def test_taylor_and_extrapolation_agree_to_rounding(module: ModuleType, start: tuple) -> None:
    times = [0.0, 1.5, 5.0]
    series = taylor(module, module.DEFAULTS, start, times)
    midpoints = extrapolated(module, module.DEFAULTS, start, times)
    assert np.abs(series - midpoints).max() < (1e-14 if EXTENDED else 1e-11)
    # and backwards they return
    back = taylor(module, module.DEFAULTS, series[-1], times[::-1])
    assert np.abs(back[-1] - start).max() < 1e-13


def test_agreement_is_no_accident_it_is_lost_with_long_steps() -> None:
    series = taylor(dp, dp.DEFAULTS, REPORT, [0, 3])
    coarse = extrapolated(dp, dp.DEFAULTS, REPORT, [0, 3], h=0.05)
    assert np.abs(series - coarse).max() > 1e-10


@pytest.mark.long("other tests reach its code")
def test_more_digits_change_nothing_but_the_last() -> None:
    fewer, more = (taylor(dp, dp.DEFAULTS, REPORT, [0, 3], digits=d) for d in (10, 24))
    most = taylor(dp, dp.DEFAULTS, REPORT, [0, 3], digits=40)
    assert np.array_equal(more, most)
    assert 1e-13 < np.abs(fewer - most).max() < 1e-6


def test_energy_is_kept_to_the_last_bits() -> None:
    y = taylor(dp, dp.DEFAULTS, REPORT, np.linspace(0, 5, 21)).T
    energy = dp.energy_many(0.0, y, dp.DEFAULTS)
    assert np.abs(energy - energy[0]).max() < 1e-13


@pytest.mark.long("more cases of the same kind", keep=7)
@pytest.mark.parametrize("start", [
    (2.0, 0.0), (1.0, 3.0), (1.0, -3.0), (0.3, 7.0), (0.3, -7.0), (7.0, 1.0), (-4.0, 0.5),
    (9.0, -8.0), (3.0, 0.0), (0.0, 0.0), (1e-9, 0.0), (pi - 1e-5, 0.0), (1e-7 - pi, 0.0),
    (pi, 1e-5),
])  # fmt: skip
def test_elliptic_functions_give_the_single_pendulum(start: tuple[float, float]) -> None:
    times = np.linspace(0, 20, 9)
    found = pendulum(2.0, 9.81, start, times)
    assert np.abs(found - taylor(sp, sp.DEFAULTS, start, times)).max() < 3e-13


def test_elliptic_functions_on_the_separatrix_rise_for_ever() -> None:
    omega = sqrt(9.81 / 9.81)
    motion = pendulum(9.81, 9.81, (0.0, 2 * omega), np.array([-1.0, 0.0, 1.0, 10.0, 40.0]))
    # Gudermann's function: theta = 4 atan(tanh(omega t/2)), theta_dot = 2 omega/cosh(omega t)
    assert motion[:, 0] == pytest.approx(4 * np.arctan(np.tanh([-0.5, 0, 0.5, 5, 20])), abs=1e-15)
    assert motion[2, 1] == pytest.approx(2 / np.cosh(1.0), rel=1e-15)
    assert pendulum(9.81, 9.81, (0.0, -2 * omega), 40.0)[0] == pytest.approx(-pi, abs=1e-15)


@pytest.mark.parametrize("start", [0.3, -1.0, 2.5, -3.1])
@pytest.mark.parametrize("direction", [1, -1])
def test_motions_on_the_separatrix_start_anywhere(start: float, direction: int) -> None:
    # sin(theta/2) = tanh(u) at u = omega t + artanh(sin(start/2)), up to the signs
    omega, times = 1.7, np.array([-2.0, -0.1, 0.0, 0.5, 3.0])
    sine, cosine = np.sin(start / 2), np.cos(start / 2)
    theta, rate = swing(omega, sine, cosine, direction * cosine, times).T
    u = direction * omega * times + np.arctanh(sine)
    assert theta == pytest.approx(2 * np.arcsin(np.tanh(u)), abs=1e-7)
    assert np.tan(theta / 4) == pytest.approx(np.tanh(u / 2), rel=1e-13)
    assert rate == pytest.approx(direction * 2 * omega / np.cosh(u), rel=1e-13)


@pytest.mark.parametrize("complement", [1.0, 0.5, 1e-3, 1e-8, 1e-20])
def test_jacobis_functions_keep_their_digits_close_to_the_separatrix(complement: float) -> None:
    import mpmath

    with mpmath.workdps(50):
        m = 1 - mpmath.mpf(complement)
        quarter = float(mpmath.ellipk(m))
        for part in (0.1, 0.4, 0.6, 0.97, 1.2, 2.7, -0.8):
            u = part * quarter
            for value, name in zip(
                jacobi(np.array(u), complement), ("sn", "cn", "dn"), strict=False
            ):
                expected = float(mpmath.ellipfun(name, u, m=m))
                # what rounding u does, and a few roundings where sn turns into cn
                assert value == pytest.approx(
                    expected, rel=1e-14 * (1 + quarter) / complement**0.25
                )


def test_the_period_is_the_complete_elliptic_integral() -> None:
    amplitude = 2.5
    period = 4 * sqrt(2.0 / 9.81) * ellipk(np.sin(amplitude / 2) ** 2)
    end = taylor(sp, sp.DEFAULTS, (amplitude, 0.0), [0, period])[-1]
    assert end == pytest.approx([amplitude, 0.0], abs=1e-14)


DRIVEN = [
    (driven, (1.0, 0.0)),  # sine and cosine of time
    (foucault, (30.0, 10.0, 0.0, 0.0)),  # functions of parameters, and roots
    (coupled, (0.3, -0.2, 0.0, 0.0)),  # roots
]


@pytest.mark.parametrize(("module", "start"), DRIVEN)
def test_references_of_driven_systems_agree(module: ModuleType, start: tuple) -> None:
    times = [0.3, 0.5, 0.8]
    series = taylor(module, module.DEFAULTS, start, times)
    midpoints = extrapolated(module, module.DEFAULTS, start, times, h=0.004)
    assert np.abs(series - midpoints).max() < (1e-14 if EXTENDED else 1e-10)
    # from the middle on, at its own time
    rest = taylor(module, module.DEFAULTS, series[1], times[1:])
    assert np.abs(rest[-1] - series[-1]).max() < 1e-13


@pytest.mark.parametrize("module", [four_bar, free_body])
def test_references_are_on_the_constraints_at_all_times(module: ModuleType) -> None:
    """From a start that is not: there and later, constraints and energy have all digits."""
    guess = np.linspace(0.4, 0.9, len(module.STATE))
    y0 = consistent_start(module, {}, {}, guess=guess).y
    beside = y0 + 1e-6 * np.cos(np.arange(len(y0)))
    states = taylor(module, module.DEFAULTS, beside, [0.0, 0.05, 0.1], 20)
    for one in (beside, *states):
        residual = np.abs(module.constraints(0.0, one.tolist(), module.DEFAULTS)).max()
        assert (residual > 1e-8) if one is beside else (residual < 1e-14)
    assert states[0] == pytest.approx(beside, abs=1e-5)
    energies = [module.energy(0.0, one.tolist(), module.DEFAULTS) for one in states]
    assert energies == pytest.approx([energies[0]] * 3, rel=1e-14)
    assert np.abs(states[2] - states[0]).max() > 5e-3


def test_a_reference_of_a_state_of_zeros_that_a_force_moves() -> None:
    x, t = symbols("x t", real=True)
    m, k = symbols("m k", positive=True)
    pivot = System(
        name="pivot",
        title="A mass on a spring whose pivot moves",
        coordinates=[Coordinate(x, "m", "length")],
        parameters=[Parameter(m, "kg", 1.0, "mass"), Parameter(k, "N/m", 4.0, "stiffness")],
        masses=[PointMass(m, (x + t**3, 0))],
        potential=k * x**2 / 2,
    )
    module = build(pivot)
    (end,) = taylor(module, module.DEFAULTS, (0.0, 0.0), [0, 1])[1:]
    # x'' + 4 x = -6 t
    assert end == pytest.approx([-1.5 + 0.75 * np.sin(2), -1.5 + 1.5 * np.cos(2)], abs=1e-15)


@pytest.mark.parametrize("name", ELEMENTARY)
def test_functions_of_series_have_the_coefficients_of_taylor(name: str) -> None:
    tape: list[PowerSeries] = []
    x = PowerSeries(tape, [])
    y = series_functions(tape)[name](1 + x * x / 3)
    order = 8
    with localcontext(prec=40), mp.workdps(40):
        for k in range(order):
            x.coefficients.append({0: Decimal("0.5"), 1: Decimal(1)}.get(k, Decimal(0)))
            for series in tape:
                series.extend(k)
        expected = mp.taylor(lambda t: getattr(mp, name)(1 + t * t / 3), 0.5, order - 1)
        for k, coefficient in enumerate(expected):
            assert abs(mp.mpf(str(y.at(k))) - coefficient) < mp.mpf("1e-20")
        constant = series_functions(tape)[name](0.7)
        assert abs(mp.mpf(str(constant.at(0))) - getattr(mp, name)(mp.mpf(0.7))) < mp.mpf("1e-38")


def test_powers_of_constants_are_constants() -> None:
    with localcontext(prec=40):
        result = series_functions([])["pow"](2.25, 0.5)
        assert (result.constant, result.at(0)) == (True, Decimal("1.5"))


def test_choices_by_constants_are_made_once() -> None:
    select = series_functions([])["select"]
    assert [select(s, 2.0, 3.0).at(0) for s in (1.0, 0.0, -1.0)] == [2, 3, 3]


def test_decimal_sine_and_cosine() -> None:
    import mpmath

    with localcontext() as context, mpmath.workdps(60):
        context.prec = 50
        for x in (0.0, 1e-30, 0.5, -3.25, 40.0, 1e9):
            sine, cosine = sine_and_cosine(Decimal(x))
            assert abs(mpmath.mpf(str(sine)) - mpmath.sin(x)) < 1e-48
            assert abs(mpmath.mpf(str(cosine)) - mpmath.cos(x)) < 1e-48


@pytest.mark.parametrize("distance", [1e-2, 1e-5, 1e-9, 0.0])
def test_the_fall_from_next_to_the_upright_place_is_exact_all_the_way(distance: float) -> None:
    # halfway down the distance is small beside pi and large beside where it began
    start, times = pi - distance, np.linspace(0, 25, 101)
    found = pendulum(2.0, 9.81, (start, 0.0), times)
    with mp.workdps(60):
        k, complement = mp.sin(mp.mpf(start) / 2), mp.cos(mp.mpf(start) / 2) ** 2
        omega, quarter = mp.sqrt(mp.mpf(9.81) / 2), mp.ellipk(1 - complement)
        exact = [
            2 * mp.asin(k * mp.ellipfun("sn", quarter - omega * t, m=1 - complement))
            for t in map(mp.mpf, times.tolist())
        ]
    assert np.abs(found[:, 0] - np.array(exact, dtype=float)).max() < 1e-13


def test_series_have_all_digits_of_constants(tmp_path: Path) -> None:
    # it nearly stops on top, where an error of 1e-17 in a constant would be larger than x
    (tmp_path / "hill.toml").write_text(HILL)
    hill = load_module(str(tmp_path / "hill.toml"))
    with mp.workdps(50):
        rate = mp.sqrt(mp.pi / 3 + mp.mpf("9.81") + mp.mpf(1) / 7)
        speed = -float(rate)
        exact = mp.cosh(9 * rate) + speed / rate * mp.sinh(9 * rate)
        found = taylor(hill, (1.0,), (1.0, speed), [0, 9], 40)[1, 0]
        assert abs(found - exact) < 1e-15 * abs(exact)


def test_functions_without_text_keep_their_literals() -> None:
    def inner(x: float) -> float:
        return factor * x + 0.1

    factor = 2.0
    made = eval("lambda x: 0.1*x")
    for function in (inner, made, max):  # a closure, without text, not in Python
        assert with_exact_literals(function, str) is function
    assert with_exact_literals(literal, Decimal)(None) == (Decimal("0.1"), Decimal("0.001"), 2)


def literal(x: object) -> object:
    return 0.1000, 1e-3, 2


def test_a_series_without_singularities_takes_steps_as_if_one_were_at_one_second() -> None:
    # 1/e² of the distance to the nearest singularity
    ends: list[float] = []
    taylor(sp, sp.DEFAULTS, (0.0, 0.0), [0.0, 1.0], 20, progress=ends.append)
    assert ends == pytest.approx(np.exp(-2) * np.arange(1, 8), rel=1e-12)
