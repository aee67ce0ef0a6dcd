"""A requested accuracy: the error of every returned state is below it, by Taylor series."""

import re
from dataclasses import replace
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from random_motions import SYSTEMS, error_of, random_scene

import generated.double_pendulum as dp
import generated.driven_pendulum as driven
import generated.furuta_pendulum as furuta
import generated.single_pendulum as single
from solvers import Ensemble, Event, Held, ensemble, run_scene
from solvers.integration.accuracy.accurate_ensemble import AccuracyWarning, accurate_ensemble
from solvers.integration.accuracy.integration_run import (
    EndsEarlyError,
    IntegrationRun,
    NotAccurateError,
    TooLongError,
)
from solvers.integration.given_tolerances import many_motions
from solvers.integration.integrate import integrate
from solvers.integration.problem.inputs import Controller
from solvers.integration.problem.problem import Options
from solvers.integration.problem.status import Status
from solvers.references.taylor import taylor
from solvers.scenes.scene import Scene
from solvers.scenes.selection import motion_of

START = (2.0, 1.0, 0.0, 0.5)


def exact(module: ModuleType, times: np.ndarray, start: tuple[float, ...] = START) -> np.ndarray:
    """States at times, of which the first is that of the start, by series of 20 digits."""
    return series(module, start, tuple(times.tolist()))


@cache
def series(module: ModuleType, start: tuple[float, ...], times: tuple[float, ...]) -> np.ndarray:
    return np.array(taylor(module, module.DEFAULTS, start, times, 20), float).T


def check_motion(seed: int) -> None:
    """A random motion at uneven times, beside an independent reference."""
    scene = random_scene(seed)
    motion = motion_of(scene)
    times = scene.duration * np.sort([0.0, *np.random.default_rng([37, seed]).random(9)])
    arguments = scene.module, (0, scene.duration), scene.y0, scene.params
    try:
        solution = integrate(*arguments, accuracy=scene.accuracy, t_eval=times)
    except (EndsEarlyError, NotAccurateError, TooLongError):
        return
    assert solution.error_estimate is not None
    if solution.nfev:
        error = error_of(motion, solution.y.T, times, solution.error_estimate)
    else:  # where doubles lose the motion, as next to a pole, collocation in doubles does so, too
        exact = np.array(taylor(scene.module, scene.params, scene.y0, times.tolist(), 34), float)
        error = np.abs(solution.y - exact.T).max()
    assert error <= solution.error_estimate <= scene.accuracy, (seed, scene.module.SYSTEM)


@pytest.mark.long("more cases of the same kind", daily=12)
@pytest.mark.parametrize("seed", range(500, 500 + len(SYSTEMS)))
def test_errors_at_uneven_times_are_below_the_estimate(seed: int) -> None:
    check_motion(seed)


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(600, 1100))
def test_errors_of_hundreds_of_motions_are_below_the_estimates(seed: int) -> None:
    check_motion(seed)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-7, 1e-11])
def test_a_motion_runs_backwards(accuracy: float) -> None:
    times = np.array([5.0, 4.2, 1.0, 0.0])
    motion = integrate(dp, (5, 0), START, {}, accuracy=accuracy, t_eval=times)
    assert np.abs(motion.y - exact(dp, times)).max() <= motion.error_estimate <= accuracy


@pytest.mark.long("other tests reach its code")
def test_a_motion_backwards_in_longer_numbers() -> None:
    times = np.array([20.0, 13.0, 0.0])
    motion = integrate(dp, (20, 0), START, {}, accuracy=1e-11, t_eval=times)
    assert "numbers" in motion.run
    assert np.abs(motion.y - exact(dp, times)).max() <= motion.error_estimate <= 1e-11


def test_equations_that_depend_on_time_start_later() -> None:
    times, start = np.array([3.0, 4.5, 7.0]), (0.4, 0.1)
    motion = integrate(driven, (3, 7), start, {}, accuracy=1e-9, t_eval=times)
    assert np.abs(motion.y - exact(driven, times, start)).max() <= motion.error_estimate <= 1e-9


def test_without_times_the_ends_of_steps_are_returned() -> None:
    motion = integrate(dp, (0, 3), START, {}, accuracy=1e-8)
    assert len(motion.t) == motion.steps + 1
    assert np.abs(motion.y - exact(dp, motion.t)).max() <= motion.error_estimate <= 1e-8


@pytest.mark.long("other tests reach its code")
def test_long_motions_in_longer_numbers_have_times_of_steps() -> None:
    motion = integrate(dp, (0, 20), START, {}, accuracy=1e-11, energy=True)
    assert len(motion.t) > 50
    assert (motion.t[0], motion.t[-1], motion.end[0]) == (0.0, 20.0, 20.0)
    assert np.abs(motion.y - exact(dp, motion.t)).max() <= motion.error_estimate <= 1e-11
    assert np.ptp(motion.energy) < 1e-9


