"""Inputs during an integration: constant, held between samples, or functions of the state."""

import re
import runpy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cart_pole import cart_pole
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from derive import with_inputs
from solvers import Event, Held, build, ensemble, integrate, prepare
from solvers.equations.forms import Form
from solvers.integration.checks import accuracy_warnings
from solvers.integration.compiled.kernel import Batch
from solvers.integration.loops import compiled_loop
from solvers.integration.problem import validation
from solvers.integration.problem.problem import Options, shortest_step
from solvers.integration.problem.status import Status
from solvers.integration.results.solution import Interrupted

Array = np.ndarray[Any, np.dtype[np.float64]]

cart = build(cart_pole)
START = (0.0, 0.1, 0.0, 0.0)
#: Not equidistant; the last sample is after the end.
TIMES = (0.0, 0.3, 0.35, 0.9, 2.0)
TABLE = np.array([[1.0, -2.0, 3.0, 0.0, 9.0], [0.1, 0.2, -0.3, 0.0, 9.0]])
#: Gains that stabilise the upright pole.
GAINS = np.array([-1.0, -25.0, -2.0, -4.0])


def feedback(t: float, y: Array) -> dict[str, Any]:
    return {"F": -GAINS @ y}


def piecewise(times: Any, table: Array, end: float, y: Any = START) -> Array:
    """Piece by piece by SciPy."""
    ends = [t for t in times[1:] if t < end] + [end]
    for begin, until, u in zip(times, ends, table.T, strict=False):
        options = {"rtol": 1e-13, "atol": 1e-14, "args": ((*cart.DEFAULTS[:-2], *u),)}
        y = solve_ivp(cart.rhs, (begin, until), y, method="DOP853", **options).y[:, -1]
    return np.array(y)


@pytest.mark.long("more cases of the same kind", keep=3, daily=9)
@pytest.mark.parametrize(
    ("method", "form", "options"),
    [
        ("verner853", "lagrangian", {}),
        ("verner853", "rational", {}),
        ("verner853", "hamiltonian", {}),
        ("dp54", "rational", {}),  # its first stage is the last one of the step before
        ("dp54", "rational", {"h": 0.002}),
        ("gauss8", "rational", {}),
        ("radau5", "lagrangian", {}),
        ("verner853", "lagrangian", {"h": 0.004}),  # which divides no piece
        ("DOP853", "lagrangian", {}),
    ],
)
@pytest.mark.parametrize("backend", ["compiled", "python"])
def test_held_inputs_cost_no_accuracy(
    method: str, form: str, options: dict[str, Any], backend: str
) -> None:
    options = options or {"rtol": 1e-10, "atol": 1e-12}
    chosen: dict[str, Any] = {"method": method, "form": form, **options}
    chosen["backend"] = None if method == "DOP853" else backend
    held = Held(TIMES, TABLE)
    motion = integrate(cart, (0, 1.5), START, {}, inputs=held, **chosen)
    assert motion.status is Status.FINISHED
    assert {*TIMES[:-1]} <= {*motion.t.tolist()}
    assert (np.diff(motion.t) > 0).all()
    expected = piecewise(TIMES, TABLE, 1.5)
    assert_allclose(motion.y[:, -1], expected, atol=2e-9)
    samples = np.array([0.0, 0.2, 0.3, 0.6, 1.5])
    sampled = integrate(cart, (0, 1.5), START, {}, inputs=held, t_eval=samples, **chosen)
    assert_allclose(sampled.y[:, 2], piecewise(TIMES, TABLE, 0.3), atol=2e-9)
    assert_allclose(sampled.y[:, 3], piecewise(TIMES, TABLE, 0.6), atol=2e-9)
    assert sampled.inputs is not None
    assert sampled.inputs[0].tolist() == [1.0, 1.0, -2.0, 3.0, 0.0]
    late = np.roll(TABLE, 1, axis=1)
    assert np.abs(piecewise(TIMES, late, 1.5) - expected).max() > 0.1


