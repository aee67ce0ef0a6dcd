"""Gauss methods whose stages are evaluated at once: steps, accuracy, order, symplecticity."""

from fractions import Fraction
from math import pi

import numpy as np
import pytest
from mpmath import cos as mpcos
from mpmath import exp as mpexp
from mpmath import log as mplog
from mpmath import matrix, mpf, workdps
from mpmath import sin as mpsin
from scipy.special import ellipk

import generated.double_pendulum as dp
import generated.elastic_pendulum as ep
import generated.single_pendulum as sp
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.prepare import prepare
from solvers.integration.problem.status import Status
from solvers.runge_kutta.method_catalogue import load
from solvers.runge_kutta.parallel_stages import (
    EARLY,
    ParallelStages,
    Polynomial,
    rough_exp2,
    rough_log2,
    symplectic_ratios,
)
from solvers.runge_kutta.step_control import Controller
from solvers.runge_kutta.stepper import Stepper

PARALLEL = ["gauss4", "gauss8"]
FORMS = ["rational", "lagrangian", "hamiltonian"]
REPORT = (pi / 2, pi, 0.0, 0.0)


@pytest.mark.long("more cases of the same kind", keep=3)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("method", PARALLEL)
def test_python_and_c_take_the_same_steps(method: str, form: str) -> None:
    options = {"method": method, "form": form, "rtol": 1e-7, "atol": 1e-7}
    python, compiled = (
        integrate(dp, (0, 2), REPORT, dp.DEFAULTS, backend=backend, **options)
        for backend in ("python", "compiled")
    )
    # rounding decides whether some iterations are the last
    assert abs(python.steps - compiled.steps) <= 1
    assert abs(python.rejected - compiled.rejected) <= 1
    assert python.nfev == pytest.approx(compiled.nfev, rel=0.05)
    n = min(python.steps, compiled.steps) // 2
    assert python.t[:n] == pytest.approx(compiled.t[:n], rel=1e-5)
    assert python.y[:, -1] == pytest.approx(compiled.y[:, -1], abs=1e-6)


@pytest.mark.parametrize("method", PARALLEL)
@ignore_predictability()
def test_fixed_steps_agree_to_rounding(method: str) -> None:
    options = {"method": method, "h": 0.05, "form": "rational"}
    python, compiled = (
        integrate(dp, (0, 2), REPORT, dp.DEFAULTS, backend=backend, **options)
        for backend in ("python", "compiled")
    )
    assert np.abs(python.y - compiled.y).max() < 1e-12


@pytest.mark.parametrize(("method", "steps"), [("gauss4", 8), ("gauss8", 4)])
def test_the_proved_order_is_observed(method: str, steps: int) -> None:
    # y' = y cos t has y = exp(sin t); the stages solve a linear system
    tableau = load(method)
    stages = range(tableau.stages)

    def error(steps: int) -> mpf:
        y, h = mpf(1), mpf(2) / steps
        A = [[mpf(str(a)) for a in row] for row in tableau.A]
        for n in range(steps):
            slopes = [mpcos((n + mpf(str(c))) * h) for c in tableau.c]
            system = matrix([[(i == j) - h * slopes[i] * A[i][j] for j in stages] for i in stages])
            k = system**-1 * matrix([slope * y for slope in slopes])
            y += h * sum(mpf(str(b)) * k[i] for i, b in enumerate(tableau.b))
        return abs(y - mpexp(mpsin(2)))

    with workdps(60):
        observed = mplog(error(steps) / error(2 * steps), 2)
    assert float(observed) == pytest.approx(tableau.order, abs=0.2)


@pytest.mark.parametrize("method", PARALLEL)
@pytest.mark.parametrize("tolerance", [1e-4, 1e-8, 1e-11])
@ignore_predictability()
def test_errors_are_proportional_to_the_tolerance(method: str, tolerance: float) -> None:
    starts = np.zeros((4, 30))
    starts[:2] = np.random.default_rng(5).uniform(-2, 2, (2, 30))
    exact = ensemble(dp, (0, 3), starts, dp.DEFAULTS, method="verner98", rtol=1e-14, atol=1e-14)
    options = {"method": method, "rtol": tolerance, "atol": tolerance}
    ends = ensemble(dp, (0, 3), starts, dp.DEFAULTS, **options)
    errors = np.abs(ends.y - exact.y).max(axis=0) / tolerance
    assert ends.success.all()
    assert 0.01 < np.median(errors) < 30
    assert errors.max() < 1000  # some of these motions amplify errors a hundred times


