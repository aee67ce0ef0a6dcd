"""Integrations against exact solutions, in every form; samples and time spans."""

from functools import partial
from math import asin, log2, pi, sin, sqrt

import numpy as np
import pytest
from handwritten import handwritten
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipk

import generated.double_pendulum as dp
import generated.single_pendulum as sp
from solvers.integration.integrate import integrate
from solvers.integration.ode_solver import ode_solver
from solvers.integration.problem.status import Status
from solvers.runge_kutta.method_catalogue import load, names

EXPLICIT_PAIRS = [n for n in names() if load(n).b_hat]
FORMS = ("lagrangian", "hamiltonian", "rational")
REPORT = (pi / 2, pi, 0.0, 0.0)
#: The report's scene at 5 s, from an 80-bit Taylor series.
END = (2.2280642400930692, -0.2670447339117043, -1.9694093323354762, -2.9859792219408772)


def exact_pendulum(t: float | np.ndarray, amplitude: float) -> np.ndarray:
    """Angle and velocity of the single pendulum released at `amplitude`, by Jacobi's functions.

    sin(θ/2) = k sn(K - ωt) with k = sin(amplitude/2) and ω² = g/l.
    """
    _, length, g = sp.DEFAULTS
    k, omega = sin(amplitude / 2), sqrt(g / length)
    sn, cn, _, _ = ellipj(ellipk(k**2) - omega * np.asarray(t), k**2)
    return np.array([2 * np.arcsin(k * sn), -2 * k * omega * cn])


def test_the_exact_solution_is_that_of_the_pendulum() -> None:
    # an oracle of its own: the second derivative by differences is the equation of motion
    _, length, g = sp.DEFAULTS
    before, now, after = (exact_pendulum(1.0 + d, 2.0)[0] for d in (-1e-4, 0.0, 1e-4))
    assert (before - 2 * now + after) / 1e-8 == pytest.approx(-g / length * sin(now), rel=1e-6)
    assert exact_pendulum(0.0, 2.0) == pytest.approx([2.0, 0.0], abs=1e-7)


def pendulum_error(method: str, form: str, steps: int, backend: str = "python") -> float:
    solution = integrate(
        sp,
        (0, 2),
        (2.0, 0.0),
        sp.DEFAULTS,
        method=method,
        form=form,
        h=2 / steps,
        t_eval=[2.0],
        backend=backend,
    )
    return float(np.abs(solution.y[:, 0] - exact_pendulum(2.0, 2.0)).max())


#: Steps with which each method has converged, in double precision, to the exact solution's order.
CONVERGED = {
    "rk1": 640,
    "midpoint": 640,
    "ralston": 640,
    "heun": 10_000,
    "gauss1": 160,
    "rk3": 160,
    "bs32": 160,
    "radau2": 160,
    "rk4": 320,
    "rk4_38": 320,
    "gauss2": 80,
    "dp54": 160,
    "radau3": 80,
    "gauss3": 40,
}


@pytest.mark.long("more cases of the same kind", keep=3, daily=28)
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.accuracy_warnings.DriftWarning")
@pytest.mark.parametrize("backend", ["python", "compiled"])
@pytest.mark.parametrize("form", ["lagrangian", "hamiltonian"])
@pytest.mark.parametrize("method", CONVERGED)
def test_fixed_steps_converge_with_the_order_of_the_method(
    method: str, form: str, backend: str
) -> None:
    steps = CONVERGED[method]
    errors = [pendulum_error(method, form, n, backend) for n in (steps, 2 * steps)]
    assert log2(errors[0] / errors[1]) == pytest.approx(load(method).order, abs=0.1)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("method", ["tsit54", "dop853", "verner853", "verner98"])
def test_methods_that_reach_rounding_first_fall_at_least_with_their_order(
    method: str, form: str
) -> None:
    # their order itself is observed with 50 digits, in the tests of the methods
    errors = [pendulum_error(method, form, n) for n in (10, 14)]
    slope = np.log(errors[0] / errors[1]) / np.log(1.4)
    assert slope > load(method).order - 0.2