def test_the_motion_is_as_accurate_up_to_an_event_that_ends_it() -> None:
    event = Event(dp, "theta2", 0.0, terminal=True)
    motion = integrate(dp, (0, 1e5), START, {}, accuracy=1e-9, events=event, t_eval=[0.1, 0.2, 9e4])
    assert motion.status is Status.EVENT
    times = np.array([0.0, *motion.t, *motion.t_events[0]])
    states = np.column_stack([motion.y, motion.y_events[0].T])
    assert np.abs(states - exact(dp, times)[:, 1:]).max() <= 1e-9


def test_a_named_method_and_form_are_used() -> None:
    options = {"accuracy": 1e-6, "method": "dp54", "form": "hamiltonian"}
    motion = integrate(dp, (0, 3), START, {}, t_eval=[3.0], **options)
    assert motion.run.startswith("Dormand-Prince 5(4), hamiltonian form")
    error = np.abs(motion.y[:, 0] - exact(dp, np.array([0.0, 3.0]))[:, 1]).max()
    assert error <= motion.error_estimate <= 1e-6


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(("inputs", "h"), [
    (Held([0.0, 0.5, 1.1], [[2.0, -1.0, 0.3]]), 5e-4),
    (lambda t, y: [-3 * y[0] - 2 * y[2] + np.sin(t)], 2e-3),
], ids=["held", "controller"])  # fmt: skip
def test_inputs_that_vary_are_those_of_the_checks(inputs: Held | Controller, h: float) -> None:
    arguments, times = (furuta, (0, 1.5), (0.1, 0.2, 0.0, 0.0), {}), [0.3, 1.0, 1.5]
    options = {"t_eval": times, "inputs": inputs}
    motion = integrate(*arguments, accuracy=1e-8, **options)
    fine = integrate(*arguments, method="gauss3", h=h, form="lagrangian", **options)
    assert np.abs(motion.y - fine.y).max() <= motion.error_estimate <= 1e-8


def test_scenes_integrate_in_the_same_way() -> None:
    scene = Scene(dp, dp.DEFAULTS, START, 5.0, accuracy=1e-8, samples=51)
    result = run_scene(scene)
    motion = integrate(dp, (0, 5), START, {}, accuracy=1e-8, t_eval=result.t)
    assert np.array_equal(motion.y, result.y)
    assert motion.error_estimate == result.selection.model.error_estimate


def test_the_error_estimates_of_all_values_are_the_bound() -> None:
    motion = integrate(single, (0, 3), (1.0, 0.0), {}, accuracy=1e-6, t_eval=[1.0, 3.0])
    assert np.array_equal(motion.global_error_estimate, np.full((2, 2), motion.error_estimate))
    assert f"error below {motion.error_estimate:.1e}" in repr(motion)
    assert replace(motion, error_estimate=None).run == motion.run


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"accuracy": 0.0}, "accuracy = 0.0 must be positive"),
        ({"accuracy": float("nan")}, "accuracy"),
        ({"accuracy": "high"}, "accuracy"),
        ({"accuracy": 1e-6, "rtol": 1e-8}, "rtol = 1e-08 beside accuracy, which determines it"),
        ({"accuracy": 1e-6, "atol": [1e-9] * 4}, "atol = "),
        ({"accuracy": 1e-6, "h": 0.01}, "h = 0.01 beside accuracy"),
        ({"accuracy": 1e-6, "backend": "python"}, "backend = python beside accuracy"),
        ({"accuracy": 1e-6, "form": "variational"}, "perturbations are not checked"),
    ],
)
def test_what_an_accuracy_excludes_is_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        integrate(dp, (0, 1), START, {}, **options)


def test_longer_numbers_locate_no_events() -> None:
    with pytest.raises(ValueError, match=r"numbers, .* in which no events are located"):
        integrate(dp, (0, 20), START, {}, accuracy=1e-11, events=lambda t, y: y[0])


