"""Compiled numbers longer than doubles give the digits that they have, as decimals confirm."""

import os
import signal
import threading
from decimal import Decimal
from math import pi
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import sympy
from benchmarks.precision import FINAL
from handwritten import handwritten
from mpmath import mp, mpf, workdps
from valid_files import HILL

import generated.double_pendulum as dp
import generated.driven_pendulum as driven
import generated.foucault_pendulum as foucault
import generated.henon_heiles as hh
import generated.single_pendulum as sp
import generated.spherical_pendulum as spherical
from derive import Coordinate, Parameter, PointMass, System
from derive.system.symbols import TIME
from solvers.app.modules import build
from solvers.app.modules import load as load_module
from solvers.integration.compiled import compiler, extended
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.extended import (
    PRECISIONS,
    ExtendedError,
    integrate_extended,
    kernel,
)
from solvers.integration.compiled.extended_source import DIGITS, DOUBLE, NumberType, Sequential
from solvers.integration.problem.status import Status
from solvers.references.taylor import taylor

#: The start of the report's scene, and states in its chaotic motion by Taylor series of 70 digits:
#: after 20 s an error of the start is ten million times as large.
REPORT = (pi / 2, pi, 0.0, 0.0)
STATES = {
    20: (
        -1.580187362807667942104,
        -18.14811914390867561513,
        2.938014965702848611982,
        0.03796161822119855974,
    ),
    50: (
        0.924615439256000289315,
        -41.66936175646692806169,
        -1.693132414506710164507,
        -2.751313347571617442691,
    ),
}
FINE = {"double-double": 1e-27, "long double": 1e-19, "quadruple": 1e-24}


def test_the_benchmark_has_the_same_states() -> None:
    assert all(FINAL[end] == pytest.approx(STATES[end], abs=1e-14) for end in STATES)


def after(end: int, precision: str, rtol: float) -> float:
    """The error of the report's motion at its end."""
    y = integrate_extended(dp, dp.DEFAULTS, REPORT, [0, end], precision, rtol)[-1]
    return float(np.abs(y - STATES[end]).max())


@pytest.mark.long("more cases of the same kind", keep=3)
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize(("module", "start"), [
    (dp, (1.5, -2.5, 0.5, 0.0)),
    (driven, (3.0, 0.1)),  # depends on time, and calls functions
    (foucault, (0.1, 0.2, 0.3, 0.0)),  # has no rational form
    (hh, (0.1, -0.2, 0.4, 0.1)),  # has no parameters
    (spherical, (0.7, 0.9, 0.1, 0.5)),
])  # fmt: skip
def test_states_are_those_of_taylor_series(
    module: ModuleType, start: tuple, precision: str
) -> None:
    if precision == "double-double" and module in (driven, foucault):
        with pytest.raises(NoCompilerError, match=r"pendulum_(sin|cos) is a function"):
            kernel(module, precision)
        return
    times = np.linspace(0, 1, 23)  # within steps, and at the end
    exact = taylor(module, module.DEFAULTS, start, times, 26)
    found = integrate_extended(module, module.DEFAULTS, start, times, precision, FINE[precision])
    assert np.abs(found - exact).max() <= 2 * np.spacing(np.abs(exact).max())
    assert np.array_equal(found[0], start)
    back = integrate_extended(
        module, module.DEFAULTS, start, -times[::11], precision, FINE[precision]
    )
    assert np.abs(back - taylor(module, module.DEFAULTS, start, -times[::11], 26)).max() < 1e-14


