"""Compiled loops: their coefficients, their agreement with the reference, lanes, long runs."""

import ctypes
import sys
from importlib.util import find_spec
from itertools import product
from math import pi

import numpy as np
import pytest
from mpmath import asin, ellipfun, ellipk, mpf, sqrt, workdps
from mpmath import sin as mpsin

import generated.double_pendulum as dp
import generated.elastic_pendulum as ep
import generated.single_pendulum as sp
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.compiled import compiler
from solvers.integration.compiled.kernel import Batch, Kernel, kernel, program
from solvers.integration.compiled.memory_layout import STATUSES
from solvers.integration.compiled.native import equations
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.prepare import NotFinishedError, prepare
from solvers.integration.problem import validation
from solvers.integration.problem.events import Event
from solvers.integration.problem.problem import Options
from solvers.integration.problem.status import Status
from solvers.runge_kutta.method_catalogue import load, names

EXPLICIT = [name for name in names() if load(name).is_explicit and not load(name).is_splitting]
FORMS = ("lagrangian", "hamiltonian", "rational")
REPORT = (pi / 2, pi, 0.0, 0.0)


def scatter(n: int, seed: int = 1) -> np.ndarray:
    """Initial states: any angles, moderate velocities."""
    return np.random.default_rng(seed).uniform(-3, 3, (n, 4))


@pytest.mark.long("other tests reach its code", daily=10)
@pytest.mark.parametrize(
    ("method", "form"),
    [
        *product(["rk1", "rk4", "dp54", "verner853", "verner98"], FORMS),
        *product(["gauss2", "radau3"], ["lagrangian", "hamiltonian"]),
    ],
)
@ignore_predictability()
def test_loops_agree_to_rounding_times_the_condition_of_the_run(method: str, form: str) -> None:
    # the condition is observed: what becomes of a change of 1e-10 in the start
    starts, params, span, h = scatter(40), dp.DEFAULTS, (0.0, 2.0), 0.02
    options = {"method": method, "h": h, "form": form}
    lanes = ensemble(dp, span, starts.T, params, **options).y.T
    moved = ensemble(dp, span, (starts * (1 + 1e-10)).T, params, **options).y.T
    condition = 1 + np.abs(moved - lanes).max(axis=1) / 1e-10
    for backend in ("python", "compiled"):
        one_by_one = np.array([
            integrate(dp, span, start, params, backend=backend, **options).y[:, -1]
            for start in starts
        ])  # fmt: skip
        apart = np.abs(one_by_one - lanes).max(axis=1)
        # a hundred steps, each of a few roundings of numbers up to ten
        assert (apart < 100 * 10 * 2.2e-16 * condition).all()


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_compiled_implicit_steps_converge_where_fixed_point_iteration_does_not() -> None:
    # a spring a thousand times as fast as the swing: the step is 30 of its radians
    stiff = (1.0, 1e6, 1.0, 9.81)
    start = (*ep.equilibrium(stiff), 0.0, 0.5)
    python, compiled = (
        integrate(ep, (0, 3), start, stiff, method="radau3", h=0.03, backend=backend)
        for backend in ("python", "compiled")
    )
    assert np.abs(python.y - compiled.y).max() < 1e-10
    # some steps keep the Jacobian of the last one: rounding decides which
    assert 0 < python.njev < 100
    assert 0 < compiled.njev < 100
    pendulum = integrate(sp, (0, 3), (0.0, 0.5), (1.0, start[0], 9.81), rtol=1e-12).y[:, -1]
    assert compiled.y[1::2, -1] == pytest.approx(pendulum, abs=1e-4)
    # and stages that cannot be solved end with a status
    for backend in ("python", "compiled"):
        lost = integrate(
            dp,
            (0, 4),
            (1.0, 2.0, 90.0, -80.0),
            dp.DEFAULTS,
            method="gauss3",
            h=1.0,
            backend=backend,
        )
        assert lost.status is Status.NO_CONVERGENCE