@pytest.mark.parametrize("method", ["rk1", "midpoint", "rk3", "rk4", "dp54", "verner98"])
def test_the_rational_form_is_as_accurate(method: str) -> None:
    errors = [pendulum_error(method, form, 100) for form in ("lagrangian", "rational")]
    assert errors[1] < 10 * errors[0] + 1e-13


@pytest.mark.long("more cases of the same kind", keep=3, daily=18)
@pytest.mark.parametrize("backend", ["python", "compiled"])
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("method", EXPLICIT_PAIRS)
def test_tolerances_bring_the_report_s_scene_to_its_known_end(
    method: str, form: str, backend: str
) -> None:
    errors = []
    # many steps of a low order take seconds in Python
    is_slow = backend == "python" and load(method).order < 5
    tolerances = (1e-4, 1e-7) if is_slow else (1e-6, 1e-9)
    for rtol in tolerances:
        solution = integrate(
            dp,
            (0, 5),
            REPORT,
            dp.DEFAULTS,
            method=method,
            form=form,
            rtol=rtol,
            atol=rtol,
            max_steps=10_000_000,
            backend=backend,
        )
        assert solution.status is Status.FINISHED
        assert solution.t[-1] == 5.0
        errors.append(np.abs(solution.y[:, -1] - END).max())
    assert errors[1] < 1000 * tolerances[1]
    assert errors[1] < errors[0] / 50 or errors[1] < 1e-11


@pytest.mark.parametrize("form", FORMS)
def test_samples_are_as_accurate_as_steps(form: str) -> None:
    times = np.linspace(0, 2, 41)
    solution = integrate(
        sp, (0, 2), (2.0, 0.0), sp.DEFAULTS, form=form, rtol=1e-10, t_eval=times, energy=True
    )
    assert np.array_equal(solution.t, times)
    assert np.abs(solution.y - exact_pendulum(times, 2.0)).max() < 1e-8
    assert solution.energy is not None
    assert np.ptp(solution.energy) < 1e-8
    steps = integrate(sp, (0, 2), (2.0, 0.0), sp.DEFAULTS, form=form, rtol=1e-10)
    assert solution.steps == steps.steps == len(steps.t) - 1


def test_time_may_run_backwards_or_not_at_all() -> None:
    there = integrate(dp, (0, 3), REPORT, dp.DEFAULTS, rtol=1e-12).y[:, -1]
    back = integrate(dp, (3, 0), there, dp.DEFAULTS, rtol=1e-12, t_eval=[3, 1.5, 0])
    assert np.abs(back.y[:, -1] - REPORT).max() < 1e-8
    assert back.t.tolist() == [3, 1.5, 0]
    still = integrate(dp, (1, 1), REPORT, dp.DEFAULTS)
    assert still.t.tolist() == [1.0]
    assert still.y[:, 0].tolist() == list(REPORT)


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.accuracy_warnings.DriftWarning")
def test_fixed_steps_end_at_the_end_of_the_span_and_do_not_drift() -> None:
    solution = integrate(sp, (0, 1), (1.0, 0.0), sp.DEFAULTS, method="rk4", h=0.3)
    assert solution.t == pytest.approx([0, 0.3, 0.6, 0.9, 1.0])
    assert solution.t[-1] == 1.0
    tenths = integrate(sp, (0, 100), (1.0, 0.0), sp.DEFAULTS, method="rk4", h=0.1)
    assert tenths.steps == 1000
    assert tenths.t[-2] == pytest.approx(99.9, abs=1e-12)


def report_lagrangian(y: np.ndarray) -> np.ndarray:
    """The slope as the report's program 3 intends it, for equal masses and lengths."""
    m, length, g = 1.0, 2.0, 9.81
    x, u, a, b = y
    d = length * (2 * m + m - m * np.cos(2 * x - 2 * u))
    return np.array([
        a, b,
        (-g * 3 * m * sin(x) - m * g * sin(x - 2 * u)
         - 2 * sin(x - u) * m * (b**2 * length + a**2 * length * np.cos(x - u))) / d,
        2 * sin(x - u) * (a**2 * length * 2 * m + g * 2 * m * np.cos(x)
                          + b**2 * length * m * np.cos(x - u)) / d,
    ])  # fmt: skip