@pytest.mark.parametrize("precision", PRECISIONS)
def test_a_force_that_grows_with_time_acts_at_the_times_of_stages(precision: str) -> None:
    x, m = sympy.Symbol("x", real=True), sympy.Symbol("m", positive=True)
    system = System(
        "pulled", "Pulled", [Coordinate(x, "m", "position")], [Parameter(m, "kg", 1, "mass")],
        [PointMass(m, (x, sympy.S.Zero))], potential=x**2 / 2, forces=[TIME**3],
    )  # fmt: skip
    times = np.linspace(0, 8, 9)
    y = integrate_extended(build(system), (1.0,), (0.5, 0.25), times, precision, FINE[precision])
    exact = times**3 - 6 * times + 0.5 * np.cos(times) + 6.25 * np.sin(times)
    assert np.abs(y[:, 0] - exact).max() < 1e-12


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("precision", ["double-double", "quadruple"])
def test_times_have_all_digits_too(precision: str) -> None:
    # 3e-6 rad from the pole the azimuth turns at 1.9e3 rad/s, whose rate is 8e6 rad/s²
    params = (0.9184626507465876, 1.0564616223797008, 5.2615256837883155)
    start = (-0.0037327750491228263, 0.004359365602156699, -0.0020685280773522813, 0.00127657421)
    times = np.array([0.0, *np.linspace(0.8120, 0.8132, 60)])
    computed = integrate_extended(spherical, params, start, times, precision, 1e-24)
    exact = taylor(spherical, params, start, times, 36)
    assert np.abs(exact[:, 3]).max() > 1500
    assert (np.abs(computed - exact) <= 2 * np.spacing(np.abs(exact)) + 1e-18).all()


@pytest.mark.long("other tests reach its code")
def test_every_precision_has_its_digits_in_chaos() -> None:
    # doubles reach 3e-8 with compensated sums
    assert 1e-14 < after(20, "long double", 1e-19) < 2e-10
    for precision in ("double-double", "quadruple"):
        assert after(20, precision, 1e-22) <= np.spacing(18.0)
    assert 1e-12 < after(50, "double-double", 1e-30) < 2e-9
    # a tolerance of 1e-30 leaves 17 digits to the growth of errors
    assert after(50, "quadruple", 1e-30) < 1e-12


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.usefixtures("fused")  # the smaller error is nearly that of roundings
@pytest.mark.parametrize("precision", PRECISIONS)
def test_errors_are_proportional_to_tolerances(precision: str) -> None:
    coarse = {"double-double": 1e-15, "long double": 1e-12, "quadruple": 1e-16}[precision]
    errors = [after(20, precision, rtol) for rtol in (coarse, coarse / 1e3)]
    assert 30 < errors[0] / errors[1] < 30_000


@pytest.mark.parametrize(
    ("precision", "error"),
    [("double-double", 1e-12), ("long double", 1e-3), ("quadruple", 1e-12)],
)
def test_constants_have_all_digits(precision: str, error: float, tmp_path: Path) -> None:
    (tmp_path / "hill.toml").write_text(HILL)
    hill = load_module(str(tmp_path / "hill.toml"))
    with workdps(50):
        rate = mp.sqrt(mp.pi / 3 + mpf("9.81") + mpf(1) / 7)
        speed = -float(rate)  # it nearly stops on top: errors grow by e^30
        exact = mp.cosh(9 * rate) + speed / rate * mp.sinh(9 * rate)
        found = integrate_extended(hill, (1.0,), (1.0, speed), [0, 9], precision, FINE[precision])
        assert abs(exact) < 1e-2
        assert abs(found[1, 0] - exact) < error * abs(exact)
        # a double in the place of a constant would be visible
        change = mp.diff(lambda r: mp.cosh(9 * r) + speed / r * mp.sinh(9 * r), rate) * 1e-17
        assert abs(change) > 10 * error * abs(exact)


def test_functions_have_all_digits(tmp_path: Path) -> None:
    # another hill, on top of which the particle nearly stops: cos x is no coordinate's cosine alone
    text = HILL.replace("-m*(pi/3 + 9.81 + 1/7)*x**2/2", "-m*(5*x**2 + cos(x))")
    (tmp_path / "wavy.toml").write_text(text)
    wavy = load_module(str(tmp_path / "wavy.toml"))
    start, times = (1.0, -float(mp.sqrt(8 + 2 * mp.cos(1)))), [0.0, 9.0]
    exact = taylor(wavy, (1.0,), start, times, 36)[1]
    for precision, least, most in (("long double", 1e-9, 1e-2), ("quadruple", 0.0, 1e-15)):
        end = integrate_extended(wavy, (1.0,), start, times, precision, FINE[precision] / 1e6)[1]
        assert least <= np.abs(end / exact - 1).max() < most


