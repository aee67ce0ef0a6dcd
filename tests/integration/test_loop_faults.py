"""Edge cases of compiled loops, each of which failed once, or could."""

import os
import signal
import threading
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from math import pi
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from handwritten import handwritten

import generated.double_pendulum as dp
import generated.single_pendulum as sp
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.prepare import NotFinishedError, prepare
from solvers.integration.problem.events import Event
from solvers.integration.problem.status import Status
from solvers.integration.results.solution import Interrupted, Solution

BACKENDS = ("python", "compiled")
FORMS = ("lagrangian", "hamiltonian", "rational")


def handwritten_module(folder: Path, derivatives: str) -> ModuleType:
    """A module with one number of state, y, and its slope in C."""
    (folder / "hand.h").write_text(
        "static inline void hand_rhs(HOLONOMIC_REAL t, const HOLONOMIC_REAL *state,\n"
        "    const HOLONOMIC_REAL *params, HOLONOMIC_REAL *result)\n"
        f"{{ result[0] = {derivatives}; (void)t; (void)state; (void)params; }}\n"
    )
    return handwritten("hand", ("y",), __file__=str(folder / "hand.py"))


@pytest.mark.parametrize("lanes", [1, 20])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_blow_up_in_finite_time_ends_with_the_results_so_far(lanes: int, tmp_path: Path) -> None:
    # y' = y² ends at t = 1/y0; neighbours that begin lower go on
    module = handwritten_module(tmp_path, "state[0]*state[0]*params[0]")
    starts = [[1.0 / (k + 1) for k in range(lanes)]]
    solution = ensemble(module, (0, 1.5), starts, (1.0,), backend="compiled", rtol=1e-10)
    assert solution.status[0] in (Status.STEP_TOO_SMALL, Status.NOT_FINITE)
    assert solution.t[0] == pytest.approx(1.0, abs=1e-6)
    assert np.isfinite(solution.y).all()
    for k in range(1, lanes):
        assert solution.status[k] is Status.FINISHED
        assert solution.y[0, k] == pytest.approx(1 / (k + 1 - 1.5), rel=1e-7)
    if lanes == 1:
        alone = integrate(module, (0, 1.5), [1.0], (1.0,), backend="compiled", rtol=1e-10)
        assert not alone.success
        assert alone.t[-1] == pytest.approx(1.0, abs=1e-6)
        assert np.isfinite(alone.y).all()


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("form", FORMS)
@ignore_predictability()
def test_coarse_fixed_steps_never_return_nan(form: str) -> None:
    rng = np.random.default_rng(4)
    for method in ("rk1", "heun", "midpoint", "rk4", "verner853"):
        starts = (rng.uniform(-3, 3, (60, 4)) * [1, 1, 1, 1e3]).T
        for h in (0.5, 1.0, 2.0):
            solution = ensemble(dp, (0, 10), starts, dp.DEFAULTS, method=method, h=h, form=form)
            assert np.isfinite(solution.y).all(), (method, h)
            assert set(solution.status) <= {Status.FINISHED, Status.NOT_FINITE, Status.UNSTABLE}
    steps = integrate(dp, (0, 10), (2, 2, 0, 0), dp.DEFAULTS, method="rk4", h=1.0)
    assert not steps.success
    assert np.isfinite(steps.y).all()
    assert np.isfinite(steps.end[1]).all()


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_sine_and_cosine_far_from_the_circle_come_back_to_it() -> None:
    solution = integrate(
        sp, (0, 1), (0.5, 1e160), sp.DEFAULTS, method="rk1", h=0.5, form="rational"
    )
    assert np.isfinite(solution.y).all()
    # Euler's step from the bottom goes along the tangent: sin = 1000, cos = 1
    one = ensemble(sp, (0, 0.5), [[0.0], [2e3]], sp.DEFAULTS, method="rk1", h=0.5, form="rational")
    assert np.tan(one.y[0, 0]) == pytest.approx(1e3, rel=1e-6)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_motion_that_starts_at_an_event_has_not_crossed_it(backend: str) -> None:
    for angle in np.linspace(-3, 3, 61):
        for velocity in (1.0, -1.0):
            solution = integrate(
                sp,
                (0, 0.01),
                (angle, velocity),
                sp.DEFAULTS,
                backend=backend,
                form="rational",
                events=Event(sp, "theta", angle, terminal=True),
            )
            assert solution.status is Status.FINISHED, (angle, velocity)