@pytest.mark.parametrize("method", PARALLEL)
def test_errors_of_springs_of_any_stiffness_are_near_the_tolerance(method: str) -> None:
    # the first changes of the stages of long steps do not show how slowly later ones decrease
    rng, largest = np.random.default_rng(4), 0.0
    for _ in range(40):
        mass, length = rng.uniform(0.4, 1.5, 2)
        params, tolerance = (mass, 10 ** rng.uniform(1, 5), length, 9.81), 10 ** rng.uniform(-9, -4)
        start = ep.equilibrium(params)[0] * rng.uniform(0.95, 1.05), rng.uniform(-1, 1), 0, 0
        options = {"rtol": tolerance, "atol": 1e-3 * tolerance}
        run = integrate(ep, (0, 2), start, params, method=method, **options)
        tight = {"t_eval": run.t, "rtol": 1e-13, "atol": 1e-15}
        exact = integrate(ep, (0, 2), start, params, method="verner98", form="lagrangian", **tight)
        size = np.maximum(1, np.abs(exact.y).max(axis=1, keepdims=True))
        largest = max(largest, (np.abs(run.y - exact.y) / size).max() / tolerance)
    assert largest < 400


@pytest.mark.parametrize("backend", ["python", "compiled"])
@pytest.mark.parametrize("method", PARALLEL)
def test_states_within_steps_are_as_accurate_as_their_ends(method: str, backend: str) -> None:
    times = np.linspace(0, 2, 301)
    options = {"method": method, "backend": backend, "rtol": 1e-9, "atol": 1e-9}
    found = integrate(dp, (0, 2), REPORT, dp.DEFAULTS, t_eval=times, **options)
    exact = integrate(dp, (0, 2), REPORT, dp.DEFAULTS, t_eval=times, rtol=1e-13, atol=1e-13)
    plain = integrate(dp, (0, 2), REPORT, dp.DEFAULTS, **options)
    assert np.abs(found.y - exact.y).max() < 1e-8
    if backend == "compiled":  # the polynomial of the step predicts the stages of shorter ones
        iterations = (found.nfev - plain.nfev) / load(method).stages
        assert iterations / (301 - plain.steps) < 3.5


def test_a_polynomial_predicts_longer_and_shorter_steps() -> None:
    # h dy/dt = P_0 - 2 P_1 + P_2/2 at x = 2 t/h - 1, with h = 0.5
    polynomial, c = Polynomial(0.5, np.array([[1.0], [-2.0], [0.5]])), np.array([0.0, 0.3, 1.0])

    def slope(t: np.ndarray) -> np.ndarray:
        x = 4 * t - 1
        return (1 - 2 * x + (3 * x**2 - 1) / 4) / 0.5

    for predicted, t in (
        (polynomial.derivatives(0.2, c), 0.5 + 0.2 * c),
        (polynomial.within().derivatives(0.2, c), 0.2 * c),
    ):
        assert predicted[:, 0] == pytest.approx(0.2 * slope(t), abs=1e-15)


def test_a_step_with_a_large_error_ends_early_and_predicts_a_shorter_one() -> None:
    def motion(t: float, z: np.ndarray) -> np.ndarray:
        return np.array(dp.rhs_rational(t, z, dp.DEFAULTS))

    stepper = Stepper(load("gauss8"), motion, rtol=1e-9, atol=1e-9)
    z = np.array([1.0, 0.0, 0.0, -1.0, 0.0, 0.0])
    first = stepper.derivative(0.0, z)
    long = stepper.step(0.0, z, 0.8, first)
    assert long.error[0, 0] > 1
    assert stepper.nfev == 1 + EARLY * 8
    assert long.polynomial is not None
    evaluations = []
    for last in (None, long.polynomial.after_rejection()):
        stepper.nfev = 0
        short = stepper.step(0.0, z, 0.3, first, last)
        assert short.error[0, 0] < 1
        evaluations.append(stepper.nfev)
    assert evaluations[1] <= evaluations[0] - 8
    stepper.nfev = 0  # a state within an accepted step is iterated to the end
    stepper.step(0.0, z, 0.7, first, long.polynomial.within())
    assert stepper.nfev > EARLY * 8


