"""Basins of attraction agree with arguments of energy and with SciPy."""

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex
from scipy.integrate import solve_ivp

import generated.driven_pendulum as driven
import generated.duffing as duffing
from solvers import Basins, Grid, Pool, Sweep, partial_results, sweep
from solvers.app.modules import load as load_module
from solvers.sweeps.execution import worker
from solvers.sweeps.maps.basins import Attractor, classify
from solvers.sweeps.plot_quantity import Quantity
from solvers.sweeps.sweep_figure import figure
from solvers.sweeps.sweep_summary import summary

WELLS = """
potential = "x**4/4 - x**2/2"
dissipation = "c*x_dot**2/2"
[coordinates]
x = { unit = "m" }
[parameters]
c = { value = 0.2, unit = "N s/m" }
[[masses]]
mass = 1
position = ["x", "0"]
"""


@pytest.mark.long("other tests reach its code")
def test_motions_with_less_energy_than_the_barrier_stay_in_their_well(tmp_path: Path) -> None:
    axis = np.linspace(-1.9, 1.9, 16)
    values = {"k": -1.0, "beta": 1.0, "F": 0.0, "c": 0.2}
    definition = Sweep(duffing, Grid({"x": axis, "x_dot": axis}), {"b": Basins(2.0, 60)},
                       values=values)  # fmt: skip
    results = sweep(definition, tmp_path)
    numbers = results.maps["b"]
    states = [record["states"][0]["x"] for record in results.records["b"]]
    assert np.round(sorted(states), 6).tolist() == [-1.0, 1.0]
    x, v = np.meshgrid(axis, axis, indexing="ij")
    ends = np.array([np.nan, *states])[numbers.astype(int)]
    below = v**2 / 2 - x**2 / 2 + x**4 / 4 < 0
    assert below.sum() > 20
    assert (np.sign(ends) == np.sign(x))[below].all()
    above = np.argwhere(~below)[::15]
    for i, k in above:
        params = (1.0, -1.0, 1.0, 0.2, 0.0, 1.0)
        end = solve_ivp(duffing.rhs, (0, 120), (axis[i], axis[k]), "DOP853",
                        rtol=1e-10, atol=1e-10, args=(params,)).y[0, -1]  # fmt: skip
        assert ends[i, k] == pytest.approx(end, abs=1e-3)


@pytest.mark.long("other tests reach its code")
def test_rotations_and_swings_of_a_driven_pendulum_are_those_of_scipy(tmp_path: Path) -> None:
    values = {"Omega": 2.0, "c": 0.3, "g": 1.0, "a": 0.45}
    axes = Grid({"theta": np.linspace(-3, 3, 8), "theta_dot": np.linspace(-3, 3, 6)})
    definition = Sweep(driven, axes, {"b": Basins("2*pi/Omega", 80)}, values=values)
    results = sweep(definition, tmp_path)
    records = results.records["b"]
    assert sorted(record["turns"]["theta"] for record in records) == [-1, 1]
    assert {record["kind"] for record in records} == {"period 1"}
    assert sum(record["motions"] for record in records) == (results.maps["b"] > 0).sum()
    params = tuple({**dict(zip(driven.PARAMETERS, driven.DEFAULTS, strict=True)), **values}.get(p)
                   for p in driven.PARAMETERS)  # fmt: skip
    for i, k in [(0, 0), (3, 5), (5, 2), (7, 3)]:
        start = axes.values["theta"][i], axes.values["theta_dot"][k]
        end = solve_ivp(driven.rhs, (0, 80 * np.pi), start, "DOP853", rtol=1e-10, atol=1e-10,
                        args=(params,)).y[1, -1]  # fmt: skip
        record = records[int(results.maps["b"][i, k]) - 1]
        assert record["states"][0]["theta_dot"] == pytest.approx(end, abs=1e-3)


@pytest.mark.long("other tests reach its code")
def test_rest_of_a_system_without_a_drive_is_an_equilibrium(tmp_path: Path) -> None:
    (tmp_path / "wells.toml").write_text(WELLS)
    module = load_module(str(tmp_path / "wells.toml"))
    # at the top of the barrier a motion stays, too
    axes = Grid({"x": [-1.5, -0.5, 0.0, 0.3, 0.7, 0.8]})
    definition = Sweep(module, axes, {"b": Basins(3.0, 60)})
    results = sweep(definition, tmp_path / "out")
    assert [(r["kind"], r["motions"]) for r in results.records["b"]] == [
        ("equilibrium", 3), ("equilibrium", 2), ("equilibrium", 1)
    ]  # fmt: skip
    lines = [*summary(results, None, {})]
    assert lines[-3].startswith("b 1: equilibrium, x = 1, x_dot = ")
    assert lines[-3].endswith("; 50.0% of the motions")


@pytest.fixture
def basins() -> Sweep:
    axes = Grid({"x": np.linspace(-2, 2, 12), "x_dot": np.linspace(-1, 1, 12)})
    values = {"k": -1.0, "c": 0.25, "F": 0.25}
    return Sweep(duffing, axes, {"b": Basins("2*pi/Omega", 30)}, values=values)