def test_loops_agree_step_by_step() -> None:
    runs = [
        integrate(cart, (0, 2), START, {}, inputs=Held(0.02, feedback), backend=backend)
        for backend in ("compiled", "python")
    ]
    assert runs[0].steps == runs[1].steps
    assert_allclose(runs[0].y[:, -1], runs[1].y[:, -1], atol=1e-13)


def test_a_controller_is_called_at_every_sample() -> None:
    calls = []

    def controller(t: float, y: Array) -> tuple[float, float]:
        calls.append(t)
        y[:] = 7.0  # the state is a copy
        return -2 * t, 0.1

    held = Held(0.1, controller)
    motion = integrate(cart, (1, 2), START, {}, inputs=held)
    assert_allclose(calls, 1 + 0.1 * np.arange(10))
    run, y = prepare(cart, {}), START
    for t in 1 + 0.1 * np.arange(10):
        y = run((t, min(t + 0.1, 2.0)), y, None, (-2 * t, 0.1))
    assert_allclose(motion.y[:, -1], y, atol=1e-8)
    assert motion.inputs is not None
    assert_allclose(motion.inputs[0, [0, -1]], [-2.0, -3.8])


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("method", ["verner853", "radau5", "LSODA"])
def test_functions_of_the_state_agree_with_formulas(method: str) -> None:
    formula = " + ".join(f"{-k}*{name}" for k, name in zip(GAINS.tolist(), cart.STATE, strict=True))
    compiled = build(with_inputs(cart_pole, {"F": f"{formula} + sin(t)", "T": 0}))
    expected = solve_ivp(
        compiled.rhs, (0, 3), START, rtol=1e-12, atol=1e-13, args=(compiled.DEFAULTS,)
    ).y[:, -1]
    motion = integrate(compiled, (0, 3), START, {}, method=method)
    assert_allclose(motion.y[:, -1], expected, atol=1e-7)

    def inputs(t: float, y: Array) -> dict[str, float]:
        return {"F": float(np.sin(t) - GAINS @ y)}

    motion = integrate(cart, (0, 3), START, {}, inputs=inputs, method=method)
    assert motion.backend == ("scipy" if method == "LSODA" else "python")
    assert_allclose(motion.y[:, -1], expected, atol=1e-7)
    assert motion.inputs is not None
    assert_allclose(motion.inputs[0], np.sin(motion.t) - GAINS @ motion.y, atol=1e-12)
    with pytest.raises(ValueError, match=r"inputs is a Python function; .*Held.*with_inputs"):
        integrate(cart, (0, 3), START, {}, inputs=inputs, backend="compiled")
    with pytest.raises(ValueError, match="which form 'rational' cannot call"):
        integrate(cart, (0, 3), START, {}, inputs=inputs, form="rational")


def test_the_jacobian_includes_the_feedback() -> None:
    form = Form(cart, "lagrangian", cart.DEFAULTS, lambda t, y: np.array([-GAINS @ y, y[1] ** 2]))
    y = np.array([0.3, -0.2, 0.5, 0.7])
    changes = 1e-6 * np.eye(4)
    columns = [(form.rhs(0.0, y + dy) - form.rhs(0.0, y - dy)) / 2e-6 for dy in changes]
    assert_allclose(form.jacobian(0.0, y), np.transpose(columns), atol=1e-7)


def test_long_tables_are_held_without_pause_or_with() -> None:
    table = np.sin(np.arange(10_000))  # more samples than rows that C stores at once
    held = Held(1e-4, {"F": table})
    motion = integrate(cart, (0, 1), START, {}, inputs=held)
    assert len(motion.t) == 10_001
    assert motion.inputs is not None
    assert_allclose(motion.inputs[0, :-1], table)
    last = integrate(cart, (0, 1), START, {}, inputs=held, t_eval=[1.0])
    assert motion.y[:, -1].tolist() == last.y[:, -1].tolist()
    called = Held(1e-4, lambda t, y: {"F": table[round(t / 1e-4)]})
    end = integrate(cart, (0, 0.01), START, {}, inputs=called).y[:, -1]
    assert end.tolist() == integrate(cart, (0, 0.01), START, {}, inputs=held).y[:, -1].tolist()