@pytest.mark.long("other tests reach its code")
def test_a_motion_depends_on_no_other_motion_and_no_thread() -> None:
    starts, n = scatter(101).T, 101
    rng = np.random.default_rng(2)
    params = (dp.DEFAULTS * rng.uniform(0.5, 1.5, (n, 5))).T
    options = {
        "events": [Event(dp, "theta1", pi), Event(dp, "theta2", -pi, terminal=True)],
        "t_eval": np.linspace(0, 3, 7),
        "occurrences": 2,
    }
    for method in ("verner853", "tsit54"):
        first = ensemble(dp, (0, 3), starts, params, method=method, workers=1, **options)
        for workers in (2, 5):
            order = rng.permutation(n)
            again = ensemble(
                dp,
                (0, 3),
                starts[:, order],
                params[:, order],
                method=method,
                workers=workers,
                **options,
            )
            assert (first.status[order] == again.status).all()
            for name in ("t", "growth", "t_events", "occurred", "steps", "rejected", "nfev"):
                ordered, result = getattr(first, name)[order], getattr(again, name)
                assert np.array_equal(ordered, result, equal_nan=True), name
            for name in ("y", "samples", "y_events"):
                ordered, result = getattr(first, name)[:, order], getattr(again, name)
                assert np.array_equal(ordered, result, equal_nan=True), name


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("form", FORMS)
def test_lanes_give_the_events_and_samples_of_the_reference(form: str) -> None:
    starts, times = scatter(20, 3), np.linspace(0, 3, 31)
    events = [Event(dp, "theta1", 0.5, direction=1), Event(dp, "theta2", pi, terminal=True)]
    if form != "hamiltonian":
        events.append(Event(dp, "theta1_dot", 1.0))
    options = {"form": form, "events": events, "t_eval": times, "rtol": 1e-11, "atol": 1e-13}
    found = ensemble(dp, (0, 3), starts.T, dp.DEFAULTS, occurrences=9, **options)
    options = {**options, "backend": "python"}
    expected = ensemble(dp, (0, 3), starts.T, dp.DEFAULTS, occurrences=9, **options)
    assert "python" in expected.run
    assert "compiled" in found.run
    assert (found.status == expected.status).all()
    assert set(found.status) == {Status.FINISHED, Status.EVENT}
    assert np.array_equal(found.occurred, expected.occurred)
    for name in ("t", "y", "samples", "t_events", "y_events"):
        ours, theirs = getattr(found, name), getattr(expected, name)
        assert np.array_equal(np.isnan(ours), np.isnan(theirs)), name
        assert np.nanmax(np.abs(ours - theirs)) < 1e-6, name
    # an event is where its value is, and on its far side
    flips = found.y_events[1, :, 1, 0]
    assert np.nanmax(np.abs(flips - pi)) < 1e-13


def test_a_single_motion_and_one_in_lanes_have_the_same_events() -> None:
    events = [Event(sp, "theta", 0.0)]
    alone = integrate(sp, (0, 30), (2.0, 0.0), sp.DEFAULTS, events=events, rtol=1e-10)
    many = ensemble(
        sp, (0, 30), [[2.0] * 3, [0.0] * 3], sp.DEFAULTS, events=events, rtol=1e-10, occurrences=50
    )
    assert alone.backend == "compiled"
    assert many.occurred.tolist() == [[len(alone.t_events[0])]] * 3
    kept = many.t_events[2, 0, : len(alone.t_events[0])]
    assert np.abs(kept - alone.t_events[0]).max() < 1e-9
    # half a period lies between passages of the bottom
    assert np.ptp(np.diff(alone.t_events[0])) < 1e-8


def test_steps_and_events_beyond_the_capacity_are_collected_in_parts() -> None:
    events = Event(sp, "theta_dot", 0.0)
    found = integrate(
        sp, (0, 500), (1.0, 0.1), sp.DEFAULTS, method="rk4", h=0.02, events=events, energy=True
    )
    assert (found.steps, len(found.t)) == (25_000, 25_001)
    assert np.abs(np.diff(found.t) - 0.02).max() < 1e-12
    assert len(found.t_events[0]) > 300
    assert np.ptp(found.energy) < 1e-3


