"""Fits recover parameters from noisy data, as closed forms and other programs do."""

from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares
from scipy.special import stdtrit
from scipy.stats import sem

import generated.double_pendulum as dp
import generated.driven_pendulum as driven
import generated.elastic_pendulum as elastic
import generated.single_pendulum as single
from derive import Coordinate, Parameter, PointMass, System, velocity
from solvers import Measurement, build, compare, fit, integrate
from solvers.app.fitting import _model
from solvers.equations.module import GeneratedModule
from solvers.scenes.fitting import least_squares as shooting_steps
from solvers.scenes.fitting import prediction
from solvers.scenes.fitting.estimate import _is_noise, _parabolas
from solvers.scenes.fitting.experiment import Experiment
from solvers.scenes.fitting.measurement import Outputs
from solvers.scenes.fitting.multiple_shooting import (
    MultipleShooting,
    NoResidualsError,
    segments,
)
from solvers.scenes.fitting.statistics import leverages


@cache
def oscillator() -> GeneratedModule:
    x, (m, k, c) = sp.Symbol("x", real=True), sp.symbols("m k c", positive=True)
    parameters = [Parameter(m, "kg", 1.0, "mass"), Parameter(k, "N/m", 4.0, "stiffness"),
        Parameter(c, "N s/m", 0.3, "friction")]  # fmt: skip
    return build(
        System("damped", "A damped oscillator", [Coordinate(x, "m", "a length")], parameters,
            [PointMass(m, (x, 0))], potential=k * x**2 / 2, gravity=(0, 0),
            dissipation=c * velocity(x) ** 2 / 2)
    )  # fmt: skip


def measured(module: GeneratedModule, y0: Any, params: Any, t: Any, noise: float, seed: int = 0):
    """Coordinates with noise, by name."""
    states = integrate(module, (t[0], t[-1]), y0, params, t_eval=t, rtol=1e-11, atol=1e-11).y
    values = states[: len(module.COORDINATES)]
    values = values + noise * np.random.default_rng(seed).normal(size=values.shape)
    return dict(zip(module.COORDINATES, values, strict=True))


T = np.arange(0, 6, 1 / 20)


@pytest.mark.long("other tests reach its code")
def test_a_damped_oscillator_is_fitted_as_by_its_closed_form() -> None:
    data = measured(oscillator(), {"x": 1.0}, {}, T, 0.05)

    def residuals(unknown: Any) -> Any:
        k, c, x0, v0 = unknown
        w = np.sqrt(k - c**2 / 4)
        motion = np.exp(-c * T / 2) * (x0 * np.cos(w * T) + (v0 + c * x0 / 2) / w * np.sin(w * T))
        return motion - data["x"]

    truth = least_squares(residuals, (4, 0.3, 1, 0), x_scale="jac", xtol=1e-15, ftol=1e-15)
    variance = 2 * truth.cost / (len(T) - 4)
    covariance = variance * np.linalg.inv(truth.jac.T @ truth.jac)
    result = fit(oscillator(), {"t": T, **data}, ["k", "c"], params={"k": 9.0, "c": 1.0})
    assert np.allclose([result.params["k"], result.params["c"]], truth.x[:2], rtol=1e-6)
    assert np.allclose(result.estimate.starts[0], truth.x[2:], atol=1e-6)
    assert np.allclose(result.errors, np.sqrt(np.diag(covariance))[:2], rtol=1e-4)
    expected = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    assert result.correlations[0, 1] == pytest.approx(expected, abs=1e-3)
    assert result.noise["x"] == pytest.approx(np.sqrt(variance), rel=1e-6)
    k = result.intervals["k"]
    assert (k.high - k.low) / 2 == pytest.approx(stdtrit(len(T) - 4, 0.975) * k.error, rel=1e-12)


@pytest.mark.long("other tests reach its code")
def test_gaps_are_left_out() -> None:
    data = measured(oscillator(), {"x": 1.0}, {}, T, 0.02)
    keep = np.random.default_rng(3).random(len(T)) > 0.3
    keep[40:60] = False
    gaps = np.where(keep, data["x"], np.nan)
    shorter = fit(oscillator(), {"t": T[keep], "x": data["x"][keep]}, ["k", "c"])
    result = fit(oscillator(), {"t": T, "x": gaps}, ["k", "c"])
    assert np.allclose(result.estimate.params, shorter.estimate.params, rtol=1e-6)
    assert result.estimate.degrees == keep.sum() - 4
    assert np.isnan(result.residuals[0][0, ~keep]).all()


