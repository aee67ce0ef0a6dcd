"""Compiled loops that are interrupted, lack a compiler, or cannot solve the problem."""

import os
import platform
import signal
import threading
from collections.abc import Callable

import numpy as np
import pytest

import generated.double_pendulum as dp
import generated.single_pendulum as sp
from solvers.integration.checks.step_stability import StepWarning
from solvers.integration.compiled import compiler
from solvers.integration.compiled.kernel import kernel
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.ode_solver import ode_solver
from solvers.integration.prepare import prepare
from solvers.integration.problem.events import Event
from solvers.integration.problem.status import Status
from solvers.integration.results.ensemble_solution import Ensemble
from solvers.integration.results.solution import Interrupted, Solution

FORMS = ("lagrangian", "hamiltonian", "rational")


def interrupted_after(seconds: float, run: Callable[[], object]) -> Interrupted:
    """What an interruption by the user leaves behind."""
    timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        with pytest.raises(Interrupted) as stopped:
            run()
    finally:
        timer.cancel()
    return stopped.value


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("backend", ["compiled", "python"])
def test_an_interrupted_integration_returns_its_results_so_far(backend: str) -> None:
    def until(end: float) -> Solution:
        options = {"backend": backend, "max_steps": 10**12, "t_eval": [0.0, 1.0, end]}
        return integrate(sp, (0, end), (1.0, 0.0), sp.DEFAULTS, **options)

    until(2.0)  # an interruption of the compiler is no interruption of the motion
    kept = interrupted_after(0.3, lambda: until(1e12)).solution
    assert isinstance(kept, Solution)
    assert kept.status is Status.INTERRUPTED
    assert kept.end[0] > 1.0
    assert kept.t.tolist() == [0.0, 1.0]
    # and the run can go on from there
    on = integrate(sp, (kept.end[0], kept.end[0] + 1), kept.end[1], sp.DEFAULTS)
    assert on.success


def test_an_interrupted_ensemble_returns_its_results_so_far() -> None:
    def until(end: float) -> Ensemble:
        starts = [[1.0] * 40, [0.0] * 40]
        return ensemble(sp, (0, end), starts, sp.DEFAULTS, max_steps=10**12)

    until(2.0)
    kept = interrupted_after(0.3, lambda: until(1e12)).solution
    assert isinstance(kept, Ensemble)
    assert set(kept.status) == {Status.INTERRUPTED}
    assert (kept.t > 0).sum() >= 16
    assert not kept.success.any()


