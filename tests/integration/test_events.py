"""Events of an integration: location, direction, terminal events, invalid events."""

import re
from functools import partial
from math import inf, nan, sin, sqrt
from typing import Any

import numpy as np
import pytest
from handwritten import handwritten
from numpy.testing import assert_allclose
from scipy.special import ellipk

import generated.double_pendulum as dp
import generated.elastic_pendulum as elastic
import generated.single_pendulum as sp
from solvers.equations.module import GeneratedModule
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.problem.events import Event, Extremum
from solvers.integration.problem.status import Status
from solvers.runge_kutta.stepper import Array


def test_events_are_located_to_rounding() -> None:
    def bottom(t: float, y: np.ndarray) -> float:
        return float(y[0])

    period = 4 * ellipk(sin(1.0) ** 2) / sqrt(sp.DEFAULTS[2] / sp.DEFAULTS[1])
    found = integrate(
        sp, (0, 3 * period), (2.0, 0.0), sp.DEFAULTS, events=bottom, rtol=1e-12, atol=1e-13
    )
    assert found.t_events[0] == pytest.approx(period * (np.arange(6) / 2 + 0.25), abs=1e-9)
    assert np.abs(found.y_events[0][:, 0]).max() < 1e-12


def test_events_have_a_direction_and_may_end_the_run() -> None:
    def bottom(t: float, y: np.ndarray) -> float:
        return float(y[0])

    bottom.direction, bottom.terminal = 1, True  # type: ignore[attr-defined]
    found = integrate(sp, (0, 20), (2.0, 0.0), sp.DEFAULTS, events=[bottom])
    assert found.status is Status.EVENT
    assert found.success
    assert found.y[1, -1] > 0
    assert found.t[-1] == found.t_events[0][0] == found.end[0]
    assert len(found.t_events[0]) == 1


def test_an_event_function_may_modify_its_argument() -> None:
    def spoiling(t: float, y: np.ndarray) -> float:
        y[:] = 0
        return 1.0

    run = partial(
        integrate, sp, (0, 1), (1.0, 0.0), sp.DEFAULTS, method="rk4", h=0.1, backend="python"
    )
    plain, watched = run(), run(events=spoiling)
    assert np.array_equal(plain.y, watched.y)


def test_a_run_can_resume_from_a_terminal_event() -> None:
    def bottom(t: float, y: np.ndarray) -> float:
        return float(y[0])

    bottom.terminal = True  # type: ignore[attr-defined]
    t, y, times = 0.0, np.array([2.0, 0.0]), []
    for _ in range(20):
        found = integrate(sp, (t, 100), y, sp.DEFAULTS, events=bottom, rtol=1e-10)
        t, y = found.end
        times.append(t)
    assert np.diff(times) == pytest.approx(np.diff(times)[0], rel=1e-6)


def test_flat_and_discontinuous_events_are_located() -> None:
    module = handwritten(
        "hand", ("x", "x_dot"), COORDINATES=("x",), rhs=lambda t, y, params: (1.0, 0.0)
    )
    for event in (
        lambda t, y: (t - 0.35) ** 5,
        lambda t, y: 1.0 if t > 0.35 else -1.0,
        lambda t, y: 1e-170 * (t - 0.35),
    ):
        found = integrate(module, (0, 1), (0.0, 0.0), (1.0,), method="rk4", h=0.3, events=event)
        assert found.t_events[0] == pytest.approx([0.35], abs=1e-3)