@pytest.mark.long("other tests reach its code")
def test_parameters_and_start_are_taken_as_exact() -> None:
    # as by Taylor series: 9.81 is the nearest double, and sines are those of double angles
    start, times = (3.0, 3.1, 0.0, 0.0), [0.0, 6.0]
    found = integrate_extended(dp, dp.DEFAULTS, start, times, "quadruple", 1e-25)[-1]
    exact = taylor(dp, dp.DEFAULTS, start, times, 30)[-1]
    assert np.abs(found - exact).max() <= np.spacing(np.abs(exact).max())


def test_a_perturbation_changes_the_last_digits_only() -> None:
    runs = [
        integrate_extended(dp, dp.DEFAULTS, REPORT, [0, 20], "long double", 1e-18, perturbation=k)
        for k in (0, 1, 2, 1)
    ]
    assert np.array_equal(runs[1], runs[3])
    for one, other in ((0, 1), (0, 2), (1, 2)):
        assert 1e-13 < np.abs(runs[one][-1] - runs[other][-1]).max() < 1e-8


#: Both are at rest, and grow by e^40 from a change of a parameter alone, or of the start alone.
AT_REST = (("10*state[0] + params[0] - params[1]", 0.0), ("10*(state[0] + 0.5)", -0.5))


@pytest.mark.parametrize(
    ("rate", "start", "precision"),
    [(*case, "long double") for case in AT_REST] + [(*AT_REST[0], "double-double")],
)
def test_a_perturbation_changes_start_and_parameters(
    rate: str, start: float, precision: str, tmp_path: Path
) -> None:
    (tmp_path / "hand.h").write_text(
        "static inline void hand_rhs(HOLONOMIC_REAL t, const HOLONOMIC_REAL *state,\n"
        "    const HOLONOMIC_REAL *params, HOLONOMIC_REAL *result)\n"
        f"{{ result[0] = {rate}; (void)t; (void)params; }}\n"
    )
    module = handwritten("hand", ("y",), ("p", "q"), __file__=str(tmp_path / "hand.py"))
    arguments = module, (1.25, 1.25), (start,), [0, 4], precision, 1e-18
    ends = [integrate_extended(*arguments, perturbation=seed)[1, 0] for seed in range(5)]
    assert ends[0] == start
    assert len(set(ends)) > 1
    assert max(abs(end - start) for end in ends) < 1.0


def test_a_singularity_and_too_many_steps_end_a_motion_with_an_error(tmp_path: Path) -> None:
    (tmp_path / "hand.h").write_text(
        "static inline void hand_rhs(HOLONOMIC_REAL t, const HOLONOMIC_REAL *state,\n"
        "    const HOLONOMIC_REAL *params, HOLONOMIC_REAL *result)\n"
        "{ result[0] = state[0]*state[0]*params[0]; (void)t; }\n"
    )
    blow_up = handwritten("hand", ("y",), __file__=str(tmp_path / "hand.py"))
    half = integrate_extended(blow_up, (1.0,), (1.0,), [0.0, 0.5], "long double", 1e-16)
    assert half[1, 0] == pytest.approx(2.0, abs=1e-14)
    with pytest.raises(ExtendedError, match=r"below the resolution of time.*t = 1, long"):
        integrate_extended(blow_up, (1.0,), (1.0,), [0.0, 1.5], "long double", 1e-16)
    with pytest.raises(ExtendedError, match="more than 10 steps") as error:
        integrate_extended(dp, dp.DEFAULTS, REPORT, [0, 20], "long double", 1e-16, max_steps=10)
    assert error.value.status is Status.STEP_LIMIT
    with pytest.raises(ExtendedError, match="resolution of time"):
        integrate_extended(sp, (1.0, 0.0, 9.81), (1.0, 0.0), [0.0, 1.0], "quadruple", 1e-20)


