"""Scenes choose compiled numbers longer than doubles before decimals, with honest estimates."""

from dataclasses import replace
from math import e

import numpy as np
import pytest
import sympy as sp

import generated.double_bar_pendulum as bars
import generated.double_pendulum as dp
from derive import Coordinate, Parameter, PointMass, System
from holonomic import build
from solvers.app.modules import load as load_module
from solvers.integration.accuracy import sufficient_run
from solvers.integration.accuracy.checked_run import CheckedRun
from solvers.integration.accuracy.integration_run import IntegrationRun
from solvers.integration.accuracy.method_choice import MethodChoice
from solvers.integration.accuracy.sufficient_run import by_longer_numbers
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.extended import PRECISIONS, integrate_extended, kernel
from solvers.references.taylor import taylor
from solvers.scenes.scene import Scene
from solvers.scenes.scene_output import figures, summary
from solvers.scenes.scene_reading import find
from solvers.scenes.scene_run import run_scene
from solvers.scenes.selection import ModelSelection, motion_of, select_model

#: The report's start, and states of its motion by Taylor series of 70 digits.
LONG = replace(find("long", load_module), beside=(), samples=201)
STATES = {
    20: (-1.580187362807668, -18.148119143908676, 2.9380149657028486, 0.037961618221198560),
    50: (0.9246154392560003, -41.66936175646693, -1.6931324145067102, -2.7513133475716174),
}


def selected(scene: Scene) -> ModelSelection:
    return select_model(scene, lambda motion, _: motion, lambda _: None)


def check(selection: ModelSelection, scene: Scene, precision: str) -> None:
    model = selection.model
    assert model.run.method_choice.precision == precision
    end = model.states(scene.times)[-1]
    error = np.abs(end - STATES[round(scene.duration)]).max()
    assert error <= model.error_estimate <= scene.accuracy
    assert "double precision" in selection.declined


def test_double_double_numbers_take_over_where_doubles_end() -> None:
    selection = selected(LONG)
    check(selection, LONG, "double-double")
    assert "at best where 1e-09 is requested" in selection.declined["double precision"]
    assert set(selection.declined).isdisjoint(PRECISIONS)


@pytest.fixture
def without_double_double(monkeypatch: pytest.MonkeyPatch) -> None:
    """As for right-hand sides that call functions."""
    rest = {name: PRECISIONS[name] for name in ("long double", "quadruple")}
    monkeypatch.setattr(sufficient_run, "PRECISIONS", rest)


@pytest.mark.usefixtures("without_double_double")
def test_long_double_takes_over_where_doubles_end() -> None:
    check(selected(LONG), LONG, "long double")


@pytest.mark.long("other tests reach its code")
@pytest.mark.usefixtures("without_double_double")
def test_quadruple_numbers_take_over_where_long_double_ends() -> None:
    scene = replace(LONG, accuracy=1e-13)
    selection = selected(scene)
    check(selection, scene, "quadruple")
    assert selection.declined["long double"].startswith("long double numbers reach ")
    assert "quadruple" not in selection.declined


@pytest.mark.long("a long motion with many digits")
def test_quadruple_numbers_take_over_where_sums_of_doubles_end() -> None:
    scene = replace(LONG, duration=50.0, accuracy=1e-11)
    selection = selected(scene)
    check(selection, scene, "quadruple")
    assert selection.declined["double-double"].startswith("double-double numbers reach ")
    assert "long double" not in selection.declined  # it has fewer digits


def test_double_double_numbers_reach_far_into_chaos() -> None:
    scene = replace(LONG, duration=50.0, accuracy=1e-7)
    check(selected(scene), scene, "double-double")


#: Starts of motions over 12 s whose runs agreed better than they were accurate, when they had the
#: rounding errors of parameters in common.
SIMILAR = (
    (-2.870972824798592, 0.9801352425190197, -0.692913465048465, -1.4562450955972648),
    (-2.163360934321107, 1.76976866521494, 1.8366638841576024, 0.08096277957231512),
    (-2.260530881726566, -1.5447388168112683, 0.4184801988737066, 0.9239854119141855),
    (2.3011056939145034, -2.260850233113736, -1.1485536891872465, 0.8809544506579132),
)


def test_every_check_has_a_perturbation_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    seeds, states = list[int](), IntegrationRun.extended_states

    def recorded(run, times, progress, perturbation=0):
        seeds.append(perturbation)
        return states(run, times, progress, perturbation)

    monkeypatch.setattr(IntegrationRun, "extended_states", recorded)
    by_longer_numbers(motion_of(LONG), 1e-9, LONG.times, {}, lambda _: None)
    assert seeds == [0, 1, 2, 3]