def test_nothing_is_predicted_with_inputs_that_vary(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> float:
        raise AssertionError("the variational equations have constant inputs")

    monkeypatch.setattr(accuracy_warnings, "predictable_until", refuse)
    for inputs in (Held(0.1, feedback), lambda t, y: feedback(t, y)):
        assert integrate(cart, (0, 1), START, {}, inputs=inputs).success
    starts = np.array([START, START]).T
    assert ensemble(cart, (0, 1), starts, {}, inputs=Held(0.1, feedback)).success.all()
    with pytest.raises(AssertionError, match="constant inputs"):
        integrate(cart, (0, 1), START, {})


def test_constant_inputs_are_parameters() -> None:
    ends = [
        integrate(cart, (0, 1), START, {"F": 2.0, "m": 0.1}).y[:, -1],
        integrate(cart, (0, 1), START, cart.params(F=2.0, m=0.1)).y[:, -1],
        integrate(cart, (0, 1), START, {"m": 0.1}, inputs={"F": 2.0}).y[:, -1],
        integrate(cart, (0, 1), START, {"m": 0.1, "T": 5.0}, inputs=(2.0, 0.0)).y[:, -1],
    ]
    assert np.ptp(ends, axis=0).max() == 0
    assert np.abs(ends[0] - integrate(cart, (0, 1), START, {"m": 0.1}).y[:, -1]).max() > 0.1


def test_the_energy_changes_by_the_work_of_held_forces() -> None:
    params = {"b": 0.0}
    held = Held(TIMES, TABLE * [[1.0], [0.0]])
    motion = integrate(cart, (0, 1.5), START, params, inputs=held, energy=True)
    assert motion.energy is not None
    assert motion.inputs is not None
    work = np.sum(motion.inputs[0, :-1] * np.diff(motion.y[0]))
    assert motion.energy[-1] - motion.energy[0] == pytest.approx(work, rel=1e-8)
    assert abs(work) > 0.1


def test_prepared_functions_take_inputs_call_by_call() -> None:
    run = prepare(cart, {"F": 1.0})
    span, end = (0.0, 0.5), integrate(cart, (0, 0.5), START, {"F": 1.0}).y[:, -1]
    other = integrate(cart, (0, 0.5), START, {"F": -2.0, "T": 0.1}).y[:, -1]
    for inputs in ((-2.0, 0.1), {"F": -2.0, "T": 0.1}, np.array([-2.0, 0.1])):
        assert_allclose(run(span, START, None, inputs), other, atol=1e-8)
        assert_allclose(run(span, START), end, atol=1e-8)
    with pytest.raises(ValueError, match="inputs has shape"):
        run(span, START, None, (1.0,))
    with pytest.raises(ValueError, match="nan"):
        run(span, START, None, (1.0, np.nan))
    assert_allclose(run(span, START), end, atol=1e-8)


@pytest.mark.parametrize("backend", ["compiled", "python"])
def test_ensembles_take_held_inputs(backend: str) -> None:
    starts = np.array([START, (0, -0.2, 0, 0), (0.1, 0.05, 0, 3.0)]).T
    held, times = Held(0.05, feedback), [0.0, 0.35, 1.0]
    event = Event(cart, "theta", -0.1, terminal=True, direction=-1)  # in the third motion
    options: dict[str, Any] = {"t_eval": times, "inputs": held, "backend": backend}
    for table in (held, Held(TIMES, TABLE)):
        motions = ensemble(cart, (0, 1), starts, {}, inputs=table, backend=backend)
        for k, start in enumerate(starts.T):
            alone = integrate(cart, (0, 1), start, {}, inputs=table)
            assert_allclose(motions.y[:, k], alone.y[:, -1], atol=1e-7)
    motions = ensemble(cart, (0, 1), starts, {}, events=event, **options)
    assert motions.status.tolist() == [Status.FINISHED, Status.FINISHED, Status.EVENT]
    for k, start in enumerate(starts.T):
        motion = integrate(cart, (0, 1), start, {}, events=event, **options)
        assert_allclose(motions.y[:, k], motion.end[1], atol=1e-8)
        count = len(motion.t)
        assert_allclose(motions.samples[:, k, :count], motion.y, atol=1e-8)
    forced = ensemble(cart, (0, 1), starts, {}, inputs={"F": 2.0}, backend=backend)
    alone = integrate(cart, (0, 1), START, {"F": 2.0})
    assert_allclose(forced.y[:, 0], alone.y[:, -1], atol=1e-7)


@pytest.mark.parametrize("backend", ["compiled", "python"])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_events_and_limits_of_steps_work_across_samples(backend: str) -> None:
    event = Event(cart, "x", 0.05)
    options: dict[str, Any] = {"inputs": Held(0.05, feedback), "backend": backend}
    motion = integrate(cart, (0, 3), START, {}, events=event, **options)
    dense = integrate(cart, (0, 3), START, {}, t_eval=np.linspace(0, 3, 3001), **options)
    signs = np.diff(np.sign(dense.y[0] - 0.05)) != 0
    assert len(motion.t_events[0]) == signs.sum() > 0
    assert_allclose(motion.t_events[0], dense.t[:-1][signs], atol=2e-3)
    short = integrate(cart, (0, 3), START, {}, max_steps=5, **options)
    assert short.status is Status.STEP_LIMIT
    assert short.steps == 5


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({"G": 1.0}, r"inputs has no 'G'.* known names: F, T"),
        ((1.0,), r"inputs has shape \(1,\): give \(2,\), .* F, T"),
        ({"F": np.inf}, r"F = inf must be a finite real number in N"),
        ("F", "inputs"),
        (lambda: Held(0.0, feedback), "times = 0.0 must be positive"),
        (lambda: Held([0, 2, 1], TABLE), "must be a period or increase"),
        (lambda: Held([0.5, 1], TABLE[:, :2]), "first of times, 0.5, is after the start"),
        (lambda: Held([0, 1], TABLE), r"values has shape \(2, 5\): give \(2, 2\)"),
        (lambda: Held(0.1, TABLE), r"values has shape \(2, 5\): give \(2, 10\)"),
        (lambda: Held(0.1, lambda t, y: {"F": np.nan}), r"F = nan must be"),
        (lambda: Held(0.1, lambda t, y: [1.0]), r"inputs at t = 0.0 has shape \(1,\)"),
        (lambda: Held(1e-9, feedback), "more than 10000000 samples"),
        (lambda: lambda t, y: {"F": np.nan}, r"F = nan must be"),
        (lambda: lambda t, y: (10**400, 1.0), r"F = 10+ must be .* below 1.8e308"),
        (lambda: lambda t, y: [True, 1.0], r"F = True must be"),
        (lambda: lambda t, y: np.array([1.0]), r"inputs at t = 0.0 has shape \(1,\)"),
    ],
)
def test_invalid_inputs_are_refused(inputs: Any, message: str) -> None:
    def run() -> None:
        integrate(cart, (0, 1), START, {}, inputs=inputs() if callable(inputs) else inputs)

    with pytest.raises(ValueError, match=message):
        run()