def test_without_a_compiler_it_runs_in_python_with_a_warning(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(compiler, "compilers", lambda: iter(()))
    span, start, params = (0.0, 0.7), (1.0, 0.0), sp.DEFAULTS
    options = {"method": "rk4", "h": 0.0703125}  # not built by any other test
    kernel.cache_clear()
    with pytest.warns(UserWarning, match="integrating in Python: no C compiler"):
        found = integrate(sp, span, start, params, **options)
    assert (found.backend, found.success) == ("python", True)
    assert "lagrangian" in found.run
    with pytest.warns(UserWarning, match="no C compiler"):
        many = ensemble(sp, span, np.transpose([start] * 2), params, **options)
    assert many.success.all()
    assert np.array_equal(many.y[:, 1], found.y[:, -1])
    for forced in (
        lambda: integrate(sp, span, start, params, backend="compiled", **options),
        lambda: integrate(sp, span, start, params, compensated=True, **options),
        lambda: ensemble(sp, span, [[1.0], [0.0]], params, backend="compiled", **options),
        lambda: prepare(sp, params, **options),
    ):
        with pytest.raises(compiler.NoCompilerError, match="install one as `cc`"):
            forced()
    kernel.cache_clear()


FLUSH = """
void flush(int on);
void flush(int on)
{
    const unsigned bits = 0x8040, now = __builtin_ia32_stmxcsr();
    __builtin_ia32_ldmxcsr(on ? now | bits : now & ~bits);
}
"""


@pytest.mark.skipif(platform.machine() != "x86_64", reason="switches flushing on as x86-64 does")
@pytest.mark.parametrize("bits", ["0x8000", "0x0040", "0x8040"])
def test_a_process_that_sets_small_numbers_to_zero_is_warned(bits: str) -> None:
    flush = compiler.build(FLUSH.replace("0x8040", bits)).functions.flush
    runs: dict[str, Callable[[], object]] = {
        "integrate": lambda: integrate(sp, (0, 0.1), (1.0, 0.0), sp.DEFAULTS),
        "ensemble": lambda: ensemble(sp, (0, 0.1), [[1.0] * 2, [0.0] * 2], sp.DEFAULTS),
        "prepare": lambda: prepare(sp, sp.DEFAULTS),
        "ode_solver": lambda: ode_solver("verner853"),
    }
    for run in runs.values():
        run()
        flush(1)
        try:
            with pytest.warns(UserWarning, match="sets numbers below 2.2e-308 to zero"):
                run()
        finally:
            flush(0)


def test_problems_that_cannot_be_compiled_run_in_python() -> None:
    def passes(t: float, y: np.ndarray) -> float:
        return float(y[0])

    found = integrate(sp, (0, 1), (1.0, 0.0), sp.DEFAULTS, events=passes)
    assert found.backend == "python"
    for options, reason in (
        ({"events": passes}, "an event is a Python function"),
        ({"atol": [1e-9, 1e-9], "form": "lagrangian"}, "atol differs"),
        ({"method": "DOP853"}, "SciPy's"),
        ({"events": [Event(sp, "theta", k) for k in range(9)]}, "more than 8 events"),
        ({"events": Event(sp, "theta_dot", 0.0), "form": "hamiltonian"}, "does not hold"),
    ):
        with pytest.raises(ValueError, match=reason):
            integrate(sp, (0, 1), (1.0, 0.0), sp.DEFAULTS, backend="compiled", **options)
    with pytest.raises(ValueError, match="backend 'c' must be"):
        integrate(sp, (0, 1), (1.0, 0.0), sp.DEFAULTS, backend="c")
    with pytest.raises(ValueError, match="needs a compiled loop"):
        integrate(sp, (0, 1), (1.0, 0.0), sp.DEFAULTS, backend="python", compensated=True)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"y0": [1.0, 0.0]}, "y0 has shape .* theta, theta_dot"),
        ({"y0": [(1.0, 0.0)] * 3}, r"y0 has shape \(3, 2\): .*transpose it: y0.T"),
        ({"y0": [[1.0], [float("inf")]]}, "finite"),
        ({"y0": {"theta": [1.0, 2.0], "omega": 0.0}}, "y0 has no 'omega'.*theta, theta_dot"),
        ({"y0": {"theta_dot": [1.0, 2.0]}}, "y0 lacks theta, on which"),
        ({"y0": {"theta": [1.0, 2.0], "theta_dot": [0.0] * 3}}, "differ in shape: theta: "),
        ({"params": np.ones((3, 3))}, "params holds values for 3 motions, but y0 has"),
        ({"params": np.ones((2, 3))}, "transpose it: params.T"),
        ({"params": {"mass": 1.0}}, "params has no 'mass'"),
        ({"params": (1.0, 2.0)}, "m, l, g"),
        ({"workers": 0}, "workers = 0"),
        ({"occurrences": True}, "occurrences = True"),
        ({"t_eval": [2.0]}, "outside of t_span"),
        ({"method": "rk4"}, "give a fixed step h"),
        ({"backend": "gpu"}, "backend 'gpu'"),
    ],
)
def test_invalid_ensembles_are_refused(arguments: dict[str, object], message: str) -> None:
    usual = {"t_span": (0, 1), "y0": [[1.0] * 2, [0.0] * 2], "params": sp.DEFAULTS}
    with pytest.raises(ValueError, match=message):
        ensemble(sp, **{**usual, **arguments})


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(("backend", "lanes"), [("compiled", 1), ("compiled", 3), ("python", 1)])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_motion_that_overflows_ends_with_a_status(backend: str, lanes: int, form: str) -> None:
    # Euler with steps far too long, from a huge velocity; its neighbours are left alone
    starts = np.zeros((4, lanes))
    starts[:, 0] = 1.0, 1.0, 1e200, -1e200
    options = {"form": form, "backend": backend}
    with pytest.warns(StepWarning, match=f"1 of {lanes} motions are unstable; of motion 0, "):
        fixed = ensemble(dp, (0, 9), starts, dp.DEFAULTS, method="rk1", h=0.5, **options)
    assert fixed.status[0] is Status.UNSTABLE
    assert all(status is Status.FINISHED for status in fixed.status[1:])
    assert np.isfinite(fixed.y).all()
    controlled = ensemble(dp, (0, 9), starts, dp.DEFAULTS, **options)
    assert controlled.status[0] in (Status.NOT_FINITE, Status.STEP_TOO_SMALL, Status.STEP_LIMIT)
    assert all(status is Status.FINISHED for status in controlled.status[1:])
