"""Fits of motions that measured inputs drive, against exact solutions and predictions."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy.optimize import least_squares
from scipy.signal import cont2discrete

import generated.two_link_arm as arm
from derive import Coordinate, Input, Parameter, PointMass, System, velocity
from solvers import Held, Measurement, build, compare, fit, integrate
from solvers.app.cli import main
from solvers.equations.module import GeneratedModule
from solvers.integration.problem.status import Status
from solvers.scenes.fitting.measurement import Interpolation, check_inputs
from solvers.scenes.fitting.multiple_shooting import (
    MultipleShooting,
    NoResidualsError,
    failure,
    segments,
)

UNKNOWN = ("m", "k", "c")
T = np.linspace(0, 8, 161)
FORCE = 2 * np.sin(1.7 * T) + np.sin(4.1 * T) - 0.5
DISCRETE = {"held": "zoh", "linear": "foh"}


@cache
def cart() -> GeneratedModule:
    """A cart on a spring, with friction and a force."""
    x, F = sp.symbols("x F", real=True)
    m, k, c = sp.symbols("m k c", positive=True)
    values = [(m, "kg", 1.0), (k, "N/m", 4.0), (c, "N s/m", 0.3)]
    return build(
        System("sprung", "A cart on a spring", [Coordinate(x, "m", "position")],
            [Parameter(symbol, unit, value, "") for symbol, unit, value in values],
            [PointMass(m, (x, 0))], potential=k * x**2 / 2, gravity=(0, 0),
            dissipation=c * velocity(x) ** 2 / 2, forces=[F],
            inputs=[Input(F, "N", "force")])
    )  # fmt: skip


def exact(params: Any, start: Any, kind: Interpolation, force: Any = FORCE, t: Any = T) -> Any:
    """Positions by the matrix exponential, for forces that are held or linear between times."""
    m, k, c = params
    A, B, h = np.array([[0, 1], [-k / m, -c / m]]), np.array([[0], [1 / m]]), t[1] - t[0]
    # the discrete system for linear inputs has another state, which its output leads back to
    Ad, Bd, C, D, _ = cont2discrete((A, B, np.eye(2), np.zeros((2, 1))), h, DISCRETE[kind])
    states = np.empty((2, len(t)))
    z = np.array(start) - (D * force[0]).ravel()
    for n, u in enumerate(force):
        states[:, n] = C @ z + (D * u).ravel()
        z = Ad @ z + (Bd * u).ravel()
    return states[0]


def noisy(values: Any, seed: int = 0) -> Any:
    return values + 0.01 * np.random.default_rng(seed).normal(size=len(values))


def reference(x: Any, kind: Interpolation) -> tuple[Any, Any]:
    """Values and standard errors by SciPy, from the exact solution."""
    result = least_squares(
        lambda unknown: exact(unknown[:3], unknown[3:], kind) - x, (1, 4, 0.3, x[0], 0),
        x_scale="jac", xtol=1e-15, ftol=1e-15, gtol=1e-15,
    )  # fmt: skip
    variance = 2 * result.cost / (len(x) - 5)
    return result.x[:3], np.sqrt(variance * np.diag(np.linalg.inv(result.jac.T @ result.jac)))[:3]


TRUTH, START = (1.3, 5.0, 0.2), (0.4, 0.0)


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize(("kind", "share"), [("held", 1e-3), ("linear", 0.3)])
def test_values_are_those_of_the_exact_solution(kind: Interpolation, share: float) -> None:
    # the mean of linear inputs acts from each time to the next one: an error of second order
    x = noisy(exact(TRUTH, START, kind))
    result = fit(cart(), {"t": T, "x": x, "F": FORCE}, inputs=kind)
    assert result.unknown == UNKNOWN
    values, errors = reference(x, kind)
    own = np.array([result.params[name] for name in UNKNOWN])
    assert (abs(own - values) < share * errors).all()
    assert result.errors == pytest.approx(errors, rel=0.02)
    assert (abs(own - TRUTH) < 4 * errors).all()


def test_the_error_of_linear_inputs_is_of_second_order() -> None:
    errors = []
    for every in (4, 2, 1):
        t, force = T[::every], FORCE[::every]
        x = exact(TRUTH, START, "linear", force, t)
        result = fit(cart(), {"t": t, "x": x, "F": force})
        errors.append(abs(result.params["m"] - TRUTH[0]))
    assert 3 < errors[0] / errors[1] < 5
    assert 3 < errors[1] / errors[2] < 5


def test_inputs_that_act_otherwise_than_stated_give_other_values() -> None:
    for kind, other in (("held", "linear"), ("linear", "held")):
        data = {"t": T, "x": exact(TRUTH, START, kind), "F": FORCE}
        right, wrong = (
            abs(fit(cart(), data, inputs=one).params["c"] - TRUTH[2]) for one in (kind, other)
        )
        assert right < wrong / 50


def test_gaps_of_inputs_are_filled_and_units_converted() -> None:
    t, coarse = np.linspace(0, 8, 321), np.full(321, np.nan)
    coarse[::2] = FORCE
    x = np.full(321, np.nan)
    x[::2] = noisy(exact(TRUTH, START, "held"))
    values = {"x": x[::2], "F": FORCE}
    for kind in ("held", "linear"):
        dense = fit(cart(), {"t": t, "x": x, "F [kN]": coarse / 1000}, inputs=kind)
        other = fit(cart(), {"t": T, **values}, inputs=kind)
        share = {"held": 1e-6, "linear": 0.3}[kind]
        assert dense.params["m"] == pytest.approx(other.params["m"], abs=share * other.errors[0])


@pytest.mark.long("other tests reach its code")
def test_only_a_measured_force_determines_the_mass() -> None:
    x = noisy(exact(TRUTH, START, "held", 0 * FORCE))
    free = fit(cart(), {"t": T, "x": x})
    assert {*free.held} == {"m"} or {*free.held} == {"k"} or {*free.held} == {"c"}
    with pytest.raises(ValueError, match="only as"):
        fit(cart(), {"t": T, "x": x}, UNKNOWN)


def test_compiled_and_python_loops_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    run = Measurement(T, {"x": FORCE}, inputs={"F": FORCE})
    parts = segments(0, T, [0, 40, 90], run.held(cart(), np.array([*TRUTH, 0.0])))
    shooting = MultipleShooting(cart(), [0, 2], parts)
    nodes, params = np.array([[0.4, 0.0], [0.1, -0.3], [0.2, 0.5]]), np.array([*TRUTH, 0.0])
    compiled = shooting(nodes, params)
    other = MultipleShooting(cart(), [0, 2], parts)
    monkeypatch.setattr(other, "_program", None)
    slow = other(nodes, params)
    for name in ("y", "by", "ends", "ends_by"):
        np.testing.assert_allclose(getattr(compiled, name), getattr(slow, name), atol=1e-8)
    # no input of another segment acts at the end of one
    expected = exact(TRUTH, nodes[1], "held", FORCE[40:91], T[40:91])
    np.testing.assert_allclose(compiled.y[1, 0, :50], expected[:50], atol=1e-8)
    assert compiled.ends[1, 0] == pytest.approx(expected[50], abs=1e-8)


def test_motions_in_python_that_fail_have_no_residuals(monkeypatch: pytest.MonkeyPatch) -> None:
    t, params = T[40:60], np.array([0.0, *TRUTH[1:], 0.0])  # without a mass
    run = Measurement(t, {"x": t}, inputs={"F": t})
    shooting = MultipleShooting(cart(), [0], segments(0, t, [0], run.held(cart(), params)))
    monkeypatch.setattr(shooting, "_program", None)
    with pytest.raises(NoResidualsError, match=r"the motion ends at t = 2 s, since .* not finite"):
        shooting(np.array([[0.4, 0.0]]), params)


@pytest.mark.parametrize(("status", "reason"), [
    (None, "interrupted"), (Status.STEP_LIMIT, "number of steps"),
])  # fmt: skip
def test_a_motion_without_residuals_states_why_it_ends(status: Status | None, reason: str) -> None:
    text = str(failure(status, 2.5))
    assert text.startswith("the motion ends at t = 2.5 s, since ")
    assert reason in text


def test_the_inputs_of_a_single_sample_act_at_its_time() -> None:
    *_, last = segments(0, np.array([0.0, 1.0, 2.0]), [0, 2], np.array([[5.0, 6.0, 7.0]]))
    assert (last.begin, last.end) == (2.0, 2.0)
    assert last.changes.tolist() == [2.0]
    assert last.inputs.tolist() == [[7.0]]


PARAMETERS = {"m1": 2.2, "m2": 1.2, "I1": 0.05}


def arm_run(seed: int, name: str) -> Measurement:
    """A run of the arm with motors that follow a path, with the torques as held."""
    rng, t = np.random.default_rng(seed), np.linspace(0, 4, 401)
    a, b, c, d = rng.uniform(1, 3, 4)

    def torques(time: float, y: Any) -> tuple[float, float]:
        first, second = -1 + 0.8 * np.sin(a * time), 0.5 + 0.9 * np.sin(b * time)
        one = 60 * (first - y[0]) - 6 * y[2] + 8 + 3 * np.sin(5 * c * time)
        return one, 15 * (second - y[1]) - 1.5 * y[3] + np.cos(5 * d * time)

    motion = integrate(
        arm, (0, 4), {"q1": -1.0, "q2": 0.4}, PARAMETERS, inputs=Held(0.01, torques), t_eval=t
    )
    noise = 0.002 * rng.normal(size=(2, len(t)))
    values = dict(zip(("q1", "q2"), motion.y[:2] + noise, strict=True))
    return Measurement(t, values | dict(zip(arm.INPUTS, motion.inputs, strict=True)), name)


@pytest.mark.long("other tests reach its code")
def test_a_run_that_was_kept_back_is_predicted() -> None:
    runs = [arm_run(0, "first"), arm_run(1, "second")]
    result = fit(arm, runs, [*PARAMETERS], inputs="held")
    for name, value in PARAMETERS.items():
        assert abs(result.params[name] - value) < 4 * result.intervals[name].error
    wrong = fit(arm, runs, ["m1", "m2"], inputs="held")
    comparison = compare({"all": result, "I1 known": wrong}, arm_run(2, "third"), inputs="held")
    assert comparison.selected.name == "all"
    assert comparison.selected.error == pytest.approx(1, abs=0.1)
    assert comparison.candidates[1].error > 2


Columns = Mapping[str, Any]


@pytest.mark.parametrize(("data", "message"), [
    ([{"F": FORCE}, {}], "has no column of the input F, which measurement has: give it"),
    ([{"F": np.full(len(T), np.nan)}], "the input F has no value at any time"),
    ([{"f": FORCE}], r"column 'f' names no quantity of the system \(did you mean 'F'\?\)"),
    ([{"F [N m]": FORCE}], "the unit N m is not one of N"),
    ([{"F": FORCE, "x*F": FORCE}], "contains the input F, which changes"),
])  # fmt: skip
def test_columns_that_are_missing_or_unknown_are_named(data: list[Columns], message: str) -> None:
    x = exact(TRUTH, START, "held")
    with pytest.raises(ValueError, match=message):
        fit(cart(), [{"t": T, "x": x} | columns for columns in data], inputs="held")


def test_inputs_between_values_are_their_means_and_the_last_one_holds() -> None:
    t, gap = np.array([0.0, 1.0, 2.0, 4.0]), np.nan
    run = Measurement(t, {"x": t, "F": np.array([1.0, 3.0, gap, 9.0])})
    assert run.with_inputs(["F"], "linear").inputs["F"].tolist() == [2.0, 4.0, 7.0, 9.0]
    assert run.with_inputs(["F"], "held").inputs["F"].tolist() == [1.0, 3.0, 3.0, 9.0]


@pytest.mark.parametrize("order", [(0, 1), (1, 0), (0, 1, 1), (1, 1, 0)])
def test_the_run_without_an_input_is_named_whatever_the_order(order: tuple[int, ...]) -> None:
    runs = Measurement(T, {"x": T}, "one"), Measurement(T, {"x": T}, "other", {"F": FORCE})
    with pytest.raises(ValueError, match=r"^one has no column of the input F, which other has"):
        check_inputs([runs[k] for k in order])


def test_a_prediction_needs_the_inputs_of_the_fit() -> None:
    x = noisy(exact(TRUTH, START, "held"))
    result = fit(cart(), {"t": T, "x": x, "F": FORCE}, inputs="held")
    with pytest.raises(ValueError, match="has no column of the input F"):
        compare({"all": result}, {"t": T, "x": x})


def test_inputs_that_the_system_does_not_have_are_refused() -> None:
    run = Measurement(T, {"x": FORCE}, inputs={"G": FORCE})
    with pytest.raises(ValueError, match="measurement: sprung has no input 'G'; known are F"):
        fit(cart(), run)


def test_other_kinds_of_inputs_are_refused() -> None:
    with pytest.raises(ValueError, match="inputs = 'hold': give one of held, linear"):
        fit(cart(), {"t": T, "x": FORCE, "F": FORCE}, inputs="hold")


def test_held_inputs_begin_at_the_first_time() -> None:
    force = FORCE.copy()
    force[0] = np.nan
    with pytest.raises(ValueError, match="no value at the first time, t = 0 s"):
        fit(cart(), {"t": T, "x": FORCE, "F": force}, inputs="held")


def test_columns_of_prescribed_motions_are_refused() -> None:
    x, s = sp.symbols("x s", real=True)
    m, k = sp.symbols("m k", positive=True)
    module = build(
        System("pulled", "A mass on a moved spring", [Coordinate(x, "m", "position")],
            [Parameter(m, "kg", 1.0, ""), Parameter(k, "N/m", 4.0, "")], [PointMass(m, (x + s, 0))],
            potential=k * x**2 / 2, gravity=(0, 0), inputs=[Input(s, "m", "end", motion=True)])
    )  # fmt: skip
    with pytest.raises(ValueError, match="column s is of a prescribed motion"):
        fit(module, {"t": T, "x": FORCE, "s": FORCE})


def test_the_command_predicts_a_run_with_torques(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for seed, name in enumerate(("first", "second")):
        run = arm_run(seed, name)
        rows = np.column_stack([run.t, *run.values.values()])
        heads = "t,q1,q2,tau1 [N m],tau2 [N m]"
        np.savetxt(f"{name}.csv", rows, delimiter=",", header=heads, comments="", fmt="%.9g")
    unknown = ",".join(PARAMETERS)
    arguments = ["fit", "two_link_arm", "first.csv", "--unknown", unknown, "--inputs", "held"]
    assert main([*arguments, "--test", "second.csv"]) == 0
    text = capsys.readouterr().out
    assert "802 values of q1, q2 in 1 run, 3 unknown parameters\ninputs: tau1, tau2" in text
    error = text.split("error of prediction / noise")[1].split("two_link_arm")[1].split()[1]
    assert float(error) == pytest.approx(1, abs=0.1)
    scene = Path("out/two_link_arm_fit.toml").read_text()
    assert "# without tau1, tau2, which the data have over time" in scene