@pytest.mark.parametrize("method", ["verner853", "gauss8", "LSODA"])
@pytest.mark.parametrize("period", [None, 0.02])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_inputs_that_become_nan_end_the_run_with_the_results_so_far(
    period: float | None, method: str
) -> None:
    def controller(t: float, y: Array) -> dict[str, float]:
        return {"F": np.nan if t > 0.5 else 1.0}

    inputs = Held(period, controller) if period else controller
    run = integrate(cart, (0, 1), START, {}, inputs=inputs, method=method)
    assert run.status is Status.NOT_FINITE
    assert 0.4 < run.end[0] == run.t[-1] <= 0.52
    assert run.inputs is not None
    assert (run.inputs[0, :-1] == 1.0).all()
    assert re.search(r": F = nan must be .*\(t = .*, x = ", run.message)


@pytest.mark.parametrize("backend", ["compiled", "python"])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_inputs_that_become_nan_end_the_motions_of_their_columns(backend: str) -> None:
    def controller(t: float, y: Array) -> dict[str, Any]:
        return {"F": np.where((t > 0.5) & (y[0] > 0.0), np.nan, 1.0)}

    starts = np.array([START, (-5.0, *START[1:])]).T
    motions = ensemble(cart, (0, 1), starts, {}, inputs=Held(0.02, controller), backend=backend)
    assert motions.status.tolist() == [Status.NOT_FINITE, Status.FINISHED]
    assert motions.t == pytest.approx([0.52, 1.0])