def report_hamiltonian(y: np.ndarray) -> np.ndarray:
    """Hamilton's equations as the report's section on them ends, for equal masses and lengths."""
    m, length, g = 1.0, 2.0, 9.81
    x, u, p1, p2 = y
    c, s = np.cos(x - u), sin(x - u)
    d = 1 + s**2
    h1 = p1 * p2 * s / (m * length**2 * d)
    h2 = (p1**2 + 2 * p2**2 - 2 * p1 * p2 * c) * np.sin(2 * (x - u)) / (2 * m * length**2 * d**2)
    return np.array([
        (p1 - p2 * c) / (m * length**2 * d),
        (2 * p2 - p1 * c) / (m * length**2 * d),
        -2 * m * g * length * sin(x) - h1 + h2,
        -m * g * length * sin(u) + h1 - h2,
    ])  # fmt: skip


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("backend", ["python", "compiled"])
@pytest.mark.parametrize("form", ["lagrangian", "hamiltonian"])
def test_the_report_s_runge_kutta_is_reproduced_step_for_step(form: str, backend: str) -> None:
    # its program 3: h = 0.01, 5000 steps, from rest at (0, -π/4); written out here by hand
    h, slope = 0.01, report_lagrangian if form == "lagrangian" else report_hamiltonian
    y = np.array([0.0, -pi / 4, 0.0, 0.0])
    expected = [y]
    for _ in range(5000):
        k1 = slope(y)
        k2 = slope(y + h / 2 * k1)
        k3 = slope(y + h / 2 * k2)
        k4 = slope(y + h * k3)
        y = y + h * (k1 + 2 * k2 + 2 * k3 + k4) / 6
        expected.append(y)
    solution = integrate(
        dp, (0, 50), expected[0], dp.DEFAULTS, method="rk4", h=h, form=form, backend=backend
    )
    states = np.array(expected).T
    if form == "hamiltonian":
        states = dp.lagrangian_state_many(0.0, states, dp.DEFAULTS)
    assert solution.steps == 5000
    assert np.abs(solution.y - states).max() < 1e-10


def test_angles_of_the_rational_form_are_unwrapped() -> None:
    # fast enough to turn over: three turns say so
    spinning = [
        integrate(sp, (0, 4), (0.0, 7.0), sp.DEFAULTS, form=form, rtol=1e-11).y[0, -1]
        for form in ("lagrangian", "rational")
    ]
    assert spinning[0] > 2 * pi
    assert spinning[1] == pytest.approx(spinning[0], abs=1e-8)


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.accuracy_warnings.DriftWarning")
@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_the_rational_form_keeps_sine_and_cosine_together(backend: str) -> None:
    # each step of rk4 shortens sine and cosine by (0.7 rad)^6/144: if nothing restored them,
    # gravity and the oscillation of the velocity would be a third after 300 s
    times = np.linspace(0, 5, 101)
    velocity = integrate(
        sp,
        (0, 300),
        (0.0, 7.0),
        sp.DEFAULTS,
        method="rk4",
        form="rational",
        h=0.1,
        t_eval=[*times, *(295 + times)],
        backend=backend,
    ).y[1]
    assert np.ptp(velocity[101:]) == pytest.approx(np.ptp(velocity[:101]), rel=0.1)


