"""Step control: the published rules, and nothing beyond their limits."""

import numpy as np
import pytest

from solvers.runge_kutta.step_control import GROW, SAFETY, SHRINK, Controller


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
