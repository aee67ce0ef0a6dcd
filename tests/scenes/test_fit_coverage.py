"""Confidence intervals contain the true values as often as they state."""

import numpy as np
import pytest

import generated.driven_pendulum as driven
import generated.single_pendulum as single
from solvers import fit, integrate
from solvers.scenes.fitting.statistics import ConfidenceInterval

T = np.arange(0, 3, 1 / 12)


def fitted(t: np.ndarray, theta: np.ndarray) -> ConfidenceInterval:
    return fit(single, {"t": t, "theta": theta}, ["l"], params={"l": 0.65}).intervals["l"]


def coverage(number: int, values: int = len(T)) -> tuple[float, float]:
    """The part of intervals that contain l, and of those of half the width."""
    t = T[:values]
    motion = integrate(single, (0, 3), {"theta": 1.5}, {"l": 0.6}, t_eval=t, rtol=1e-11)
    noise = 0.05 * np.random.default_rng(7).normal(size=(number, len(t)))
    inside = [
        abs(interval.value - 0.6) / (interval.high - interval.value)
        for row in noise
        for interval in [fitted(t, motion.y[0] + row)]
    ]
    return float(np.mean(np.array(inside) < 1)), float(np.mean(np.array(inside) < 0.5))


@pytest.mark.long("other tests reach its code")
def test_95_percent_intervals_contain_the_true_value_in_most_of_100_fits() -> None:
    whole, half = coverage(100)
    assert 0.9 <= whole <= 0.99  # a chance of 1 in 50 to be outside
    assert half < 0.8


def test_few_values_have_wide_intervals_by_students_distribution() -> None:
    # with 3 degrees of freedom, a normal distribution's intervals would contain 85 %
    assert coverage(60, 6)[0] >= 0.9


@pytest.mark.campaign
def test_95_percent_intervals_contain_the_true_value_in_93_to_97_percent_of_1000_fits() -> None:
    whole, half = coverage(1000)
    assert 0.93 <= whole <= 0.97
    assert 0.6 < half < 0.73


@pytest.mark.campaign
def test_intervals_of_several_parameters_and_quantities_cover_as_often() -> None:
    truth = {"l": 0.8, "a": 0.05, "Omega": 6.0, "c": 0.2}
    motion = integrate(driven, (0, 3), {"theta": 1.5}, truth, t_eval=T, rtol=1e-11)
    noise = np.random.default_rng(8).normal(size=(1000, 2, len(T))) * [[0.01], [0.2]]
    hits = dict.fromkeys(truth, 0)
    for row in noise:
        theta, theta_dot = motion.y + row
        data = {"t": T, "theta": theta, "theta_dot": theta_dot}
        intervals = fit(driven, data, [*truth], params=truth).intervals
        for name, value in truth.items():
            hits[name] += intervals[name].low < value < intervals[name].high
    assert all(925 <= count <= 970 for count in hits.values()), hits