def test_a_prepared_run_ends_where_the_integration_does() -> None:
    for form in FORMS:
        run = prepare(dp, dp.DEFAULTS, form=form, rtol=1e-11)
        for span in ((0.0, 5.0), (2.0, -3.0), (1.0, 1.0)):
            start = (1.0, 8 * pi + 2.0, -0.5, 20.0)  # an angle that has turned, and goes on to
            expected = integrate(dp, span, start, dp.DEFAULTS, form=form, rtol=1e-11)
            assert run(span, start) == pytest.approx(expected.end[1], abs=1e-13)


def test_a_prepared_run_refuses_invalid_arguments_and_reports_where_it_stopped() -> None:
    run = prepare(dp, dp.DEFAULTS, max_steps=3)
    with pytest.raises(ValueError, match="theta1, theta2, theta1_dot, theta2_dot"):
        run((0, 1), (1.0, 2.0))
    with pytest.raises(ValueError, match=r"t_span\[1\] = nan must be a finite real number"):
        run((0, float("nan")), REPORT)
    with pytest.raises(NotFinishedError, match="number of steps") as stopped:
        run((0, 5), REPORT)
    assert stopped.value.status is Status.STEP_LIMIT
    assert 0 < stopped.value.t < 5
    with pytest.raises(ValueError, match="SciPy"):
        prepare(dp, dp.DEFAULTS, method="Radau")
    fixed = prepare(sp, sp.DEFAULTS, method="rk4", h=1e-3)
    with pytest.raises(ValueError, match="resolution"):
        fixed((1e15, 2e15), (1.0, 0.0))


@pytest.mark.long("other tests reach its code")
def test_angles_are_unwrapped_even_where_a_step_turns_by_more_than_half() -> None:
    # 20 rad/s for 1000 s are about 3143 turns
    rough = integrate(
        sp, (0, 1000), (0.0, 20.0), sp.DEFAULTS, rtol=1e-2, atol=0.1, method="verner853"
    )
    plain = integrate(sp, (0, 1000), (0.0, 20.0), sp.DEFAULTS, rtol=1e-12, form="lagrangian")
    fine = integrate(sp, (0, 1000), (0.0, 20.0), sp.DEFAULTS, rtol=1e-12)
    assert "rational" in rough.run
    assert "rational" in fine.run
    assert np.diff(rough.t).max() * 20 > pi
    assert plain.y[0, -1] > 3000 * 2 * pi
    assert fine.y[0, -1] == pytest.approx(plain.y[0, -1], abs=1e-6)
    assert rough.y[0, -1] == pytest.approx(plain.y[0, -1], rel=0.01)


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("compensated", [False, True])
@pytest.mark.parametrize(("method", "h"), [("rk4", 0.01), ("rk3", 0.04), ("rk1", 0.02)])
def test_sine_and_cosine_stay_on_the_circle_over_long_runs(
    method: str, h: float, compensated: bool
) -> None:
    # steps leave it by 1e-10, 1e-5 and 1e-3
    built = kernel(sp, "rational", method, compensated=compensated)
    options = Options(method, "rational", h=h)
    problem = validation.problem(sp, (0.0, 1000.0), (2.0, 0.0), sp.DEFAULTS, options)
    batch = Batch(built, problem, capacity=200_000)
    batch.restart()
    batch.run()
    sine, cosine = batch.rows["z"][0, : batch.motions["rows"][0], :2].T
    assert len(sine) == 1000 / h + 1
    assert np.abs(sine**2 + cosine**2 - 1).max() < 1e-15


def test_approximations_of_the_loop_have_the_stated_accuracy() -> None:
    text = program(equations(sp, "rational"), load("rk4"), lanes=False, compensated=False)
    text += """
double logarithm(double x) { return lane_log2(x); }
double power(double x) { return lane_exp2(x); }
double angle(double s, double c)
{
    State state = {.z = {s, c}};
    return approximate_angle(&state, 0);
}
"""
    library = ctypes.CDLL(str(compiler.build(text).path))
    for name, count in (("logarithm", 1), ("power", 1), ("angle", 2)):
        function = getattr(library, name)
        function.argtypes, function.restype = [ctypes.c_double] * count, ctypes.c_double
    for x in np.linspace(-60, 60, 4001):
        assert library.power(x) == pytest.approx(2.0**x, rel=1e-7)
        assert library.logarithm(2.0**x) == pytest.approx(x, abs=1e-7)
    for x in np.linspace(-pi, pi, 4001):
        assert library.angle(np.sin(x), np.cos(x)) == pytest.approx(x, abs=0.08)


