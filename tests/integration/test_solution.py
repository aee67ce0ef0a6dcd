"""Solutions and ensembles as text, tables and datasets, and flags that stop ensembles."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import generated.double_pendulum as dp
import generated.elastic_pendulum as ep
import generated.single_pendulum as sp
from solvers import Event, StopFlag, ensemble, integrate
from solvers.integration.problem.status import Status
from solvers.io import exports
from solvers.sweeps.definition.axes import Grid
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution import pool, worker
from solvers.sweeps.execution.sweep_run import sweep
from solvers.sweeps.maps.final import Final

Y0 = {"r": 1.1, "theta": 0.5}


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_solution_shows_status_steps_method_and_final_state() -> None:
    solution = integrate(ep, (0, 2), Y0, {}, method="rk4", h=0.01)
    lines = repr(solution).splitlines()
    assert lines[0] == "Solution: the integration reached the end of the time span"
    assert lines[1] == "  t = 0 to 2 s, 201 times, 200 steps, 0 rejected"
    assert "Classical fourth order, rational form, h = 0.01, compiled by" in lines[2]
    end = solution.y[:, -1]
    expected = zip(ep.STATE, end, ("m", "rad", "m/s", "rad/s"), strict=True)
    state = ", ".join(f"{n} = {y:.6g} {u}" for n, y, u in expected)
    assert lines[3] == f"  final state, t = 2 s: {state}"
    nothing = integrate(ep, (0, 2), Y0, {}, t_eval=[], max_steps=1)
    assert "maximum number of steps" in repr(nothing)
    assert "\n  0 times, 1 step, 0 rejected" in repr(nothing)


@pytest.mark.parametrize(
    ("t_eval", "text"),
    [
        ([2], "t = 2 s, 1 time, "),
        ([1], "t = 1 s, 1 time, "),
        ([0.5, 1, 1.5], "t = 0.5 to 1.5 s, 3 times, "),
    ],
)
def test_a_solution_shows_requested_times_apart_from_its_end(
    t_eval: list[float], text: str
) -> None:
    solution = integrate(ep, (0, 2), Y0, {}, t_eval=t_eval)
    lines = repr(solution).splitlines()
    assert lines[1].startswith(f"  {text}")
    assert lines[3].startswith("  final state, t = 2 s: r = ")


def test_a_table_of_a_solution_has_a_column_for_each_component() -> None:
    solution = integrate(ep, (0, 2), Y0, {}, energy=True)
    table = solution.to_table()
    assert list(table) == ["t", *ep.STATE, "energy"]
    assert_array_equal(table["t"], solution.t)
    for row, name in zip(solution.y, ep.STATE, strict=True):
        assert_array_equal(table[name], row)
    assert_array_equal(table["energy"], solution.energy)
    changes = np.concatenate([solution.y[:, 0], np.ones(4)])
    variational = integrate(ep, (0, 2), changes, {}, form="variational")
    assert list(variational.to_table())[5:] == [f"delta_{name}" for name in ep.STATE]


def test_a_table_of_an_ensemble_has_a_row_for_each_motion() -> None:
    y0 = {"theta": [0.5, 3.1415, 1.0]}
    events = Event(sp, "theta", 0.0, terminal=True)
    motions = ensemble(sp, (0, 2), y0, {}, events=events, t_eval=[0.1, 0.2])
    table = motions.to_table()
    assert list(table) == ["t", "theta", "theta_dot", "status", "steps", "rejected", "nfev"]
    assert len(table) == 3
    assert table["status"].tolist() == ["EVENT", "FINISHED", "EVENT"]
    assert_array_equal(table["theta_dot"], motions.y[1])
    lines = repr(motions).splitlines()
    assert lines[0] == "Ensemble: 3 motions, 1 FINISHED, 2 EVENT"
    assert lines[1].startswith("  2 times, 1 event, ")
    changes = ensemble(
        sp, (0, 2), {"theta": [0.5, 1.0], "delta_theta": 1.0}, {}, form="variational"
    )
    assert np.isfinite(changes.to_table()["growth"]).all()


def test_datasets_have_names_and_units() -> None:
    pytest.importorskip("xarray")
    solution = integrate(ep, (0, 2), Y0, {}, energy=True)
    dataset = solution.to_xarray()
    assert dataset["theta"].dims == ("t",)
    units = {"t": "s", "r": "m", "theta_dot": "rad/s", "energy": "J"}
    assert {name: dataset[name].attrs["units"] for name in units} == units
    assert_array_equal(dataset["theta"], solution.y[1])
    assert dataset.attrs["status"] == "FINISHED"
    motions = ensemble(
        sp,
        (0, 2),
        {"theta": [0.5, 1.0, 2.0]},
        {},
        t_eval=[0, 1.5],
        events=Event(sp, "theta", 0.0),
        occurrences=2,
    )
    dataset = motions.to_xarray()
    assert dict(dataset.sizes) == {
        "motion": 3,
        "component": 2,
        "time": 2,
        "event": 1,
        "occurrence": 2,
    }
    assert_array_equal(dataset["y"].sel(component="theta_dot"), motions.y[1])
    assert_array_equal(
        dataset["samples"].sel(component="theta", time=1.5), motions.samples[0, :, 1]
    )
    assert dataset["unit"].values.tolist() == ["rad", "rad/s"]


def test_without_xarray_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> Any:
        raise ImportError(name)

    monkeypatch.setattr(exports, "import_module", missing)
    with pytest.raises(ImportError, match=r"pip install 'holonomic\[xarray\]'"):
        integrate(sp, (0, 1), {"theta": 1.0}, {}).to_xarray()


@pytest.mark.parametrize("backend", ["compiled", "python"])
def test_a_stop_flag_stops_its_own_ensembles_only(backend: str) -> None:
    flag, start, results = StopFlag(), {"theta": [0.1, 1.0]}, {}
    options: dict[str, Any] = {"backend": backend, "max_steps": 10**12, "workers": 1}
    options |= {"method": "rk4", "h": 0.05}

    def long() -> None:
        results["long"] = ensemble(sp, (0, 1e9), start, {}, stop=flag, **options)

    thread = threading.Thread(target=long)
    thread.start()
    other = ensemble(sp, (0, 0.05), {"theta": [0.5]}, {}, stop=StopFlag(), **options)
    flag.set()
    thread.join()
    assert set(other.status) == {Status.FINISHED}
    assert Status.INTERRUPTED in results["long"].status
    stopped = ensemble(sp, (0, 1), start, {}, stop=flag, **options)
    assert set(stopped.status) == {Status.INTERRUPTED}


@pytest.mark.parametrize("method", ["verner853", "gauss2", "DOP853", "LSODA"])
def test_a_stop_flag_ends_a_motion_in_python_with_its_last_step(method: str) -> None:
    flag = StopFlag()

    def later(t: float, y: Any) -> float:
        if t > 1:
            flag.set()
        return 1.0

    options = {"method": method, "events": later, "backend": "python", "max_steps": 10**12}
    if method == "gauss2":
        options["h"] = 0.01
    motions = ensemble(sp, (0, 1e9), {"theta": [0.5, 1.0]}, {}, stop=flag, **options)
    assert set(motions.status) == {Status.INTERRUPTED}
    assert 1 < motions.t[0] < 3
    good = integrate(sp, (0, motions.t[0]), {"theta": 0.5}, {}, rtol=1e-12, atol=1e-14).y[:, -1]
    np.testing.assert_allclose(motions.y[:, 0], good, atol=1e-6)
    assert np.isnan(motions.t[1])  # not started


def test_nothing_is_computed_for_warnings_of_stopped_motions() -> None:
    flag, starts = StopFlag(), []

    def second_start(t: float, y: Any) -> float:
        if t == 0:
            starts.append(y)
        if len(starts) == 2:
            flag.set()
        return 1.0

    options = {"rtol": 1e-4, "events": second_start, "backend": "python", "stop": flag}
    y0 = {"theta1": [2.0, 2.1], "theta2": 2.0}
    motions = ensemble(dp, (0, 30), y0, dp.DEFAULTS, **options)  # not predictable to its end
    assert list(motions.status) == [Status.FINISHED, Status.INTERRUPTED]


def test_a_sweep_that_fails_stops_no_other_motions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker, "COST", 1e-6)  # so that there are several chunks
    angles = np.linspace(-2, 2, 200)
    definition = Sweep(sp, Grid({"theta": angles}), {"end": Final(("theta",))}, duration=2.0)
    is_running, has_failed, results = threading.Event(), threading.Event(), {}

    def event(t: float, y: Any) -> float:
        is_running.set()
        assert has_failed.wait(60)
        return float(y[0])

    def other() -> None:
        results["other"] = ensemble(
            sp, (0, 1), {"theta": [0.1, 0.2]}, {}, events=event, backend="python"
        )

    def failing(*job: Any) -> None:
        raise ArithmeticError("planted")

    thread = threading.Thread(target=other)
    thread.start()
    assert is_running.wait(60)
    with monkeypatch.context() as patch:
        patch.setattr(pool, "run_equal_chunk", failing)
        with pytest.raises(ArithmeticError, match="planted"):
            sweep(definition, tmp_path / "failing")
    has_failed.set()
    thread.join()
    assert results["other"].success.all()
    assert np.isfinite(sweep(definition, tmp_path / "other").maps["end"]).all()


def test_a_motion_over_no_time_stays_at_its_start() -> None:
    solution = integrate(sp, (1, 1), (0.3, 2.0), {})
    assert solution.equations.states(np.ones(3)).tolist() == [[0.3, 2.0]] * 3
    (shown,) = solution.sampled_motions()
    assert (shown.y.T == [0.3, 2.0]).all()
