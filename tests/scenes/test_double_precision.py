"""Near the limit of double precision several runs check each other, before series take over."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

import generated.double_bar_pendulum as bars
import generated.double_pendulum as dp
import generated.henon_heiles as hh
import generated.swinging_atwood as atwood
from solvers.app.modules import load as load_module
from solvers.integration.accuracy import double_precision, integration_run, sufficient_run
from solvers.integration.accuracy.double_precision import sufficient
from solvers.integration.accuracy.integration_run import IntegrationRun, NotAccurateError
from solvers.integration.accuracy.method_choice import MethodChoice
from solvers.references.taylor import taylor
from solvers.scenes.scene import Scene
from solvers.scenes.scene_output import summary
from solvers.scenes.scene_reading import find
from solvers.scenes.selection import ModelSelection, motion_of, select_model

#: The report's scene over 20 s, in which errors grow by seven orders of magnitude.
LONG = Scene(dp, dp.DEFAULTS, (pi / 2, pi, 0, 0), 20.0, accuracy=1e-6)


def selected(scene: Scene, report=lambda _: None) -> ModelSelection:
    return select_model(scene, lambda motion, _: motion, report)


@pytest.mark.long("more cases of the same kind", daily=3)
@pytest.mark.slow
@pytest.mark.parametrize("scene", [
    replace(LONG, accuracy=2e-6),  # optimised less, loops round in another way
    replace(LONG, accuracy=1e-4),
    Scene(dp, (0.7, 1.3, 1.1, 0.9, 9.81), (2.0, -1.0, 1.0, 0.5), 10.0, accuracy=1e-8),
    Scene(bars, bars.DEFAULTS, (2.0, 2.5, 0, 0), 8.0, accuracy=2e-8),
    Scene(hh, (), (0.1, -0.2, 0.4, 0.1), 100.0, accuracy=2e-13),
    Scene(atwood, atwood.DEFAULTS, (1.5, 1.5, 0, 0), 10.0, accuracy=5e-12),
])  # fmt: skip
def test_doubles_suffice_near_their_limit(scene: Scene) -> None:
    selection = selected(scene)
    assert "double precision" not in selection.declined
    times = np.linspace(0, scene.duration, 21)
    exact = taylor(scene.module, scene.params, scene.y0, times, 28)
    error = np.abs(selection.model.states(times) - exact).max()
    assert error <= selection.model.error_estimate <= scene.accuracy


@pytest.mark.long("long motions")
def test_a_named_method_has_compensated_sums_where_it_needs_them() -> None:
    scene = Scene(dp, dp.DEFAULTS, (2.0, 2.5, 0, 0), 10.0, accuracy=1e-9, method="verner98")
    model = selected(scene).model
    assert model.run.is_compensated
    assert (model.run.method_choice.method, model.run.setting) == ("verner98", 2e-15)
    exact = taylor(dp, scene.params, scene.y0, [0.0, 10.0], 28)[-1]
    assert np.abs(model.states(np.array([10.0]))[0] - exact).max() <= model.error_estimate


def test_one_inaccurate_check_counts_for_nothing_and_two_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    motion, states = motion_of(replace(LONG, duration=5.0)), IntegrationRun.states
    bad: set[str] = set()

    def wrong(run, *arguments):
        return states(run, *arguments) + (run.method_choice.method in bad) * 1e-3

    monkeypatch.setattr(IntegrationRun, "states", wrong)
    expected = sufficient(motion, 1e-9)[1]
    bad.add("dop853")
    assert sufficient(motion, 1e-9)[1] <= 4 * expected < 1e-9
    bad.add("tsit54")  # then only one method agrees with itself
    assert sufficient(motion, 1e-9)[1] > 1e-3


def test_errors_are_estimated_at_the_times_that_are_returned() -> None:
    scene = Scene(dp, {}, {"theta1": 1.0, "theta2": 2.0}, 1.0, samples=37)
    motion = motion_of(scene)
    run = IntegrationRun(motion, MethodChoice("gauss8", "rational", ""), 1e-9)
    assert {*scene.times.tolist()} <= {*double_precision.check_times(run).tolist()}
    assert {*motion.sample_times.tolist()} <= {*double_precision.check_times(run).tolist()}


def test_of_many_steps_some_are_compared_all_along_the_motion(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    motion = motion_of(Scene(dp, {}, {"theta1": 1.0, "theta2": 2.0}, 10.0, samples=2))
    run = IntegrationRun(motion, MethodChoice("dp54", "rational", ""), 1e-6)
    steps = run.integrate(None)[0]
    monkeypatch.setattr(double_precision, "MOST_SAMPLES", 40)
    chosen = {*double_precision.check_times(run).tolist()} & {*steps.tolist()}
    assert 30 <= len(chosen) <= 42 < len(steps) / 2  # with both ends
    in_thirds, _ = np.histogram([*chosen], [steps[0], *steps[len(steps) // 3 :: len(steps) // 3]])
    assert in_thirds.min() > 8


def test_runs_that_do_not_reach_the_end_are_no_checks(monkeypatch: pytest.MonkeyPatch) -> None:
    motion, integrate = motion_of(replace(LONG, duration=5.0)), IntegrationRun.integrate

    def failing(run, *arguments):
        if run.method_choice.method != "verner98" or run.method_choice.form == "lagrangian":
            raise NotAccurateError("it does not reach the end")
        return integrate(run, *arguments)

    monkeypatch.setattr(IntegrationRun, "integrate", failing)
    with pytest.raises(NotAccurateError, match="2 of 5 runs reach the end"):
        sufficient(motion, 1e-9)


def test_two_checks_both_count(monkeypatch: pytest.MonkeyPatch) -> None:
    motion, states = motion_of(replace(LONG, duration=3.0)), IntegrationRun.states

    def failing(run, *arguments):
        if run.method_choice.method != "verner98":
            raise NotAccurateError("it does not reach the end")
        return states(run, *arguments) + (run.method_choice.form == "hamiltonian") * 1e-3

    monkeypatch.setattr(IntegrationRun, "states", failing)
    assert sufficient(motion, 1e-9)[1] > 1e-3


def test_one_method_alone_is_no_majority() -> None:
    motion = motion_of(LONG)
    choices = double_precision._choices(motion)
    best = [choice for choice in choices if choice.method == double_precision.BEST]
    # without the farthest of the others, one of another method remains
    assert len(choices) - 1 - 1 > len(best) - 1
    assert all(choice.compensated for choice in choices)


def test_without_a_compiler_sums_are_not_compensated(monkeypatch: pytest.MonkeyPatch) -> None:
    run = IntegrationRun(motion_of(LONG), double_precision._choices(motion_of(LONG))[0], 2e-15)
    assert run.options["compensated"]
    monkeypatch.setattr(integration_run, "no_compiler", lambda module: "no cc")
    assert "compensated" not in run.options


def test_series_report_progress_and_stop_at_their_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, lines = replace(LONG, duration=12.0, accuracy=1e-13), list[str]()
    monkeypatch.setattr(integration_run, "MAX_PRODUCTS", 1e6)
    monkeypatch.setattr(sufficient_run, "PRECISIONS", {})
    with pytest.raises(NotAccurateError, match=r"double precision reaches .* 1e\+06 products"):
        selected(scene, lines.append)
    assert lines[-1].startswith("Taylor series of 24 digits at ")


def test_the_summary_names_compensated_sums() -> None:
    from solvers.scenes.scene_run import run_scene

    result = run_scene(replace(find("report", load_module), accuracy=2e-13, beside=()))
    assert "verner98, rational form, rtol = 2e-15, compensated sums" in list(summary(result))[1]


def test_the_first_sufficient_run_is_selected_else_the_best(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    distances = 5.0, 3.0, 1.0, 2.0, 4.0  # of verner98 in three forms, tsit54, dop853
    monkeypatch.setattr(double_precision, "_distance", lambda _, k: distances[k])
    motion = motion_of(replace(LONG, duration=0.1))
    for accuracy, best in ((25.0, 0), (13.0, 1), (5.0, 2), (0.0, 2)):
        run, error = sufficient(motion, accuracy)
        assert error == double_precision.MARGIN * distances[best]
        assert run.method_choice.method == "verner98"
        if not best:
            assert run.method_choice.form == "rational"  # the fastest
