"""Results that do not fit into memory are refused before the first step."""

from typing import Any

import numpy as np
import pytest

import generated.double_pendulum as dp
from solvers.equations.forms import Form
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.compiled.kernel import Batch
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.problem import problem
from solvers.integration.problem.events import Event
from solvers.integration.problem.status import Status

START, STARTS = (0.1, 0.2, 0.0, 0.0), {"theta1": [0.1, 0.2, 0.3], "theta2": 0.1}
MANY = np.broadcast_to(0.5, 10**10)  # takes no memory


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize(
    ("function", "options", "message"),
    [
        (integrate, {"method": "rk4", "h": 1e-10, "max_steps": 10**10},
         r"the ends of 10000000000 steps would take 1\.2e\+03 GB .*: give the times t_eval"),
        (integrate, {"t_eval": MANY}, r"10000000000 times t_eval would take .* GB .*: give fewer"),
        (ensemble, {"t_eval": MANY}, r"10000000000 times t_eval would take .* GB .*: give fewer"),
        (ensemble, {"events": Event(dp, "theta1", 0.0), "occurrences": 10**10},
         r"30000000003 states of 3 motions would take 3\.6e\+03 GB .*: integrate fewer motions"),
        (ensemble, {"workers": 10**9}, "workers = 1000000000 must be from 1 to 1024"),
    ],
)  # fmt: skip
def test_what_does_not_fit_into_memory_is_refused_with_its_size(
    function: Any, options: dict[str, Any], message: str
) -> None:
    start = START if function is integrate else STARTS
    with pytest.raises(ValueError, match=message):
        function(dp, (0, 1), start, dp.DEFAULTS, **options)


def test_steps_that_are_known_to_be_fewer_are_permitted() -> None:
    options: dict[str, Any] = {"method": "rk4", "max_steps": 10**12}
    assert integrate(dp, (0, 1), START, dp.DEFAULTS, h=0.01, **options).steps == 100
    recorded = integrate(dp, (0, 1e-6), START, dp.DEFAULTS, h=1e-9, t_eval=[1e-6], **options)
    assert recorded.steps == 1000


@pytest.mark.parametrize("backend", ["compiled", "python"])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_controlled_steps_stop_where_memory_ends(
    backend: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(problem, "available_bytes", lambda: 10.5 * problem.COPIES * 8 * 5)
    short = integrate(dp, (0, 9), START, dp.DEFAULTS, max_steps=10**9, backend=backend)
    assert (short.status, short.steps) == (Status.STEP_LIMIT, 10)
    assert "do not fit into memory, give times t_eval" in short.message
    whole = integrate(dp, (0, 9), START, dp.DEFAULTS, t_eval=[9.0], backend=backend)
    assert whole.status is Status.FINISHED


def test_many_times_and_occurrences_are_collected_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    calls, ordinary = [], Batch.ordinary
    times, event = np.linspace(0, 9, 20_001), Event(dp, "theta1", 0.0)
    options: dict[str, Any] = {"t_eval": times, "events": event, "occurrences": 5}
    monkeypatch.setattr(Batch, "ordinary", lambda *given: calls.append(1) or ordinary(*given))
    motions = ensemble(dp, (0, 9), STARTS, {"m2": [1.0, 2.0, 3.0]}, **options)
    assert 2 <= len(calls) < 12
    monkeypatch.setattr("solvers.integration.loops.ensemble_loop.BLOCK", 700)
    assert np.array_equal(
        motions.samples, ensemble(dp, (0, 9), STARTS, {"m2": [1.0, 2.0, 3.0]}, **options).samples
    )
    one = integrate(dp, (0, 9), {"theta1": 0.2, "theta2": 0.1}, {"m2": 2.0}, t_eval=times)
    assert motions.samples[:, 1] == pytest.approx(one.y, abs=1e-9)


@pytest.mark.parametrize("span", [(0.0, 3.0), (3.0, 0.0)])
@pytest.mark.parametrize("form", ["lagrangian", "hamiltonian", "rational"])
def test_scipy_methods_compute_many_states_of_a_step_at_once(
    form: str, span: tuple[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    options: dict[str, Any] = {"method": "DOP853", "form": form}
    times, start = np.linspace(*span, 4_001), (0.5, 4.0, 0.0, 9.0)
    with ignore_predictability():
        few = integrate(dp, span, start, dp.DEFAULTS, t_eval=times[::100], **options)
    calls, ordinary = [], Form.to_ordinary
    monkeypatch.setattr(Form, "to_ordinary", lambda *given: calls.append(1) or ordinary(*given))
    with ignore_predictability():
        many = integrate(dp, span, start, dp.DEFAULTS, t_eval=times, **options)
    assert len(calls) <= 3 * many.steps
    assert np.array_equal(many.t, times)
    assert many.y[:, ::100] == pytest.approx(few.y, rel=1e-11, abs=1e-11)
    assert np.abs(np.diff(many.y[:2])).max() < 0.1  # no turn is lost
    assert many.y[:, -1].tolist() == few.end[1].tolist()
