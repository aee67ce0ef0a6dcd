"""Step control: the published rules, and nothing beyond their limits."""

from dataclasses import replace
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp

from generated import coupled_pendulums
from solvers import ensemble
from solvers.runge_kutta.method_catalogue import load, names
from solvers.runge_kutta.step_control import GROW, SAFETY, SHRINK, Controller
from solvers.runge_kutta.stepper import Stepper
from solvers.runge_kutta.tableau import Tableau


def controller() -> Controller:
    return Controller(order=4, rtol=1e-3, atol=1e-6)


def test_a_norm_of_one_is_what_the_tolerances_allow() -> None:
    y, end = np.array([1.0, 0.0]), np.array([2.0, 0.0])
    assert controller().norm(np.array([2e-3 + 1e-6, 1e-6]), y, end) == pytest.approx(1.0)
    assert controller().norm(np.array([0.0, 1e-6]), y, end) == pytest.approx(np.sqrt(0.5))
    exact = Controller(order=4, rtol=0.0, atol=np.array([0.0, 1.0]))
    assert exact.norm(np.array([0.0, 1.0]), y, end) == pytest.approx(np.sqrt(0.5))


def test_after_a_step_in_vain_the_plain_rule_shortens_it() -> None:
    for norm in (1.5, 30.0):
        assert controller().factor(norm) == pytest.approx(SAFETY * norm**-0.2)
    assert controller().factor(1e9) == SHRINK


def test_after_a_kept_step_the_error_before_it_counts_too() -> None:
    steady, rising = controller(), controller()
    steady.factor(0.1)
    rising.factor(0.001)
    assert steady.factor(0.1) == pytest.approx(SAFETY * 0.1**-0.14 * 0.1**0.08)
    assert rising.factor(0.1) < steady.factor(0.1)
    assert controller().factor(0.0) == GROW


def test_a_step_in_vain_leaves_no_trace_in_the_memory() -> None:
    plain, tried = controller(), controller()
    plain.factor(0.2)
    tried.factor(0.2)
    tried.factor(50.0)
    assert tried.factor(0.3) == plain.factor(0.3)


@pytest.mark.parametrize("method", ["dp54", "radau3"])
def test_a_step_of_another_method_leaves_no_trace_in_the_memory(method: str) -> None:
    new, used = (Controller.of(load(method), 1e-3, 1e-6) for _ in range(2))
    used.factor(0.01, 0.5)
    used.forget()
    assert used.factor(0.3, 0.5) == new.factor(0.3, 0.5)


def test_absolute_tolerances_above_one_relax_no_error_estimate_of_radau_methods() -> None:
    error, y = np.array([[1e-3, 2e-3]]), np.array([1.0, 3.0])
    unit, large = (
        Controller.of(load("radau3"), 0.0, atol).norm(error, y, y) for atol in (1.0, 4.0)
    )
    assert large == pytest.approx(unit / 4, rel=1e-14)


def test_the_first_step_is_within_the_run_and_finite() -> None:
    def first(y: float, rate: float, duration: float) -> float:
        state = np.array([y])
        return controller().initial_step(lambda t, y: rate * y, 0.0, state, rate * state, duration)

    # y' = -y: bend and speed are 1 in parts of the state, 1/rtol in parts of what is allowed
    assert first(1.0, -1.0, 1e-3) == 1e-3
    assert first(1.0, -1.0, -1e-3) == 1e-3
    assert first(0.0, 0.0, 10.0) == pytest.approx(1e-4)
    gentle, lively = first(1.0, -1.0, 10.0), first(1.0, -100.0, 10.0)
    assert 0 < lively < gentle < 1.0


def test_a_slope_that_cannot_be_told_ahead_leaves_the_cautious_step() -> None:
    def broken(t: float, y: np.ndarray) -> np.ndarray:
        raise ArithmeticError

    one = np.array([1.0])
    assert controller().initial_step(broken, 0.0, one, one, 10.0) == pytest.approx(0.01)


def test_two_estimates_combine_as_published() -> None:
    y = np.array([1.0, 1.0])
    a, b = np.array([2e-3, 1e-3]), np.array([5e-2, 4e-2])
    first, second = (controller().norm(e, y, y) for e in (a, b))
    expected = first**2 / np.sqrt(first**2 + 0.01 * second**2)
    assert controller().norm(np.array([a, b]), y, y) == pytest.approx(expected, rel=1e-14)
    assert controller().norm(np.zeros((2, 2)), y, y) == 0.0


PAIRS = [name for name in names() if load(name).b_hat]
#: Places of kinks in a step of length 1, and the number of them over which errors are averaged.
PLACES, WINDOW = np.linspace(0, 0.995, 996), 100


def error_over_estimate(tableau: Tableau) -> float:
    """Largest ratio of the true error of a step with a kink to its estimate, over all places.

    Both are root mean squares over neighbouring places: a single estimate changes its sign.
    """

    def rhs(t: float, y: np.ndarray) -> np.ndarray:  # one component for each place of the kink
        return np.maximum(t - PLACES, 0.0)

    stepper, start = Stepper(tableau, rhs), np.zeros(len(PLACES))
    end, estimates, *_ = stepper.step(0.0, start, 1.0, rhs(0.0, start))
    control = Controller(order=tableau.error_order, rtol=0.0, atol=1.0)
    ones = np.ones(1)
    estimate = [control.norm(column[:, None], ones, ones) for column in estimates.T]
    true = end - (1 - PLACES) ** 2 / 2

    def averages(errors: ArrayLike) -> np.ndarray:
        return np.sqrt(np.convolve(np.square(errors), np.ones(WINDOW) / WINDOW, "valid"))

    return float(np.max(averages(true) / np.maximum(averages(estimate), 1e-300)))


@pytest.mark.parametrize("name", PAIRS)
def test_estimates_notice_a_kink_wherever_it_is_in_the_step(name: str) -> None:
    assert error_over_estimate(load(name)) < 150


def test_an_estimate_blind_to_half_of_the_step_exceeds_this_bound() -> None:
    # of the weights of order 6 that Verner's stages allow, those of the published pair: the
    # stages with nodes up to 0.465 hardly count
    tableau = load("verner853")
    late = np.array([0, 0, 0, 0, 0, 1e-4, -1e-4, 0.572, -0.256, 0.370, -0.686, 0])
    b_hat = tuple(Decimal(float(b) - e) for b, e in zip(tableau.b, late, strict=True))
    assert error_over_estimate(replace(tableau, b_hat=b_hat, b_low=())) > 300


@pytest.mark.long("motions of many systems")
def test_errors_of_the_default_method_stay_near_the_tolerance() -> None:
    # bobs that come close to each other bend the spring's force within a part of a step
    starts = np.random.default_rng(1).uniform(-1, 1, (4, 12))
    starts[:, 0] = -0.9, 1.0, 0.3, -0.53
    span, params, tol = (0.0, 20.0), coupled_pendulums.DEFAULTS, 1e-6
    exact = [  # a multistep method, whose largest error here is 3e-9
        solve_ivp(
            coupled_pendulums.rhs, span, y0, "LSODA", rtol=1e-12, atol=1e-12, args=(params,)
        ).y[:, -1]
        for y0 in starts.T
    ]

    def largest(**options: Any) -> float:
        y = ensemble(coupled_pendulums, span, starts, params, rtol=tol, atol=tol, **options).y
        return float(np.abs(y.T - exact).max() / tol)

    assert largest() < 40
    assert largest(method="dp54") > 200