def test_an_event_at_the_end_of_a_step_is_located_once(tmp_path: Path) -> None:
    # the midpoint rule adds h without rounding: the value is 0 where a step ends
    module = handwritten_module(tmp_path, "params[0]")
    for direction in (0, 1):
        solution = integrate(
            module,
            (0, 1),
            [0.0],
            (1.0,),
            method="midpoint",
            h=0.25,
            backend="compiled",
            events=Event(module, "y", 0.5, direction),
        )
        assert solution.t_events[0] == pytest.approx([0.5], abs=1e-14)
    down = integrate(
        module,
        (0, 1),
        [0.0],
        (1.0,),
        method="midpoint",
        h=0.25,
        backend="compiled",
        events=Event(module, "y", 0.5, -1),
    )
    assert not down.t_events[0].size


def test_events_after_a_terminal_event_within_its_step_do_not_count(
    tmp_path: Path,
) -> None:
    module = handwritten_module(tmp_path, "params[0]")
    events = [
        Event(module, "y", value, terminal=end)
        for value, end in ((0.7, True), (0.6, True), (0.8, True), (0.65, False), (0.55, False))
    ]
    solution = integrate(
        module,
        (0, 1),
        [0.0],
        (1.0,),
        method="rk4",
        h=0.5,
        backend="compiled",
        events=events,
        t_eval=[0.52, 0.58, 0.62],
    )
    assert solution.status is Status.EVENT
    assert solution.end[0] == pytest.approx(0.6, abs=1e-14)
    assert [len(times) for times in solution.t_events] == [0, 1, 0, 0, 1]
    assert solution.t.tolist() == [0.52, 0.58]


def test_occasional_failures_of_steps_do_not_end_a_run(tmp_path: Path) -> None:
    # y = sin t, known only nearby: long steps ask for it too far away, again and again
    near = "fabs(state[0] - sin(t)) < 0.01 ? cos(t)*params[0] : 0.0/0.0"
    module = handwritten_module(tmp_path, near)
    solution = integrate(
        module, (0, 60), [0.0], (1.0,), method="bs32", rtol=0.5, atol=0.5, backend="compiled"
    )
    assert solution.status is Status.FINISHED
    assert solution.rejected > 30
    assert np.abs(solution.y[0] - np.sin(solution.t)).max() < 0.01


def test_an_event_is_located_in_a_few_iterations() -> None:
    run = partial(integrate, sp, (0, 20), (1.0, 0.0), sp.DEFAULTS, backend="compiled", rtol=1e-10)
    plain, watched = run(), run(events=Event(sp, "theta", 0.5))
    tries = (watched.nfev - plain.nfev) / 13 / len(watched.t_events[0])
    assert len(watched.t_events[0]) > 10
    assert tries < 9


@pytest.mark.parametrize(
    ("hole", "samples"), [(0.21, [0.21]), (0.165, [0.1, 0.3])], ids=["shorter step", "extension"]
)
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_step_whose_inner_states_fail_is_discarded_whole(
    tmp_path: Path, hole: float, samples: list[float]
) -> None:
    # a hole that the step and the event within it jump over, but not the states at samples
    there = f"fabs(*(const double *)&t - {hole}) < 1e-4 ? 0.0/0.0 : params[0]"
    module = handwritten_module(tmp_path, there)
    solution = integrate(
        module,
        (0, 5),
        [0.0],
        (1.0,),
        method="rk4",
        h=0.5,
        backend="compiled",
        t_eval=samples,
        events=Event(module, "y", 0.4),
    )
    assert solution.status is Status.NOT_FINITE
    assert (solution.t.size, solution.t_events[0].size, solution.end[0]) == (0, 0, 0.0)


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_event_is_located_where_rounding_blurs_its_sign(backend: str) -> None:
    solution = integrate(
        sp,
        (-1, -3),
        (17.880152717337147, -0.3221897508884375),
        sp.DEFAULTS,
        t_eval=[],
        form="lagrangian",
        rtol=1e-8,
        atol=1e-10,
        backend=backend,
        events=Event(sp, "theta_dot", -1.3767516817975083),
    )
    assert solution.t_events[0] == pytest.approx([-1.28150329, -2.06916657], abs=1e-8)