@pytest.mark.parametrize(
    "method", ["gauss1", "gauss2", "gauss3", "radau2", "radau3", "radau5", "radau7"]
)
def test_implicit_methods_converge_where_fixed_point_iteration_does_not(method: str) -> None:
    # x' = -1e4 (x - cos t): steps a thousand times those of any explicit method
    module = handwritten(
        "hand",
        ("x", "x_dot"),
        COORDINATES=("x",),
        OPERATIONS={"rhs": (0, 0), "jacobian": (0, 0)},
        rhs=lambda t, y, params: (-1e4 * (y[0] - np.cos(t)), 0.0),
        jacobian=lambda t, y, params: ((-1e4, 0.0), (0.0, 0.0)),
    )
    solution = integrate(module, (0, 2), (1.0, 0.0), (1.0,), method=method, h=0.1)
    assert solution.status is Status.FINISHED
    assert solution.steps == 20
    assert solution.njev == 1  # it is constant
    assert solution.y[0, -1] == pytest.approx(np.cos(2.0), abs=1e-2)


def test_implicit_midpoint_conserves_the_energy_of_its_modified_equation() -> None:
    # E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, section IX.3: with
    # f = J ∇H, implicit midpoint conserves H - h²/24 H''(f, f) up to h⁴
    mass, length, g = sp.DEFAULTS
    rest = []
    for h in (0.1, 0.05, 0.025):
        run = integrate(sp, (0, 60), (1.0, 0.0), sp.DEFAULTS, method="gauss1", h=h, energy=True)
        assert run.energy is not None
        theta, omega = run.y
        pull = g / length
        second = pull * np.cos(theta) * omega**2 + (pull * np.sin(theta)) ** 2
        modified = run.energy / (mass * length**2) - h**2 / 24 * second
        rest.append(np.abs(modified - modified[0]).max())
    assert rest[0] < 1e-4
    assert np.log2(np.divide(rest[:-1], rest[1:])) == pytest.approx(4, abs=0.1)


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.accuracy_warnings.DriftWarning")
def test_implicit_midpoint_keeps_the_energy_where_other_methods_do_not() -> None:
    def growth(method: str) -> float:
        """Largest error of the energy in the second minute, over that in the first."""
        run = integrate(sp, (0, 120), (1.0, 0.0), sp.DEFAULTS, method=method, h=0.1, energy=True)
        assert run.energy is not None
        first, second = np.array_split(np.abs(run.energy - run.energy[0]), 2)
        return float(second.max() / first.max())

    assert growth("gauss1") == pytest.approx(1, abs=1e-3)
    assert min(growth(method) for method in ("rk1", "rk4", "radau2")) > 1.5


def test_angles_are_counted_even_where_a_step_turns_by_more_than_half() -> None:
    # 3.15 rad a step: so long a step blurs the angle, but counting by halves loses every turn
    solution = integrate(
        sp, (0, 10), (0.0, 35.0), (1, 2, 0), method="verner98", h=0.09, form="rational"
    )
    assert solution.y[0, -1] == pytest.approx(350.0, abs=2)


def test_a_system_at_rest_stays_at_rest_at_any_time_and_tolerance() -> None:
    for options in ({}, {"atol": 0.0}):
        solution = integrate(dp, (1e9, 1e9 + 10), (0, 0, 0, 0), dp.DEFAULTS, **options)
        assert solution.status is Status.FINISHED
        assert not solution.y.any()


def test_small_motions_of_implicit_methods_are_solved_as_well_as_large_ones() -> None:
    ends = [
        integrate(sp, (0, 3), (size, 0), sp.DEFAULTS, method="gauss3", h=0.05).y[0, -1] / size
        for size in (1e-12, 1e-6)
    ]
    assert ends[0] == pytest.approx(ends[1], rel=1e-9)


@pytest.mark.parametrize("method", EXPLICIT_PAIRS)
def test_every_embedded_pair_runs_in_solve_ivp(method: str) -> None:
    solution = solve_ivp(
        dp.rhs,
        (0, 5),
        REPORT,
        method=ode_solver(method),
        rtol=1e-8,
        atol=1e-8,
        t_eval=[1.0, 2.5, 5.0],
        args=(dp.DEFAULTS,),
    )
    assert solution.success
    assert np.abs(solution.y[:, -1] - END).max() < 1e-4
    reference = solve_ivp(
        dp.rhs, (0, 2.5), REPORT, method="DOP853", rtol=1e-12, atol=1e-12, args=(dp.DEFAULTS,)
    )
    assert np.abs(solution.y[:, 1] - reference.y[:, -1]).max() < 1e-4