def test_the_early_estimate_is_that_of_converged_stages() -> None:
    def motion(t: float, z: np.ndarray) -> np.ndarray:
        return np.array(dp.rhs_rational(t, z, dp.DEFAULTS))

    z, h = np.array([1.0, 0.0, 0.0, -1.0, 0.0, 0.0]), 0.3
    early = Stepper(load("gauss8"), motion, rtol=1e-9, atol=1e-9).step(0.0, z, h, motion(0.0, z))
    exact = Stepper(load("gauss8"), motion).step(0.0, z, h, motion(0.0, z))
    stages = ParallelStages(load("gauss8"), 1e-9, 1e-9)
    assert exact.polynomial is not None
    increments = np.linalg.solve(stages.legendre, exact.polynomial.coefficients)
    assert early.error[0, 0] == pytest.approx(stages.error_norm(z, increments), rel=0.2)


@pytest.mark.parametrize("method", PARALLEL)
def test_the_iteration_of_a_motion_at_rest_contracts_fast(method: str) -> None:
    tableau, rest = load(method), np.zeros(2)
    last = Polynomial.constant(0.1, rest, len(tableau.c))
    solved = ParallelStages(tableau, 1e-6, 1e-9).solve(np.zeros_like, np.ones(2), 0.1, last)
    assert not solved.increments.any()
    assert solved.contraction < 0.1


def test_the_error_is_estimated_again_where_the_iteration_is_slow() -> None:
    def oscillation(t: float, y: np.ndarray) -> np.ndarray:
        return np.array([y[1], -y[0]])

    y, stages = np.array([1.0, 0.0]), ParallelStages(load("gauss4"), 1e-3, 1e-3)
    stepper = Stepper(load("gauss4"), oscillation, rtol=1e-3, atol=1e-3)
    for h, is_slow in ((0.5, False), (4.5, True)):
        last = Polynomial(h, np.ones((4, 2)), largest_error=np.inf)
        step = stepper.step(0.0, y, h, oscillation(0.0, y), last)
        assert step.polynomial is not None
        increments = np.linalg.solve(stages.legendre, step.polynomial.coefficients)
        assert (step.contraction > 0.5) == is_slow
        is_final = step.error[0, 0] == pytest.approx(stages.error_norm(y, increments), rel=1e-9)
        assert is_final == is_slow


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_python_and_c_take_the_same_steps_where_the_iteration_is_slow(tolerance: float) -> None:
    stiff = (1.0, 1e4, 1.0, 9.81)
    start, options = (*ep.equilibrium(stiff), 0.0, 0.5), {"method": "gauss4", "form": "rational"}
    python, compiled = (
        integrate(
            ep, (0, 0.5), start, stiff, rtol=tolerance, atol=tolerance, backend=backend, **options
        )
        for backend in ("python", "compiled")
    )
    # later steps depend on rounding errors
    assert python.t[:12] == pytest.approx(compiled.t[:12], rel=1e-4)


def test_rough_logarithms_and_powers_are_inverse() -> None:
    for x in (1e-300, 0.3, 1.0, 1.5, 7.0, 1e200):
        assert rough_log2(x) == pytest.approx(np.log2(x), abs=0.0861)
        assert rough_exp2(rough_log2(x)) == pytest.approx(x, rel=1e-13)


def test_steps_do_not_grow_after_a_rejected_one() -> None:
    control = Controller.of(load("gauss8"), 1e-6, 1e-6)
    assert control.factor(1e-12, 1.0, 0.01) == 2.0
    assert control.factor(1e6, 1.0, 0.01) < 0.5
    assert control.factor(1e-12, 0.3, 0.01) == 1.0
    assert control.factor(1e-12, 0.3, 0.01) > 1.5
    assert control.factor(1e-12, 0.3, 0.8) == pytest.approx(0.5, rel=0.1)  # contracts slowly


@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_turns_are_counted_in_long_steps(backend: str) -> None:
    # the velocity of a wheel changes by twenty turns a second in every step
    found = integrate(
        sp, (0, 10), (0.0, 40.0), (1.0, 1.0, 9.81), method="gauss8", backend=backend,
        form="rational", rtol=1e-3, atol=1e-3,
    )  # fmt: skip
    exact = integrate(sp, (0, 10), (0.0, 40.0), (1.0, 1.0, 9.81))
    assert found.y[0, -1] == pytest.approx(exact.y[0, -1], abs=0.1)


@pytest.mark.parametrize("method", PARALLEL)
def test_ratios_are_exactly_symplectic(method: str) -> None:
    ratios, tableau = symplectic_ratios(load(method)), load(method)
    for i in range(tableau.stages):
        for j in range(tableau.stages):
            assert Fraction(ratios[i, j]) + Fraction(ratios[j, i]) == 1
            exact = Fraction(tableau.A[i][j]) / Fraction(tableau.b[j])
            assert abs(float(Fraction(ratios[i, j]) - exact)) < 3e-16