@pytest.mark.parametrize("backend", BACKENDS)
def test_of_events_at_the_same_time_the_first_in_the_list_counts(backend: str) -> None:
    stops, passes = (Event(sp, "theta", 0.2, terminal=end) for end in (True, False))
    for events, expected in (
        ([stops, stops, passes], [1, 0, 0]),
        ([passes, stops, passes], [1, 1, 0]),
    ):
        solution = integrate(sp, (0, 5), (1.0, 0.0), sp.DEFAULTS, events=events, backend=backend)
        assert [len(times) for times in solution.t_events] == expected


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize(
    ("method", "rtol"),
    [("bs32", 1e-6), ("dp54", 1e-6), ("tsit54", 1e-6), ("dop853", 1e-1), ("verner98", 1e-1)],
)
def test_both_loops_choose_the_same_steps(method: str, rtol: float) -> None:
    # so coarse that estimates are not rounding errors, which the loops do not share
    start = (1.0, 2.0, 0.5, 0.0)
    run = partial(integrate, dp, (0, 2), start, dp.DEFAULTS, method=method, rtol=rtol, atol=rtol)
    for form in FORMS:
        python, compiled = (run(form=form, backend=backend) for backend in BACKENDS)
        assert compiled.rejected == python.rejected
        assert compiled.nfev == pytest.approx(python.nfev, abs=python.rejected + 1)
        assert compiled.t == pytest.approx(python.t, rel=1e-5)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_step_limit_of_0_takes_no_step(backend: str) -> None:
    solution = integrate(sp, (0, 1), (1.0, 0.0), sp.DEFAULTS, max_steps=0, backend=backend)
    assert (solution.steps, solution.status) == (0, Status.STEP_LIMIT)
    assert solution.t.tolist() == [0.0]
    many = ensemble(sp, (0, 1), [[1.0] * 99, [0.0] * 99], sp.DEFAULTS, max_steps=0, backend=backend)
    assert many.steps.tolist() == [0] * 99
    assert set(many.status) == {Status.STEP_LIMIT}
    for senseless in (2**63, 10**20, 2.0):
        with pytest.raises(ValueError, match="max_steps = "):
            integrate(sp, (0, 1), (1.0, 0.0), sp.DEFAULTS, max_steps=senseless, backend=backend)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("start", "params", "form"),
    [
        ((1.0, 0.0), (1.0, 0.0, 9.8), "lagrangian"),
        ((1.0, 0.0), (0.0, 1.0, 9.8), "hamiltonian"),
        ((1.0, 1e200), (1.0, 1.0, 9.8), "rational"),
    ],
)
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_motion_without_a_finite_derivative_ends_at_its_start(
    start: tuple[float, float], params: tuple[float, ...], form: str, backend: str
) -> None:
    solution = integrate(sp, (0, 1), start, params, form=form, backend=backend)
    if form == "rational":  # huge, but a number: the steps become too short, or not finite
        assert not solution.success
        return
    assert solution.status is Status.NOT_FINITE
    assert solution.end[0] == 0.0
    assert solution.end[1].tolist() == list(start)


def test_an_interruption_leaves_times_and_states_of_the_same_length() -> None:
    for seconds in (0.05, 0.11, 0.17):
        timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with pytest.raises(Interrupted) as stopped:
            integrate(sp, (0, 1e9), (1.0, 0.0), sp.DEFAULTS, max_steps=10**12)
        timer.cancel()
        kept = stopped.value.solution
        assert isinstance(kept, Solution)
        assert kept.y.shape[1] == len(kept.t)
        assert kept.t[-1] == kept.end[0]
        assert np.array_equal(kept.y[:, -1], kept.end[1])


@pytest.mark.parametrize("backend", BACKENDS)
def test_samples_have_the_requested_times(backend: str) -> None:
    for span, times in (
        ((-1.0, 1.0), [1e-20]),
        ((10.0, 0.0), np.linspace(0, 10, 3001)[::-1]),
        ((0.0, 1.0), [0.0, 5e-324, 1.0]),
    ):
        start = (1e6 + 0.1, 1.0, 0.0, 0.0)
        solution = integrate(dp, span, start, dp.DEFAULTS, t_eval=times, backend=backend)
        assert np.array_equal(solution.t, times)
        if times[0] == span[0]:
            assert solution.y[:, 0].tolist() == list(start)