@pytest.mark.long("other tests reach its code")
def test_basins_resume_to_the_same_bits(
    basins: Sweep, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker, "COST", 1e-7)
    files = ("b.npy", "b_attractors.json")
    sweep(basins, tmp_path / "a", pool=Pool(workers=2))
    expected = [(tmp_path / "a" / name).read_bytes() for name in files]
    chunks = sorted((tmp_path / "a" / "chunks").glob("*.npy"))
    assert len(chunks) > 3
    for chunk in chunks[1::2]:
        chunk.unlink()
    partial = partial_results(basins, tmp_path / "a")
    assert np.isnan(partial.maps["b"]).sum() == partial.count["not done yet"] > 0
    sweep(basins, tmp_path / "a", pool=Pool(workers=1))
    assert [(tmp_path / "a" / name).read_bytes() for name in files] == expected


def test_attractors_have_colours_and_a_legend(basins: Sweep, tmp_path: Path) -> None:
    results = sweep(basins, tmp_path)
    (panel,) = figure(results).axes
    labels = [text.get_text().partition(",")[0] for text in panel.get_legend().get_texts()]
    assert labels[-2:] == ["1: period 1", "2: period 1"]
    states = [record["states"][0] for record in results.records["b"]]
    drawn = [line.get_xydata()[0].tolist() for line in panel.lines if line.get_marker() == "o"]
    assert drawn == [[state["x"], state["x_dot"]] for state in states]
    assert json.loads((tmp_path / "b_attractors.json").read_text()) == results.records["b"]


def test_each_attractor_has_the_colour_of_the_legend(basins: Sweep, tmp_path: Path) -> None:
    quantity = Quantity(sweep(basins, tmp_path), "b", ())
    palette, scale = quantity.colours(quantity.values())
    assert len(quantity.classes) > 2
    for number, (colour, _) in enumerate(quantity.classes):
        assert to_hex(palette(scale(number))) == colour.lower()


def found(states: np.ndarray, tolerance: float = 1e-3) -> tuple[list[float], list[Attractor]]:
    """Numbers and attractors of states of the driven pendulum, of shape (motions, 2, count)."""
    numbers, attractors = classify(driven, states, tolerance)
    return numbers.tolist(), attractors


def repeated(*orbit: tuple[float, float], shift: int = 0) -> np.ndarray:
    return np.array([orbit[(k + shift) % len(orbit)] for k in range(12)]).T


def test_equal_orbits_from_another_phase_are_one_attractor() -> None:
    two = [repeated((0.1, 1.0), (0.4, 2.0), shift=k) for k in (0, 1, 1)]
    three = repeated((0.1, 1.0), (0.4, 2.0), (0.4, 1.0))
    numbers, attractors = found(np.array([three, *two]))
    assert numbers == [2, 1, 1, 1]
    assert [(one.period, one.motions) for one in attractors] == [(2, 3), (3, 1)]


def test_the_tolerance_decides_which_states_are_the_same() -> None:
    near, far = repeated((0.1 + 0.9e-3, 1.0)), repeated((0.1 + 1.1e-3, 1.0))
    here = repeated((0.1, 1.0))
    assert found(np.array([here, near]))[0] == [1, 1]
    assert found(np.array([here, far]))[0] == [1, 2]
    assert found(np.array([here, far]), 2e-3)[0] == [1, 1]


def test_angles_count_modulo_whole_turns() -> None:
    rotation = np.array([0.1 + 2 * np.pi * np.arange(12), np.ones(12)])
    other = rotation - [[4 * np.pi], [0.0]]
    numbers, (one,) = found(np.array([rotation, other]))
    assert numbers == [1, 1]
    assert (one.turns, one.period) == ((1,), 1)
    assert np.abs(one.states - [[0.1, 1.0]]).max() < 1e-12


def test_a_spiral_that_has_nearly_arrived_is_no_longer_orbit() -> None:
    # after three periods it returns to within a tenth of the tolerance, after one not
    t = np.arange(12)
    spiral = 3e-4 * 0.9995**t * np.array([np.cos(2 * np.pi * t / 3), np.sin(2 * np.pi * t / 3)])
    numbers, attractors = found(np.array([spiral, np.zeros((2, 12)), 10 * spiral]))
    assert numbers == [1, 1, 2]
    assert [one.period for one in attractors] == [1, 3]


def test_a_motion_that_still_moves_by_less_than_the_tolerance_has_not_arrived() -> None:
    moving = np.array([0.5e-3 * np.arange(12), np.zeros(12)])
    assert found(np.array([moving]))[0] == [0]
    assert found(np.array([moving / 10]))[0] == [1]


def test_motions_that_do_not_recur_or_failed_have_no_attractor() -> None:
    chaos = np.random.default_rng(0).random((2, 12))
    numbers, attractors = found(np.array([chaos, np.full((2, 12), np.nan)]))
    assert numbers[0] == 0
    assert np.isnan(numbers[1])
    assert attractors == []


@pytest.mark.parametrize(("basin", "words"), [
    (Basins("2*pi/Omega", 5, count=1), "count = 1 must be 2 or more"),
    (Basins("2*pi/Omega", 5, tolerance=0.0), "tolerance = 0.0 must be positive"),
    (Basins("Omega", 5), "is not a time in s"),
])  # fmt: skip
def test_invalid_basins_are_refused(basin: Basins, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Sweep(duffing, Grid({"x": [0.0]}), {"b": basin})


def test_no_periods_are_skipped_unless_requested() -> None:
    assert Basins("2*pi/Omega").sampling.skip == 0
    assert Basins("2*pi/Omega", 30).sampling.skip == 30