@pytest.mark.long("other tests reach its code")
def test_a_double_pendulum_is_fitted_as_by_single_shooting_with_scipy() -> None:
    params = dp.params(m2=0.7, l1=1.3, l2=0.9)
    t = T[:60]
    data = measured(dp, {"theta1": 1.0, "theta2": -0.5}, params, t, 0.01)
    result = fit(dp, {"t": t, **data}, ["m2", "l1", "l2"])
    noise = result.estimate.noise[:, np.newaxis]

    def residuals(unknown: Any) -> Any:
        values = dp.params(m2=unknown[0], l1=unknown[1], l2=unknown[2])
        span, exact = (0, t[-1]), {"rtol": 1e-10, "atol": 1e-10}
        run = solve_ivp(dp.rhs, span, unknown[3:], "DOP853", t, args=(values,), **exact)
        return ((run.y[:2] - np.array([*data.values()])) / noise).ravel()

    start = [0.7, 1.3, 0.9, *result.estimate.starts[0]]
    truth = least_squares(residuals, start, x_scale="jac", diff_step=1e-6, xtol=1e-12)
    errors = np.sqrt(np.diag(np.linalg.inv(truth.jac.T @ truth.jac)))[:3]
    found = [result.params[name] for name in ("m2", "l1", "l2")]
    assert np.allclose(found, truth.x[:3], atol=1e-3 * errors.min())
    assert np.allclose(result.errors, errors, rtol=1e-3)


@pytest.mark.long("other tests reach its code")
def test_poor_guesses_of_a_chaotic_motion_converge_where_single_shooting_does_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    t, params = np.arange(0, 9, 1 / 30), dp.params(m2=0.7, l1=1.3, l2=0.9)
    data = measured(dp, {"theta1": 2.0, "theta2": 2.2}, params, t, 0.01)
    first = {"m2": 1.5, "l1": 2.0, "l2": 0.5}
    result = fit(dp, {"t": t, **data}, [*first], params=first)
    assert abs(result.params["l1"] - 1.3) < 4 * result.intervals["l1"].error < 0.01
    assert result.estimate.iterations < 10
    outputs = Outputs(("theta1", "theta2"), ("rad", "rad"), dp)
    run = Measurement(t, data)
    one = Experiment(outputs, [run], [*first], np.array(params), [[0]])
    start, guess, noise = np.array([[2.0, 2.2, 0.0, 0.0]]), np.array([*first.values()]), np.ones(2)
    monkeypatch.setattr(shooting_steps, "MOST_ITERATIONS", 10)
    with pytest.raises(shooting_steps.NotConvergedError):  # although the start is known
        shooting_steps.minimise(one.linearise(noise), start, guess, one.positive, np.ones(4))


def test_positions_and_formulas_are_fitted() -> None:
    params = dp.params(l1=1.3, l2=0.9)
    motion = integrate(dp, (0, 6), {"theta1": 1.0, "theta2": -0.5}, params, t_eval=T, rtol=1e-11)
    positions = dp.positions_many(0.0, motion.y, params)
    (x1, y1), (x2, y2) = positions + 0.003 * np.random.default_rng(1).normal(size=positions.shape)
    data = {"t": T, "x1 [cm]": 100 * x1, "y1": y1, "x2": x2,
        "-l1*cos(theta1) - l2*cos(theta2) [mm]": 1000 * y2}  # fmt: skip
    result = fit(dp, data, ["l1", "l2", "g", "m2"])
    for name, true in (("l1", 1.3), ("l2", 0.9), ("g", 9.81), ("m2", 1.0)):
        assert abs(result.params[name] - true) < 4 * result.intervals[name].error < 0.1 * true
    assert all(0.0025 < noise < 0.0035 for noise in result.noise.values())