def test_roundings_of_the_equations_do_not_shorten_steps(tmp_path: Path) -> None:
    # y' = y, of which the sum loses up to four digits, so that residuals of stages remain
    (tmp_path / "hand.h").write_text(
        "static inline void hand_rhs(HOLONOMIC_REAL t, const HOLONOMIC_REAL *state,\n"
        "    const HOLONOMIC_REAL *params, HOLONOMIC_REAL *result)\n"
        "{ result[0] = (state[0] + params[0]) - params[0]; (void)t; }\n"
    )
    module = handwritten("hand", ("y",), __file__=str(tmp_path / "hand.py"))
    for lost in (0.0, 300.0, 1e3, 2e3, 1e4):
        y = integrate_extended(module, (lost,), (1.0,), [0, 4], "long double", 1e-17, max_steps=14)
        assert y[-1, 0] == pytest.approx(np.exp(4.0), rel=1e-14)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_it_is_interrupted_at_once(precision: str) -> None:
    times = [0.0, *np.linspace(1, 1e6, 50_000)]
    interrupted, later = threading.Event(), []

    def interrupt() -> None:
        interrupted.set()
        os.kill(os.getpid(), signal.SIGINT)

    def progress(t: float) -> None:
        if interrupted.is_set():
            later.append(t)

    timer = threading.Timer(0.2, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        integrate_extended(dp, dp.DEFAULTS, REPORT, times, precision, 1e-18, 10**9, progress)
    assert len(later) <= 2  # of calls every 0.05 s


def test_progress_is_reported_and_may_end_the_motion() -> None:
    seen: list[float] = []

    def progress(t: float) -> None:
        seen.append(t)
        if len(seen) == 3:
            raise ValueError("enough")

    with pytest.raises(ValueError, match="enough"):
        integrate_extended(
            dp, dp.DEFAULTS, REPORT, [0.0, 1e6], "long double", 1e-18, 10**9, progress
        )
    assert seen == sorted(seen)
    assert 0 < seen[0] < seen[-1]


def test_no_compiler_no_longer_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    kernel.cache_clear()
    with monkeypatch.context() as patch:
        patch.setattr(compiler, "compilers", lambda: iter(()))
        with pytest.raises(NoCompilerError, match="install one as `cc`"):
            kernel(dp, "quadruple")
    without_header = handwritten("lonely", ("y",))
    with pytest.raises(NoCompilerError, match="no C header beside lonely"):
        kernel(without_header, "long double")
    # as where long double is double
    short = Sequential(DOUBLE, DOUBLE, 8)
    monkeypatch.setitem(PRECISIONS, "long double", short)
    with pytest.raises(NoCompilerError, match="no more digits than doubles"):
        kernel(sp, "long double")
    missing = NumberType("no_such_type", "0", "")
    monkeypatch.setitem(PRECISIONS, "quadruple", Sequential(missing, DOUBLE, 8))
    with pytest.raises(NoCompilerError, match="no quadruple numbers: no C compiler built"):
        kernel(sp, "quadruple")
    kernel.cache_clear()


def test_the_start_has_the_digits_of_the_longest_type() -> None:
    parts = extended._parts(kernel(dp, "long double").form, (1.0, 2.0, 0.0, 0.1))
    with workdps(50):
        sines = mp.sin(1), mp.cos(1), mp.sin(2), mp.cos(2)
        for exact, row in zip(sines, parts, strict=False):
            assert abs(sum(map(mpf, row)) - exact) < mpf(10) ** -DIGITS
    assert parts[-2:].tolist() == [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]
    assert Decimal.from_float(parts[5, 0]) == Decimal.from_float(0.1)