def test_ensembles_of_no_motions_or_over_no_time_are_valid() -> None:
    assert ensemble(sp, (0, 1), np.zeros((2, 0)), sp.DEFAULTS).y.shape == (2, 0)
    still = ensemble(sp, (2, 2), [[1.0], [0.5]], sp.DEFAULTS, t_eval=[2.0])
    assert (still.steps[0], still.nfev[0], still.status[0]) == (0, 0, Status.FINISHED)
    assert still.samples[:, 0, 0].tolist() == still.y[:, 0].tolist() == [1.0, 0.5]
    starts = np.random.default_rng(5).uniform(-9, 9, (2, 50))
    assert np.array_equal(ensemble(sp, (2, 2), starts, sp.DEFAULTS).y, starts)
    for arguments, message in (
        ({"workers": 1.5}, "workers = 1.5"),
        ({"workers": "2"}, "workers = '2'"),
        ({"occurrences": 1.5}, "occurrences = 1.5"),
        ({"events": Event(dp, "theta1", 0.0)}, "is not of generated.single_pendulum"),
        ({"method": 3}, "method = 3 must be the name of a method"),
    ):
        with pytest.raises(ValueError, match=message):
            ensemble(sp, (0, 1), [[1.0], [0.0]], sp.DEFAULTS, **arguments)
    with pytest.raises(ValueError, match="theta = 'a' must be a finite real number in rad"):
        Event(sp, "theta", "a")


def test_a_prepared_run_names_the_invalid_argument() -> None:
    run = prepare(sp, sp.DEFAULTS)
    for span, start, message in (
        ((0, 0), (float("nan"), 0), "theta = nan must be a finite real number"),
        ((float("inf"),) * 2, (1, 0), r"t_span\[0\] = inf must be a finite real number in s"),
        ((0, 1), (None, 0), "theta = None must be a finite real number"),
        ((0, 1), ("1", 0), "theta = '1' must be a finite real number"),
        (("0", 1), (1, 0), r"t_span\[0\] = '0' must be a finite real number"),
        ((0, 1, 2), (1, 0), "t_span has shape"),
        ((0, 1), 1.0, "y0 has shape"),
        ((0, 1), (1, 2, 3), "y0 has shape"),
    ):
        with pytest.raises(ValueError, match=message):
            run(span, start)
    assert run((0, 1), np.array([1.0, 0.0])) == run((0, 1), [1, 0])
    with pytest.raises(NotFinishedError) as stopped:
        prepare(sp, (0.0, 1.0, 9.8), form="hamiltonian")((0, 1), (1.0, 0.0))
    assert stopped.value.status is Status.NOT_FINITE


def test_a_prepared_run_refuses_a_second_thread_during_a_call() -> None:
    run = prepare(dp, dp.DEFAULTS, method="rk4", h=1e-5, max_steps=10**8)
    alone = run((0, 10), (1.0, 2.0, 0.0, 0.0))
    barrier = threading.Barrier(2)

    def call(start: tuple[float, ...]) -> tuple[float, ...] | str:
        barrier.wait()
        try:
            return run((0, 10), start)
        except RuntimeError as error:
            return str(error)

    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(call, [(1.0, 2.0, 0.0, 0.0)] * 2))
    assert sum(result == alone for result in results) == 1
    assert sum("one function for each thread" in str(result) for result in results) == 1
    with pytest.raises(ValueError, match="y0"):
        run((0, 10), (1.0,))
    assert run((0, 10), (1.0, 2.0, 0.0, 0.0)) == alone  # it is free again, also after an error


def test_angles_of_pi_are_events_on_either_side() -> None:
    spinning = ensemble(
        sp,
        (0, 3),
        [[0.0, 0.0], [9.0, -9.0]],
        sp.DEFAULTS,
        occurrences=9,
        events=[Event(sp, "theta", turn * pi) for turn in (-3, -1, 1, 3)],
    )
    assert spinning.occurred.tolist() == [[0, 0, 1, 1], [1, 1, 0, 0]]