@pytest.mark.parametrize(("backend", "count"), [("python", 1), ("compiled", 0)])
def test_a_run_that_is_interrupted_at_its_first_sample_has_no_inputs(
    backend: str, count: int
) -> None:
    def controller(t: float, y: Array) -> dict[str, float]:
        raise KeyboardInterrupt

    with pytest.raises(Interrupted) as stopped:
        integrate(cart, (0, 1), START, {}, inputs=Held(0.1, controller), backend=backend)
    solution = stopped.value.solution
    assert solution.status is Status.INTERRUPTED
    assert solution.t.shape == (count,)
    assert solution.inputs is not None
    assert solution.inputs.shape == (2, count)
    assert np.isnan(solution.inputs).all()


def test_inputs_need_a_system_that_has_them() -> None:
    import generated.single_pendulum as sp

    for inputs in ({"F": 1.0}, (), lambda t, y: 0.0, Held(0.1, lambda t, y: 0.0)):
        with pytest.raises(ValueError, match=r"single_pendulum has no inputs.*inputs=\[Input"):
            integrate(sp, (0, 1), (0.1, 0.0), {}, inputs=inputs)
    with pytest.raises(ValueError, match="runs backwards"):
        integrate(cart, (1, 0), START, {}, inputs=Held(0.1, feedback))
    assert integrate(sp, (0, 1), (0.1, 0.0), {}).inputs is None


def test_a_run_that_resumes_has_the_shortest_step_of_its_times() -> None:
    # a step that times do not resolve ends a motion, such as one at a singularity
    problem = validation.problem_at_rest(cart, (0.0, 1.0), Options(), {})
    problem, program = compiled_loop.select(problem, lanes=False)
    assert program
    batch = Batch(program, problem)
    batch.run()
    assert batch.motions["min_h"][0] == shortest_step(0.0, 1.0)
    batch.resume(replace(problem, span=(1.0, 1e6)))
    assert batch.motions["min_h"][0] == shortest_step(1.0, 1e6)
    assert shortest_step(0.0, -1e6) == shortest_step(-1e6, 0.0) == shortest_step(0.0, 1e6)


@pytest.mark.long("other tests reach its code")
def test_errors_of_computed_torque_decay_as_those_of_a_damped_spring() -> None:
    example = Path(__file__).parents[2] / "notebooks" / "gallery" / "computed_torque.py"
    values = runpy.run_path(str(example))
    arm, start, times = values["arm"], values["start"], np.linspace(0, 0.3, 31)
    torques = Held(0.0005, values["computed_torque"])
    motion = integrate(arm, (0, 0.3), start, {}, inputs=torques, t_eval=times)
    error = motion.y[0] - np.array([values["path"](t)[0][0] for t in times])
    # e'' + 40 e' + 400 e = 0; torques are those of the sample before
    assert_allclose(error, 0.2 * (1 + 20 * times) * np.exp(-20 * times), atol=2e-3)
    late = {name: distance[400:].max() for name, distance in values["errors"].items()}
    exact, loaded, alone = sorted(late, key=late.__getitem__)
    assert (exact, alone) == ("computed torque", "feedback alone")
    assert 100 * late[exact] < late[loaded] < late[alone] / 2
    assert late[exact] < 5e-4