def test_solve_ivp_runs_our_methods_backwards_with_events_and_refuses_unknown_options() -> None:
    def bottom(t: float, y: np.ndarray, params: object) -> float:
        return float(y[0])

    back = solve_ivp(
        sp.rhs,
        (2, 0),
        exact_pendulum(2.0, 2.0),
        method=ode_solver("tsit54"),
        rtol=1e-10,
        atol=1e-10,
        events=bottom,
        args=(sp.DEFAULTS,),
    )
    assert back.y[:, -1] == pytest.approx([2.0, 0.0], abs=1e-7)
    assert len(back.t_events[0]) == 1
    with pytest.raises(ValueError, match="no option lband"):
        solve_ivp(sp.rhs, (0, 1), (1, 0), method=ode_solver("dp54"), args=(sp.DEFAULTS,), lband=1)
    with pytest.raises(ValueError, match="does not estimate"):
        ode_solver("rk4")


@pytest.mark.parametrize("direction", [1, -1])
def test_solve_ivp_runs_our_methods_without_end_up_to_a_terminal_event(direction: int) -> None:
    def bottom(t: float, y: np.ndarray, params: object) -> float:
        return float(y[0])

    bottom.terminal = True  # type: ignore[attr-defined]
    run = partial(solve_ivp, sp.rhs, (0, direction * np.inf), (1.0, 0.0), args=(sp.DEFAULTS,))
    ours, scipys = (run(method=m, events=bottom) for m in (ode_solver("dp54"), "RK45"))
    assert ours.status == scipys.status == 1
    assert ours.t_events[0] == pytest.approx(scipys.t_events[0], rel=1e-2)
    endless = solve_ivp(lambda t, y: 0 * y, (0, np.inf), [1.0], method=ode_solver("dp54"))
    assert not endless.success
    assert "infinite" in endless.message


def test_solve_ivp_runs_our_methods_over_no_time() -> None:
    still = solve_ivp(lambda t, y: -y, (1, 1), [2.0], method=ode_solver("dp54"))
    assert still.success
    assert still.y[0].tolist() == [2.0] * len(still.t)


def test_our_methods_fail_in_scipys_interface_where_a_motion_grows_beyond_all_bounds() -> None:
    # y = 1/(1 - t)
    solver = ode_solver("dp54")(lambda t, y: y**2, 0.0, np.array([1.0]), 2.0)
    for _ in range(1000):
        message = solver.step()
        if solver.status != "running":
            break
    assert solver.status == "failed"
    assert "step size" in message
    assert solver.t == pytest.approx(1.0, rel=0.01)


def test_solve_ivp_runs_our_methods_over_a_span_of_one_rounding() -> None:
    end = np.nextafter(1.0, 2.0)
    brief = solve_ivp(lambda t, y: y, (1.0, end), [1.0], method=ode_solver("dp54"))
    assert brief.success
    assert brief.t.tolist() == [1.0, end]


@pytest.mark.parametrize(
    ("span", "options", "message"),
    [
        ((0, 1), {"first_step": 1.5}, "first_step = 1.5 must be at most 1.0"),
        ((0, np.nan), {}, r"t_span\[1\] = nan"),
        ((np.inf, 1), {}, r"t_span\[0\] = inf"),
    ],
)
def test_solve_ivp_refuses_spans_and_first_steps_that_our_methods_cannot_take(
    span: tuple[float, float], options: dict[str, float], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        solve_ivp(lambda t, y: -y, span, [1.0], method=ode_solver("verner853"), **options)


def test_small_angles_have_the_textbook_period() -> None:
    amplitude = 1e-4
    solution = integrate(sp, (0, 10), (amplitude, 0.0), sp.DEFAULTS, rtol=1e-11, atol=1e-16)
    omega = sqrt(sp.DEFAULTS[2] / sp.DEFAULTS[1])
    assert asin(sin(solution.y[0, -1])) == pytest.approx(amplitude * np.cos(omega * 10), abs=1e-11)