@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_both_crossings_near_an_extremum_are_located_to_rounding(backend: str) -> None:
    # a pendulum that starts at 1 rad from rest passes 0.9999 rad twice within a step
    motion = integrate(
        *(sp, (0, 20), (1.0, 0.0), {}), method="verner98", rtol=1e-13, backend=backend,
        events=Event(sp, "theta", 0.9999),
    )  # fmt: skip
    period = 4 * ellipk(np.sin(0.5) ** 2) * sqrt(2 / 9.81)
    first, *pairs = motion.t_events[0]
    before, after = np.reshape(pairs[: len(pairs) // 2 * 2], (-1, 2)).T
    turning = period * np.arange(1, len(before) + 1)
    assert len(before) == 6
    assert_allclose(before, turning - first, atol=1e-11)
    assert_allclose(after, turning + first, atol=1e-11)
    assert (after - before < np.diff(motion.t).min()).all()


@pytest.mark.parametrize(("module", "start", "values", "method"), [
    (dp, (0.5, 0.0, 0.0, 16.0), {"theta1": 3.0, "theta2": 7.0}, "gauss4"),
    # r is the first component of the rational form, and theta its first angle
    (elastic, (1.4, 3.0, 0.0, 1.5), {"r": 1.3, "theta": 3.5}, "rk4"),
])  # fmt: skip
def test_events_occur_in_an_ensemble_as_each_alone(
    module: GeneratedModule, start: tuple, values: dict[str, float], method: str
) -> None:
    events = [Event(module, name, value) for name, value in values.items()]
    starts = np.transpose([start, np.add(start, [0.1, 0.1, 0.0, 1.0])])

    def occurrences(*chosen: Event) -> tuple[Array, Array]:
        options = {"h": 0.02, "occurrences": 8, "method": method}
        found = ensemble(module, (0, 4), starts, module.DEFAULTS, events=list(chosen), **options)
        return found.occurred, found.t_events

    occurred, times = occurrences(*events)
    assert (occurred > 0).all()
    for k, event in enumerate(events):
        alone, own = occurrences(event)
        assert np.array_equal(occurred[:, k], alone[:, 0])
        assert_allclose(times[:, k], own[:, 0], rtol=1e-12)


def test_invalid_events_are_refused() -> None:
    for arguments, message in (
        (("theta3", 0.0), "did you mean 'theta2'"),
        (("theta1", float("nan")), "must be a finite real number"),
        (("theta1", 0.0, 2), "direction = 2"),
    ):
        with pytest.raises(ValueError, match=message):
            Event(dp, *arguments)


@pytest.mark.parametrize("method", ["verner853", "DOP853"])
@pytest.mark.parametrize("value", [nan, inf, 1j, None, True, "1", [1.0], np.zeros(1)], ids=repr)
def test_values_of_events_that_are_no_numbers_are_refused(value: Any, method: str) -> None:
    def height(t: float, y: Array) -> Any:
        return value

    with pytest.raises(ValueError, match=r"events\[0\] \(height\) at t = 0.0 = .* must be"):
        integrate(dp, (0, 1), (1.0, 0.0, 0.0, 0.0), dp.DEFAULTS, events=height, method=method)


@pytest.mark.parametrize("method", ["verner853", "DOP853"])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_an_event_that_becomes_nan_ends_the_run_with_the_results_so_far(method: str) -> None:
    def root(t: float, y: Array) -> float:
        return nan if t > 0.5 else 1.0

    start = (1.0, 0.0, 0.0, 0.0)
    run = integrate(dp, (0, 1), start, dp.DEFAULTS, events=root, method=method)
    assert run.status is Status.NOT_FINITE
    assert 0 < run.end[0] == run.t[-1] <= 0.5
    assert re.search(r"events\[0\] \(root\) at t = 0.* = nan .*\(t = .*, theta1 = ", run.message)


@pytest.mark.parametrize("name", ["direction", "terminal"])
def test_attributes_of_event_functions_are_checked(name: str) -> None:
    def height(t: float, y: Array) -> float:
        return 1.0

    setattr(height, name, "up")
    with pytest.raises(ValueError, match=rf"{name} of events\[0\] \(height\) = 'up' must be"):
        integrate(dp, (0, 1), (1.0, 0.0, 0.0, 0.0), dp.DEFAULTS, events=height)


def test_states_at_events_use_the_parameters_of_their_motion() -> None:
    # momenta become velocities with the masses of the motion in question
    starts = np.array([[0.1, 0.0, 0.0, 0.0], [2.0, 1.0, 0.0, 0.0], [1.5, 1.0, 0.0, 0.0]])
    params = np.array([[1.0, m, 1.0, 1.0, 9.81] for m in (0.3, 1.0, 3.0)])
    found = [
        ensemble(
            dp,
            (0, 2),
            starts.T,
            params.T,
            form=form,
            rtol=1e-11,
            events=Event(dp, "theta1", -0.5),
            t_eval=[1.0],
        )
        for form in ("hamiltonian", "lagrangian")
    ]
    assert found[0].occurred[:, 0].tolist()[0] == 0
    assert (found[0].occurred[1:, 0] > 0).all()
    for name in ("y_events", "t_events", "samples", "y"):
        assert_allclose(getattr(found[0], name), getattr(found[1], name), atol=1e-8)


@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_integration_of_one_motion_stores_all_extremes(backend: str) -> None:
    half = 2 * ellipk(sin(0.5) ** 2) / sqrt(sp.DEFAULTS[2] / sp.DEFAULTS[1])
    event, end = Extremum(sp, "theta_dot"), 6.5 * half
    run = integrate(
        sp, (0, end), (1.0, 0.0), sp.DEFAULTS, events=event, rtol=1e-11, backend=backend
    )
    assert_allclose(run.t_events[0], half * np.arange(1, 7), atol=1e-8)
    assert_allclose(run.y_events[0][:, 0], [-1, 1, -1, 1, -1, 1], atol=1e-8)


def test_extremes_have_two_occurrences_whatever_other_events_have() -> None:
    events = [Extremum(dp, "theta1_dot"), Event(dp, "theta1", 0.0)]
    found = [
        ensemble(
            dp,
            (0, 12),
            {"theta1": [1.0], "theta2": 0.5},
            {},
            events=events,
            occurrences=5,
            rtol=1e-11,
            backend=backend,
        )
        for backend in ("compiled", "python")
    ]
    assert (found[0].occurred > 4).all()
    for one in found:
        assert np.isnan(one.t_events[0, 0]).tolist() == [False, False, True, True, True]
        assert np.isfinite(one.t_events[0, 1]).all()
    assert_allclose(found[0].y_events, found[1].y_events, atol=1e-8)
    low, high = found[0].y_events[0, 0, 0, :2]
    assert low < -0.5 < 0.5 < high
