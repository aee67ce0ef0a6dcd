"""A sweep reports the ranges of its maps, and by how much tighter tolerances change them."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import generated.double_pendulum as dp
import generated.single_pendulum as sp
from solvers.sweeps.definition.axes import Grid, Random
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution import sweep_run, worker
from solvers.sweeps.execution.initial_states import initial_states
from solvers.sweeps.execution.sweep_run import Convergence
from solvers.sweeps.maps.energy_error import EnergyError
from solvers.sweeps.maps.extremes import Extremes
from solvers.sweeps.maps.final import Final
from solvers.sweeps.maps.first import First
from solvers.sweeps.maps.lyapunov import Lyapunov
from solvers.sweeps.plot_quantity import Quantity
from solvers.sweeps.results import STATUSES, Results
from solvers.sweeps.sweep_summary import as_json, ranges, summary

PI = np.pi
FLIP = {"theta1": (-PI, PI), "theta2": (-PI, PI)}
TOPS = ({"theta1": PI}, {"theta2": PI})


@pytest.fixture
def results() -> Results:
    maps = {"low": First({"theta": (-0.5,)}), "reach": Extremes(("theta",)), "end": Final(sp.STATE)}
    axes = Grid({"theta": [0.1, 0.2, 0.3, 0.4]})
    definition = Sweep(sp, axes, maps, 2.5, name="mine", title="Mine", rtol=1e-8)
    numbers = {
        "low": np.array([np.nan, 4.0, 1.0, 2.0]),
        "reach": np.array([[[-1.0, 1.0]], [[-2.0, 2.0]], [[-3.0, 3.5]], [[-5.0, 4.0]]]),
        "end": np.full((4, 2), np.nan),
    }
    status = np.array([STATUSES.index(name) for name in ["finished"] * 3 + ["step limit"]])
    return Results(definition, Path("mine"), numbers, axes.coordinates(), status)


def test_the_summary_states_ranges_with_units_and_changes_with_tighter_tolerances(
    results: Results,
) -> None:
    changes = {"low": Convergence(3, 1e-7, 2e-6, 0.25)}
    title, first, *lines = summary(results, 12.34, changes)
    assert title == "Mine"
    assert first.startswith("4 motions of 2.5 s, ")
    assert first.endswith(" rational form, rtol = 1e-08; this run took 12.3 s")
    assert lines == [
        "status: finished 3, step limit 1 (raise max_steps)",
        "low: 1 to 4 s, median 2 s; 75.0% of the map has values",
        "reach, smallest theta: -5 to -1 rad, median -2.5 rad; 100.0% of the map has values",
        "reach, largest theta: 1 to 4 rad, median 2.75 rad; 100.0% of the map has values",
        "end theta: no values",
        "end theta_dot: no values",
        "low: of 3 motions repeated with rtol = 1e-10, half change by less than 1e-07 s, "
        "90 % by less than 2e-06 s; 25% exist with one tolerance only",
    ]


def test_the_json_of_a_sweep_has_the_same_numbers(results: Results) -> None:
    changes = {"low": Convergence(3, 1e-7, 2e-6, 0.25)}
    values = as_json(results, 12.34, changes)
    assert values == {
        "sweep": "mine",
        "folder": "mine",
        "definition": results.definition.as_json,
        "motions": 4,
        "seconds": 12.34,
        "status": {"finished": 3, "step limit": 1},
        "maps": ranges(results),
        "records": {},
        "convergence": changes,
    }
    part = {"smallest": 1.0, "median": 2.75, "largest": 4.0, "unit": "rad", "known": 1.0}
    assert values["maps"]["reach theta largest"] == part


def test_convergence_compares_the_numbers_that_both_tolerances_have(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    axes, tolerances = Grid({"theta": np.linspace(0.1, 1, 50)}), []
    definition = Sweep(sp, axes, {"low": First({"theta": (-0.5,)})}, 2.0)

    def chunk(one: Sweep, columns: dict[str, Any]) -> np.ndarray:
        records = np.zeros(len(columns["theta"]), one.dtype)
        records["low"] = np.arange(len(records)) ** (1 + len(tolerances))  # k, then k²
        records["low"][: 2 - len(tolerances)] = np.nan  # two are unknown, then one
        tolerances.append((one.rtol, one.atol))
        return records

    monkeypatch.setattr(sweep_run, "run_chunk", chunk)
    change = sweep_run.convergence(definition)["low"]
    rtol, atol = definition.rtol, definition.atol
    assert tolerances == [(rtol, atol), (rtol / 100, atol / 100)]
    n = change.motions
    known = np.arange(2, n)
    assert 25 < n <= 50
    assert change.median == np.median(known**2 - known)
    assert np.mean(known**2 - known <= change.most) == pytest.approx(0.9, abs=1 / n)
    assert change.lost == 1 / n


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("barrier", [(), TOPS])
def test_a_chunk_is_a_second_of_evaluations_whatever_share_is_integrated(
    barrier: tuple[dict[str, float], ...],
) -> None:
    starts = Random({"theta1": (-PI, PI), "theta2": (-PI, PI)}, 10**7, seed=3)
    definition = Sweep(dp, starts, {"flip": First(FLIP, barrier)}, 800.0, rtol=1e-9)
    columns = starts.subset(64)
    states, params, status = initial_states(definition, columns)
    runs = status == 0
    assert (0.3 < runs.mean() < 0.8) if barrier else runs.all()
    motions = worker.integrated(definition, states[runs], [column[runs] for column in params])
    evaluations = worker.mean_evaluations(definition, columns)
    assert evaluations == pytest.approx(motions.nfev.sum() / len(status), rel=0.001)
    seconds = evaluations * worker.EVALUATION * 4**1.5
    assert worker.chunk_length(definition, evaluations) * seconds == pytest.approx(1, rel=0.001)


def test_a_chunk_of_long_motions_is_one_motion() -> None:
    definition = Sweep(sp, Grid({"theta": [0.1, 0.2]}), {"end": Final(("theta",))}, 1.0)
    assert worker.chunk_length(definition, 1e12) == 1


def test_axes_are_described_by_all_that_determines_them() -> None:
    assert Random({"theta1": (-1, 2)}, 10, seed=5).as_json == {
        "kind": "random",
        "axes": [{"name": "theta1", "from": -1.0, "to": 2.0}],
        "count": 10,
        "seed": 5,
    }
    (axis,) = Grid({"theta1": [0.1, 0.2, 0.4]}).as_json["axes"]
    (other,) = Grid({"theta1": [0.1, 0.3, 0.4]}).as_json["axes"]
    assert (axis["name"], axis["count"], axis["first"], axis["last"]) == ("theta1", 3, 0.1, 0.4)
    assert axis["sha256"] != other["sha256"]


def test_the_order_of_fixed_values_does_not_matter() -> None:
    axes, maps = Grid({"theta1": [0.1]}), {"end": Final(("theta1",))}
    one, other = (
        json.dumps(Sweep(dp, axes, maps, 1.0, values).as_json)
        for values in ({"theta2": 0.2, "m1": 2.0}, {"m1": 2.0, "theta2": 0.2})
    )
    assert one == other


def test_colours_of_exponents_begin_at_zero_or_below(results: Results) -> None:
    definition = replace(results.definition, maps={"exponent": Lyapunov()})
    quantity = Quantity(replace(results, definition=definition), "exponent")
    for values, lowest in (([0.5, 1.0, 1.5], 0.0), ([-0.5, -0.5, 1.5], -0.5)):
        _, scale = quantity.colours(np.array(values))
        assert scale.vmin == lowest


def test_attractors_are_described_by_their_first_state_their_turns_and_their_share(
    results: Results,
) -> None:
    states = [{"theta": 0.51234, "theta_dot": -2.0}, {"theta": 9.0, "theta_dot": 9.0}]
    records = [
        {"number": 1, "kind": "period 2", "states": states, "turns": {"theta": 0}, "motions": 3},
        {"number": 2, "kind": "period 1", "states": states[1:], "turns": {"theta": -1},
         "motions": 1},
    ]  # fmt: skip
    found = replace(results, records={"low": records})
    _, _, _, first, second, *others = summary(found, None, {})
    assert first == "low 1: period 2, theta = 0.5123, theta_dot = -2; 75.0% of the motions"
    assert second == (
        "low 2: period 1, -1 turns of theta, theta = 9, theta_dot = 9; 25.0% of the motions"
    )
    assert len(others) == 4  # of the other maps
    assert not any(line.startswith("low") for line in others)


@pytest.mark.parametrize(("values", "colours", "limits"), [
    ([-1.0, 0.5, 3.0], "RdBu_r", (-3.0, 3.0)),  # zero is in the middle
    ([-4.0, 0.5, 3.0], "RdBu_r", (-4.0, 4.0)),
    ([0.5, 1.0, 3.0], "viridis", (0.5, 3.0)),
    ([-3.0, -1.0, -0.5], "viridis", (-3.0, -0.5)),
    ([0.0, 2.0], "viridis", (0.0, 2.0)),
])  # fmt: skip
def test_colours_of_values_of_both_signs_are_symmetrical(
    values: list[float], colours: str, limits: tuple[float, float], results: Results
) -> None:
    rate = Quantity(results, "end", (1,))
    found, scale = rate.colours(np.array([*values * 100, np.nan, np.inf]))
    assert found == colours
    assert (scale.vmin, scale.vmax) == pytest.approx(limits)


def test_colours_of_errors_that_are_all_zero_begin_below_rounding(results: Results) -> None:
    definition = replace(results.definition, maps={"error": EnergyError()})
    quantity = Quantity(replace(results, definition=definition), "error")
    _, scale = quantity.colours(np.zeros(4))
    assert 0 < scale.vmin < scale.vmax < np.finfo(float).eps