def test_runs_are_compared_where_motions_are_fast() -> None:
    # a comet is near its star for a ten millionth of its period, between all samples
    (x, y), mu = sp.symbols("x y", real=True), sp.Symbol("mu", positive=True)
    coordinates = [Coordinate(one, "m", "position") for one in (x, y)]
    strength = [Parameter(mu, "m^3/s^2", 1.0, "of the star")]
    potential = -mu / sp.sqrt(x**2 + y**2)
    comet = build(
        System("comet", "comet", coordinates, strength, [PointMass(1, (x, y))], potential)
    )
    farthest = 1.9999
    slowest = np.sqrt(2 / farthest - 1)
    scene = Scene(comet, comet.DEFAULTS, (farthest, 0.0, 0.0, slowest), 6.0, samples=9)
    run = IntegrationRun(motion_of(scene), MethodChoice("gauss8", "lagrangian", ""), 1e-12)
    times = sufficient_run._compared_times(run, scene.times)
    assert np.abs(times - np.pi).min() < 1e-5
    assert np.abs(np.array([*scene.times, *run.motion.sample_times]) - np.pi).min() > 1e-3


@pytest.mark.long("long motions with many digits")
def test_rounding_errors_of_constants_count() -> None:
    rng = np.random.default_rng(5)
    starts = [*SIMILAR, *rng.uniform(-2.5, 2.5, (12, 4)).tolist()]
    for start in starts:
        scene = Scene(bars, bars.DEFAULTS, tuple(start), 12.0, samples=61)
        limit = kernel(bars, "long double").epsilon
        arguments = motion_of(scene), "long double", limit, scene.times, lambda _: None
        model, _ = sufficient_run._checked(*arguments)
        exact = integrate_extended(bars, bars.DEFAULTS, start, scene.times, "quadruple", 1e-24)
        assert np.abs(model.states(scene.times) - exact).max() <= model.error_estimate


@pytest.mark.long("other tests reach its code")
def test_an_estimate_contains_the_error_that_series_show() -> None:
    scene = Scene(dp, (0.7, 1.3, 1.1, 0.9, 9.81), (2.0, -1.0, 1.0, 0.5), 4.0, 1e-12, samples=9)
    model = by_longer_numbers(motion_of(scene), 1e-12, scene.times, {}, lambda _: None)
    assert isinstance(model, CheckedRun)
    exact = taylor(dp, scene.params, scene.y0, scene.times, 24)
    assert np.abs(model.states(scene.times) - exact).max() <= model.error_estimate <= 1e-12
    other = np.array([0.1, 3.9])  # not computed before
    exact = taylor(dp, scene.params, scene.y0, [0.0, *other], 24)[1:]
    assert np.abs(model.states(other) - exact).max() <= model.error_estimate
    assert model.run.step_times()[-1] == 4.0


def test_without_a_compiler_decimals_take_over(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(module, name):
        raise NoCompilerError(f"no {name} numbers")

    def series(motion, choice, *arguments):
        return CheckedRun(IntegrationRun(motion, choice, 24), 1e-15)

    monkeypatch.setattr(sufficient_run, "kernel", missing)
    monkeypatch.setattr(sufficient_run, "by_series", series)
    result = selected(LONG)
    assert result.model.run.method_choice.is_series
    assert [result.declined[name] for name in PRECISIONS] == [
        f"no {name} numbers" for name in PRECISIONS
    ]


def test_quadruple_numbers_need_no_long_double(monkeypatch: pytest.MonkeyPatch) -> None:
    def only_quadruple(module, name):
        if name != "quadruple":
            raise NoCompilerError(f"no {name} numbers")
        return kernel(module, name)

    monkeypatch.setattr(sufficient_run, "kernel", only_quadruple)
    declined: dict[str, str] = {}
    scene = replace(LONG, duration=5.0)
    model = by_longer_numbers(motion_of(scene), 1e-14, scene.times, declined, lambda _: None)
    assert model.run.method_choice.precision == "quadruple"
    assert declined == {name: f"no {name} numbers" for name in ("double-double", "long double")}


def test_too_many_steps_and_too_little_accuracy_are_reasons(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    declined: dict[str, str] = {}
    scene = replace(LONG, duration=2.0)
    arguments = motion_of(scene), 1e-20, scene.times, declined, lambda _: None
    assert by_longer_numbers(*arguments) is None
    assert declined["double-double"].startswith("double-double numbers reach ")
    assert declined["quadruple"].startswith("quadruple numbers reach ")
    monkeypatch.setattr(sufficient_run, "MOST_PRODUCTS", 1e4)
    assert by_longer_numbers(*arguments) is None
    assert all("steps" in reason for reason in declined.values())


def test_growth_of_errors_is_extrapolated_where_they_are_large() -> None:
    times = np.linspace(0, 30, 301)
    errors = np.minimum(1e-18 * np.exp(2 * times), 1.0)
    assert sufficient_run._growth(times, errors, 1e-18) == pytest.approx(e**60, rel=1e-6)
    small = 1e-18 * np.exp(times / 10)
    assert sufficient_run._growth(times, small, 1e-18) == pytest.approx(e**3)
    assert sufficient_run._growth(times, np.ones(301), 1e-18) == 1.0


def test_a_named_method_is_not_replaced_and_the_summary_names_the_numbers() -> None:
    result = run_scene(LONG)
    line = list(summary(result))[1]
    assert "by gauss8, rational form, rtol = 1e-18, double-double numbers" in line
    assert figures(result)["precision"] == "double-double"
    assert result.method == "gauss8"
    choice = result.selection.model.run.method_choice
    assert choice.is_extended
    assert not choice.is_fixed
    assert not MethodChoice("rk4", "rational", "").is_extended