def test_several_runs_share_parameters_and_angles_may_jump_by_whole_turns() -> None:
    runs = []
    for start in (1.0, 2.5):
        data = measured(single, {"theta": start, "theta_dot": 9.0}, {"l": 0.4}, T + start, 0.02)
        wrapped = np.mod(data["theta"] + np.pi, 2 * np.pi) - np.pi
        assert np.ptp(data["theta"]) > 7 > np.ptp(wrapped)
        runs.append(Measurement(T + start, {"theta": wrapped}, f"run {start}"))
    result = fit(single, runs, ["l"])
    assert abs(result.params["l"] - 0.4) < 4 * result.intervals["l"].error < 0.02
    assert [run.shape for run in result.residuals] == [(1, len(T))] * 2
    assert result.starts[1]["theta"] == pytest.approx(2.5, abs=0.05)


@pytest.mark.long("other tests reach its code")
def test_equations_that_depend_on_time_keep_their_clock() -> None:
    params = {"a": 0.3, "Omega": 3.0, "c": 0.1}
    t = T + 1.7
    data = measured(driven, {"theta": 0.5}, params, t, 0.01)
    result = fit(driven, {"t": t, **data}, ["a", "Omega"], params=params | {"a": 0.2})
    assert abs(result.params["Omega"] - 3.0) < 4 * result.intervals["Omega"].error < 0.05


def test_arcs_have_the_derivatives_that_differences_have() -> None:
    params, node = np.array(dp.params(m2=0.6)), np.array([[0.4, 1.1, -0.3, 0.8]])
    parts = segments(0, np.linspace(0, 1, 5), [0])
    shooting, h = MultipleShooting(dp, [1, 4], parts), 1e-4
    arcs = shooting(node, params)
    for column in range(6):
        ends = []
        for sign in (1, -1):
            changed, values = node.copy(), params.copy()
            if column < 4:
                changed[0, column] += sign * h
            else:
                values[[1, 4][column - 4]] += sign * h
            ends.append(shooting(changed, values).y[0])
        difference = (ends[0] - ends[1]) / (2 * h)
        assert np.allclose(arcs.by[0, column].T, difference, atol=1e-6)
    assert np.allclose(arcs.y[0, :, -1], arcs.ends[0])
    assert np.allclose(arcs.by[0, :, -1].T, arcs.ends_by[0])


def test_models_are_compared_by_prediction_and_no_more_than_needed_is_selected() -> None:
    runs = [measured(oscillator(), {"x": x0}, {"c": 0.05}, T, 0.02, seed) for seed, x0 in
        ((1, 1.0), (2, 0.6))]  # fmt: skip
    kept = {"t": T, **runs.pop()}
    data = {"t": T, **runs[0]}
    fits = {
        "friction": fit(oscillator(), data, ["k", "c"]),
        "none": fit(oscillator(), data, ["k"], params={"c": 1e-9}),
    }
    comparison = compare(fits, kept)
    assert comparison.selected.name == "friction"
    assert comparison.candidates[1].error > 1.5
    assert "residuals of x are correlated" in fits["none"].notes[0]


def test_runs_without_predicted_values_are_not_compared() -> None:
    """The second half of a run is predicted: it needs measured values, and the motion others."""
    data = measured(oscillator(), {"x": 1.0}, {}, T, 0.02)["x"]
    with np.errstate(invalid="ignore"):
        root = np.where(data > 0.3, np.sqrt(data), np.nan)
    fits = {"both": fit(oscillator(), {"t": T, "x": data, "sqrt(x)": root}, ["k"])}
    early = np.where(T[-1] / 2 > T, data, np.nan)
    with pytest.raises(ValueError, match=r"no measured values from t = 2\.975 s on"):
        compare(fits, {"t": T, "x": early, "sqrt(x)": np.nan * T})
    late = np.where(T[-1] / 2 > T, np.nan, 0.1)
    with pytest.raises(ArithmeticError, match=r"predicted motion has no value of sqrt\(x\) at t ="):
        compare(fits, {"t": T, "x": data, "sqrt(x)": late})


def test_formulas_without_values_are_named() -> None:
    """No swing of 1 m comes near the 5 m from which the root on is real."""
    data = measured(oscillator(), {"x": 1.0}, {}, T, 0.02)
    with pytest.raises(ArithmeticError, match=r"sqrt\(x - 5\), .* has no value at t = 0 s"):
        fit(oscillator(), {"t": T, "sqrt(x - 5)": data["x"]}, ["k"])