def test_an_accuracy_that_nothing_reaches_is_refused_early(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    states, digits = IntegrationRun.states, []

    def recorded(run: IntegrationRun, *arguments: object) -> object:
        digits.append(run.setting)
        return states(run, *arguments)

    monkeypatch.setattr(IntegrationRun, "states", recorded)
    with pytest.raises(NotAccurateError, match=r"error of up to .* where 1e-18 is requested"):
        integrate(dp, (0, 0.1), START, {}, accuracy=1e-18, t_eval=[0.1])
    # more digits cannot reduce the rounding of results
    assert digits[-2:] == [24, 36]


def check_ensemble(motions: Ensemble, starts: np.ndarray, accuracy: float) -> None:
    """Every returned state beside series."""
    assert motions.success.all()
    for k, start in enumerate(starts.T):
        times = np.array([0.0, *motions.t_eval, motions.t[k]])
        states = np.column_stack([motions.samples[:, k], motions.y[:, k]])
        error = np.abs(states - exact(dp, times, tuple(start))[:, 1:]).max()
        assert error <= motions.error_estimate[k] <= accuracy


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("accuracy", [1e-4, 1e-8])
def test_errors_of_all_motions_of_an_ensemble_are_below_the_estimates(accuracy: float) -> None:
    starts = np.random.default_rng(1).uniform(-2, 2, (4, 9))
    motions = ensemble(dp, (0, 5), starts, {}, accuracy=accuracy, t_eval=[0.7, 3.1])
    check_ensemble(motions, starts, accuracy)


@pytest.mark.long("other tests reach its code")
def test_chaotic_motions_of_an_ensemble_are_integrated_in_longer_numbers() -> None:
    starts = np.array([[0.1, 2.0], [0.0, 1.0], [0.0, 0.0], [0.0, 0.5]])
    motions = ensemble(dp, (0, 15), starts, {}, accuracy=1e-11, t_eval=[4.0, 15.0])
    check_ensemble(motions, starts, 1e-11)
    assert motions.nfev[0] > motions.nfev[1] == 0


def test_motions_in_longer_numbers_end_after_the_requested_times() -> None:
    motions = ensemble(dp, (0, 2), np.transpose([START]), {}, accuracy=1e-14, t_eval=[1.0])
    assert motions.nfev[0] == 0
    check_ensemble(motions, np.transpose([START]), 1e-14)


@pytest.mark.long("other tests reach its code")
def test_motions_of_an_ensemble_have_their_own_ends_parameters_and_times() -> None:
    starts, lengths = {"theta": [0.5, 2.0], "theta_dot": 0.0}, np.array([0.7, 1.6])
    times = np.array([[0.3, 1.0], [0.4, 2.0]])
    motions = ensemble(single, (0, [1.0, 2.5]), starts, {"l": lengths}, accuracy=1e-9, t_eval=times)
    for k, (angle, end) in enumerate(((0.5, 1.0), (2.0, 2.5))):
        params = single.params(l=lengths[k])
        states = np.array(taylor(single, params, (angle, 0.0), [0.0, *times[k], end], 30), float)
        returned = np.vstack([motions.samples[:, k].T, motions.y[:, k]])
        assert np.abs(returned - states[1:]).max() <= motions.error_estimate[k] <= 1e-9


def test_an_ensemble_reports_motions_above_the_accuracy() -> None:
    starts, event = (
        np.array([[0.1, 2.0], [0.0, 1.0], [0.0, 0.0], [0.0, 0.5]]),
        Event(dp, "theta1", 0),
    )
    with pytest.warns(AccuracyWarning, match="1 motion of 2 are above 1e-11"):
        motions = ensemble(dp, (0, 15), starts, {}, accuracy=1e-11, events=event)
    assert motions.error_estimate[0] <= 1e-11 < motions.error_estimate[1]


@pytest.mark.long("a random scene beside eight motions of higher accuracy")
def test_estimates_of_ensembles_contain_the_errors_of_the_checks() -> None:
    """Where roundings grow to the accuracy, checks err as much as the motions."""
    scene = random_scene(2101)
    starts = np.array(scene.y0)[:, np.newaxis] * np.random.default_rng(2101).uniform(
        0.9, 1.1, (4, 8)
    )
    times = [scene.duration / 3, scene.duration]
    arguments = scene.module, (0, scene.duration)
    motions = ensemble(*arguments, starts, scene.params, accuracy=1e-10, t_eval=times)
    for k, start in enumerate(starts.T):
        exact = integrate(*arguments, start, scene.params, accuracy=1e-12, t_eval=times)
        error = np.abs(motions.samples[:, k] - exact.y).max()
        assert error <= motions.error_estimate[k] + exact.error_estimate
        assert motions.error_estimate[k] <= 1e-10


@pytest.mark.long("other tests reach its code")
def test_constant_inputs_are_those_of_motions_in_longer_numbers() -> None:
    arguments = furuta, (0, 0.1), (0.1, 0.2, 0.0, 0.0), {"tau": 0.1}
    motion = integrate(*arguments, accuracy=1e-15, t_eval=[0.02, 0.1])
    assert "numbers" in motion.run
    assert motion.inputs.tolist() == [[0.1, 0.1]]


def test_motions_that_no_check_reaches_are_repeated_with_a_tenth_of_the_tolerance() -> None:
    tolerances: list[float] = []

    def run(*arguments: Any) -> Ensemble:
        tolerances.append(arguments[-1].rtol)
        motions = many_motions(*arguments)
        if len(tolerances) in (2, 3):  # the checks of the first run
            motions.status[:] = Status.STEP_LIMIT
        return motions

    start = np.array([[1.0], [0.0]])
    motions = accurate_ensemble(single, (0, 1), start, {}, Options(), 1e-6, run)
    assert motions.error_estimate[0] <= 1e-6
    assert tolerances[3] == pytest.approx(tolerances[0] / 10)