@pytest.mark.long("other tests reach its code")
def test_compensated_sums_reduce_rounding_errors() -> None:
    # over 40 000 steps rounding outgrows the method's error, unless it is carried along
    _, length, g = map(mpf, sp.DEFAULTS)
    with workdps(30):
        k, rate = mpsin(1), sqrt(g / length)
        sn = ellipfun("sn", ellipk(k**2) - rate * 40, k=k)
        exact = float(2 * asin(k * sn))
    for form in ("lagrangian", "rational"):
        errors = [
            abs(
                integrate(
                    sp,
                    (0, 40),
                    (2.0, 0.0),
                    sp.DEFAULTS,
                    method="verner98",
                    h=1e-3,
                    t_eval=[40.0],
                    form=form,
                    compensated=compensated,
                ).y[0, 0]
                - exact
            )
            for compensated in (False, True)
        ]
        assert errors[1] < 1e-14, form
        assert errors[1] < errors[0] / 3, form


@pytest.mark.long("other tests reach its code")
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_time_does_not_drift_over_a_million_steps() -> None:
    run = prepare(sp, sp.DEFAULTS, method="rk1", h=0.1, max_steps=10**7)
    found = integrate(
        sp,
        (0, 1e5),
        (0.0, 0.0),
        sp.DEFAULTS,
        method="rk1",
        h=0.1,
        t_eval=[5e4, 1e5 - 0.1, 1e5],
        max_steps=10**7,
    )
    assert found.steps == 10**6
    assert found.nfev == 10**6 + 1  # one to begin with; the samples are ends of steps
    assert run((0.0, 1e5), (0.0, 0.0)) == (0.0, 0.0)
    # ten times 0.1 is a little more than 1: no step is left for the difference
    tenths = ensemble(sp, (0, 1), [[1.0] * 3, [0.0] * 3], sp.DEFAULTS, method="rk4", h=0.1)
    assert tenths.steps.tolist() == [10, 10, 10]


def bits(form: str, method: str, *, lanes: bool) -> bytes:
    """What a reproducible loop, built now, makes of some motions with events and samples."""
    built = Kernel(dp, form, method, lanes=lanes, compensated=True, reproducible=True)
    events, times = [Event(dp, "theta1", 0.3)], np.linspace(0, 3, 7)
    options = Options(method, form, 1e-9, 1e-9, t_eval=times, events=events)
    problem = validation.problem(dp, (0.0, 3.0), REPORT, dp.DEFAULTS, options)
    batch = Batch(built, problem, scatter(40), capacity=7, occurrences=3)
    batch.restart()
    batch.run()
    assert (batch.motions["status"] == STATUSES.index(Status.FINISHED)).all()
    return b"".join(part.tobytes() for part in (batch.motions, batch.rows, batch.event_rows))


@pytest.mark.long("other tests reach its code", daily=3)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("method", ["tsit54", "verner853"])
def test_a_reproducible_build_gives_the_same_bits_from_every_compiler_and_in_lanes(
    form: str, method: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    usual = bits(form, method, lanes=False)
    assert bits(form, method, lanes=True) == usual
    # as far from the usual translation as this compiler goes
    monkeypatch.setattr(compiler, "FLAGS", ("-std=c99", "-O0", "-fPIC", "-Wno-psabi"))
    assert bits(form, method, lanes=False) == usual
    monkeypatch.undo()
    if find_spec("ziglang"):
        zig = (sys.executable, "-m", "ziglang", "cc")
        monkeypatch.setattr(compiler, "compilers", lambda: iter([zig]))
        assert bits(form, method, lanes=False) == usual
        assert bits(form, method, lanes=True) == usual