def test_combinations_that_cannot_be_known_are_named() -> None:
    data = {"t": T, **measured(oscillator(), {"x": 1.0}, {}, T, 0.02)}
    with pytest.raises(ValueError, match="m, k, c: only as c/m, k/m; give one of them a value"):
        fit(oscillator(), data, ["m", "k", "c"])
    assert fit(oscillator(), data).held == {"m": "only as c/m, k/m"}
    # with friction, a known c would determine m
    with pytest.raises(ValueError, match="m, k: only as k/m"):
        fit(oscillator(), data, ["m", "k"], params={"c": 0.0})


@pytest.mark.long("other tests reach its code")
def test_of_parameters_that_are_0_those_that_may_be_negative_are_fitted() -> None:
    x, F = sp.symbols("x F", real=True)
    k, c = sp.symbols("k c", positive=True)
    parameters = [Parameter(k, "N/m", 3.0, "stiffness"), Parameter(F, "N", 0.0, "force"),
        Parameter(c, "N s/m", 0.1, "friction")]  # fmt: skip
    pulled = build(
        System("pulled", "A pulled spring", [Coordinate(x, "m", "a length")], parameters,
            [PointMass(1, (x, 0))], potential=k * x**2 / 2 - F * x, gravity=(0, 0),
            dissipation=c * velocity(x) ** 2 / 2)
    )  # fmt: skip
    rest = -0.5 / 4  # where the spring of 4 N/m holds the force of -0.5 N
    data = {"t": T, "x": rest + (1 - rest) * np.cos(2 * T)}
    result = fit(pulled, data, params={"c": 0.0})
    assert [*result.intervals] == ["k", "F"]
    assert [result.params[name] for name in ("k", "F")] == pytest.approx([4, -0.5], abs=1e-6)


def test_the_first_guess_of_a_system_is_rest_where_lengths_are_not_0() -> None:
    _, start, params = _model(elastic)
    assert dict(zip(elastic.STATE, start, strict=True)) == {
        "r": 1.0,
        "theta": 0.0,
        "r_dot": 0.0,
        "theta_dot": 0.0,
    }
    assert params == dict(zip(elastic.PARAMETERS, elastic.DEFAULTS, strict=True))


def test_rest_determines_no_parameter() -> None:
    t = np.arange(0, 2, 0.1)
    with pytest.raises(ArithmeticError, match=r"do not determine theta at the start .*, l: hold"):
        fit(single, {"t": t, "theta": 0 * t}, ["l"])


def test_relaxed_gaps_close_from_nodes_that_are_far_away() -> None:
    """A node moves by p: 1 and 2 are measured, so that p is 1 and nothing remains."""

    def linearise(nodes: np.ndarray, params: np.ndarray) -> shooting_steps.LinearisedResiduals:
        (first,), (second,) = nodes
        by = np.array([[[1.0, 0.0]]] * 2)
        gaps = np.array([[first + params[0] - second], [0.0]])
        gaps_by = np.array([[[1.0, 1.0]], [[0.0, 0.0]]])
        residuals = nodes - [[1.0], [2.0]]
        return shooting_steps.LinearisedResiduals(np.zeros(2, int), residuals, by, gaps, gaps_by)

    start = np.array([[5.0], [-3.0]]), np.array([0.0])
    result = shooting_steps.relaxed(linearise, *start, np.array([False]), np.array([1.0]))
    assert result.squares < 1e-9
    assert result.params == pytest.approx([1.0], abs=1e-4)


def test_a_step_beyond_which_no_motion_exists_is_tried_at_a_quarter() -> None:
    """Of ln p = 0 Newton's step leads from p to p - p ln p, below 0 from p = 8."""
    trials = []

    def linearise(nodes: np.ndarray, params: np.ndarray) -> shooting_steps.LinearisedResiduals:
        trials.append(params[0])
        if params[0] <= 0:
            raise NoResidualsError("there is no logarithm")
        residuals = np.array([[nodes[0, 0], np.log(params[0])]])
        by = np.array([[[1.0, 0.0], [0.0, 1 / params[0]]]])
        ends = np.zeros((1, 1)), np.zeros((1, 1, 2))
        return shooting_steps.LinearisedResiduals(np.zeros(1, int), residuals, by, *ends)

    start = np.array([[0.5]]), np.array([8.0])
    result = shooting_steps.minimise(linearise, *start, np.array([False]), np.array([1.0]))
    assert result.params == pytest.approx([1.0], abs=1e-6)
    step = -8 * np.log(8)
    assert trials[:3] == pytest.approx([8.0, 8.0 + step, 8.0 + step / 4])