@pytest.mark.parametrize("backend", ["python", "compiled"])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_diverging_iteration_shortens_the_step(backend: str) -> None:
    # a spring a hundred times as fast as the swing limits the steps
    stiff = (1.0, 1e4, 1.0, 9.81)
    start = (*ep.equilibrium(stiff), 0.0, 0.5)
    options = {"rtol": 1e-6, "atol": 1e-6}
    found = integrate(ep, (0, 1), start, stiff, method="gauss8", backend=backend, **options)
    exact = integrate(ep, (0, 1), start, stiff, rtol=1e-12, atol=1e-12)
    assert found.status is Status.FINISHED
    # an error of the spring's length is one of its velocity, a hundred times as large; both depend
    # on roundings, from 2e-7 to 6e-4 in the velocity over starts that differ by 1e-15 to 1e-8
    errors = np.abs(found.y[:, -1] - exact.y[:, -1]) / [1, 1, 100, 1]
    assert errors.max() < 1e-4
    assert found.steps + found.rejected < 120
    loose = {"rtol": 1e-3, "atol": 1e-3, "method": "gauss8", "backend": backend}
    assert integrate(ep, (0, 1), start, stiff, **loose).nfev / 8 < 330  # a slow one, too
    fixed = integrate(ep, (0, 1), start, stiff, method="gauss8", h=0.5, backend=backend)
    assert fixed.status is Status.NO_CONVERGENCE


@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_a_motion_at_rest_stays_there(backend: str) -> None:
    found = integrate(dp, (0, 1), (0.0, 0.0, 0.0, 0.0), dp.DEFAULTS, method="gauss8", h=0.1)
    assert np.array_equal(found.y[:, -1], np.zeros(4))


@pytest.mark.long("other tests reach its code")
@pytest.mark.usefixtures("fused")  # the motions take longer than the compiler
@pytest.mark.parametrize("compensated", [False, True])
@pytest.mark.parametrize("form", ["hamiltonian", "rational"])
@pytest.mark.parametrize(
    ("periods", "steps"), [(1e4, 8.7), pytest.param(1e5, 15.7, marks=pytest.mark.campaign)]
)
def test_energy_has_no_drift_over_many_periods(
    periods: float, steps: float, form: str, compensated: bool
) -> None:
    # iterated to rounding: only rounding errors remain, whose sum is a random walk
    most, trends = 1e-13 * np.sqrt(periods / 1e4), []
    for angle in (1.2, 1.6, 2.0):
        period = 4 * ellipk(np.sin(angle / 2) ** 2) / np.sqrt(9.81)
        times = np.linspace(0, periods * period, 101)
        motion = integrate(
            sp, (0, times[-1]), (angle, 0.0), (1.0, 1.0, 9.81), t_eval=times, energy=True,
            method="gauss8", form=form, h=period / steps, compensated=compensated, max_steps=10**7,
        )  # fmt: skip
        assert motion.energy is not None
        change = (motion.energy - motion.energy[0]) / (9.81 * (1 - np.cos(angle)))
        assert np.abs(change).max() < most
        trends.append(np.polyfit(times, change, 1)[0] * times[-1])
    assert abs(np.mean(trends)) < 0.3 * most


@pytest.mark.campaign
@pytest.mark.parametrize("form", ["hamiltonian", "rational"])
def test_energy_of_two_pendulums_has_no_drift(form: str) -> None:
    period = 2 * pi * np.sqrt(2 / 9.81 / (2 - np.sqrt(2)))
    times = np.linspace(0, 1e5 * period, 1001)
    motion = integrate(
        dp, (0, times[-1]), (0.8, 0.6, 0.0, 0.0), dp.DEFAULTS, t_eval=times, energy=True,
        method="gauss8", form=form, h=period / 24, compensated=True, max_steps=10**7,
    )  # fmt: skip
    assert motion.energy is not None
    change = (motion.energy - motion.energy[0]) / 15  # J above rest
    assert np.abs(change).max() < 4e-13
    assert abs(np.polyfit(times, change, 1)[0] * times[-1]) < 3e-13


def test_prepared_calls_start_anew() -> None:
    run = prepare(dp, dp.DEFAULTS, method="gauss8")
    first = run((0, 3), REPORT)
    run((0, 1), (0.3, -0.2, 1.0, 0.5))
    assert run((0, 3), REPORT) == first
