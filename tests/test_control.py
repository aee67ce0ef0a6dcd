"""Step control: the published rules, and nothing beyond their limits."""

import numpy as np
import pytest

from solvers.control import GROW, SAFETY, SHRINK, Controller


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
    first = controller().first_step
    assert first(np.array([1.0]), np.array([1.0]), 10.0) == pytest.approx(0.01)
    assert first(np.array([1.0]), np.array([1.0]), -0.001) == 0.001
    assert first(np.array([0.0]), np.array([0.0]), 10.0) == 1e-6