def test_leverages_add_up_to_the_rank_that_exceeds_rounding() -> None:
    """The second column is three times the first one: the rank is 1."""
    column = np.random.default_rng(0).normal(size=50)
    jacobian = np.column_stack([column, 3 * column])
    triangle = np.linalg.qr(jacobian, mode="r")
    assert triangle[1, 1] != 0
    assert leverages(jacobian, triangle).sum() == pytest.approx(1.0)


BETTER = (
    "best, with 3 unknown parameters, predicts best; simpler models predict significantly worse"
)


@pytest.mark.parametrize(("close", "selected", "reason"), [
    (0.02, "close", "close, with 2 unknown parameters, predicts as well as best, within the error"),
    (0.16, "best", BETTER), (0.4, "best", BETTER),
])  # fmt: skip
def test_the_simplest_model_that_predicts_within_two_standard_errors_is_selected(
    close: float, selected: str, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng, t = np.random.default_rng(9), np.arange(400.0)
    left = rng.normal(size=(1, 400))
    run: Any = SimpleNamespace(t=t)
    rest = {"best": left, "close": left + close * rng.normal(size=(1, 400)), "wide": 3 * left}
    fits: Any = {
        name: SimpleNamespace(unknown=("m", "l", "g")[:count], name=name,
            estimate=SimpleNamespace(noise=np.array([noise])))
        for name, count, noise in (("best", 3, 0.5), ("close", 2, 0.7), ("wide", 1, 0.9))
    }  # fmt: skip
    monkeypatch.setattr(prediction, "predicted", lambda fit, run, begin: prediction.Prediction(
        run, begin, 0 * left, rest[fit.name]))  # fmt: skip
    found = prediction.compared(fits, [(run, 100.0)])
    # squares of what is predicted, in units of the least noise, and SciPy's error of block means
    squares = {name: (values[0, 100:] / 0.5) ** 2 for name, values in rest.items()}
    for one in found.candidates:
        excess = squares[one.name] - squares["best"]
        means = [block.mean() for block in np.array_split(excess, prediction.BLOCKS)]
        assert one.error == pytest.approx(np.sqrt(squares[one.name].mean()))
        assert one.excess == pytest.approx(excess.mean(), abs=1e-12)
        assert one.excess_error == pytest.approx(sem(means), abs=1e-12)
        assert one.name != "close" or (one.excess < 2 * sem(means)) == (selected == "close")
    assert found.selected.name == selected
    assert found.reason == reason
    alone = prediction.compared({"best": fits["best"]}, [(run, 100.0)])
    assert alone.reason == "best, with 3 unknown parameters, predicts best"


def test_first_guesses_are_those_of_parabolas_through_seven_samples() -> None:
    t = np.linspace(0.0, 3.0, 31)
    values, slopes = _parabolas(t, t**3, np.array([0.0, 1.52, 3.0]))
    for k, (first, begin) in enumerate(((0, 0.0), (12, 1.52), (24, 3.0))):
        near = t[first : first + 7] - begin
        quadratic = np.polyfit(near, (near + begin) ** 3, 2)  # by another program
        assert (values[k], slopes[k]) == pytest.approx((quadratic[2], quadratic[1]), rel=1e-9)
        assert abs(slopes[k] - 3 * begin**2) > 1e-3  # which is no cubic


def test_noise_is_independent_along_each_output() -> None:
    noise = np.random.default_rng(3).choice([-1.0, 1.0], size=(1, 2, 400))
    drift = noise.copy()
    drift[0, 1] = np.sign(np.sin(np.arange(400) / 20))  # equal neighbours, in one output
    experiment: Any = SimpleNamespace(masks=np.ones((1, 2, 400)), counts=np.array([400, 400]))
    for residuals, expected in ((noise, True), (drift, False)):
        linear: Any = SimpleNamespace(residuals=residuals.reshape(1, 800), squares=800.0)
        assert _is_noise(experiment, linear) == expected


def test_gaps_are_measured_in_the_scales_of_the_states() -> None:
    linear: Any = SimpleNamespace(gaps=np.array([[2.0, -6.0], [0.0, 3.0]]))
    assert shooting_steps._gaps(linear, np.array([2.0, 3.0])) == pytest.approx(1 + 2 + 1)
