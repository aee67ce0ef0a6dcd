"""Every map agrees with motions integrated one by one by other methods, or with formulas."""

import csv
import json
import pickle
from functools import partial
from itertools import product
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from matplotlib.contour import ContourSet
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import solve_ivp

import generated.double_pendulum as dp
import generated.driven_pendulum as driven
import generated.henon_heiles as hh
import generated.single_pendulum as single
from solvers.app.modules import load as load_module
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.problem.events import Event
from solvers.sweeps import sweep_panels
from solvers.sweeps.definition.axes import BLOCK, Grid, Random, Table
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.definition.sweep_reading import find, names
from solvers.sweeps.execution.pool import Pool
from solvers.sweeps.execution.sweep_run import sweep
from solvers.sweeps.maps.energy_error import EnergyError
from solvers.sweeps.maps.extremes import Extremes
from solvers.sweeps.maps.final import Final
from solvers.sweeps.maps.first import First
from solvers.sweeps.maps.lyapunov import Lyapunov
from solvers.sweeps.maps.samples import Samples
from solvers.sweeps.maps.section import Section
from solvers.sweeps.results import STATUSES, Results
from solvers.sweeps.sweep_figure import figure

PI = np.pi
FLIP = {"theta1": (-PI, PI), "theta2": (-PI, PI)}
TOPS = ({"theta1": PI}, {"theta2": PI})
STARTS = Random({"theta1": (-PI, PI), "theta2": (-PI, PI)}, 400, seed=3)


#: Reference solutions by another program and family of methods, converged.
reference = partial(solve_ivp, method="DOP853", rtol=1e-13, atol=1e-13)


def run(
    folder: Path, module: ModuleType, axes: Any, duration: float, maps: Any, **options: Any
) -> Results:
    return sweep(Sweep(module, axes, maps, duration, **options), folder)


def flip_time(start: np.ndarray, duration: float) -> float:
    """Time of the first flip of one motion, by the reference."""
    events = []
    for k, value in product((0, 1), (-PI, PI)):

        def event(
            _: float, y: np.ndarray, *_params: float, k: int = k, value: float = value
        ) -> float:
            return float(y[k] - value)

        event.terminal = True  # type: ignore[attr-defined]
        events.append(event)
    solution = reference(dp.rhs, (0, duration), start, args=(dp.DEFAULTS,), events=events)
    return min([t for times in solution.t_events for t in times], default=np.nan)


@pytest.mark.long("other tests reach its code")
def test_flip_times_equal_those_of_single_motions(tmp_path: Path) -> None:
    # over 4 s errors of 1e-9 grow to 1e-6 at most, much less than the time between flips
    results = run(tmp_path, dp, STARTS, 4.0, {"flip": First(FLIP, TOPS)}, rtol=1e-11)
    flips, starts = results.maps["flip"], STARTS.columns(0, 400)
    some = [*np.flatnonzero(np.isfinite(flips))[:40], *np.flatnonzero(np.isnan(flips))[:20]]
    for k in some:
        start = np.array([starts["theta1"][k], starts["theta2"][k], 0, 0])
        assert flip_time(start, 4.0) == pytest.approx(flips[k], abs=1e-7, nan_ok=True)
    assert not results.count.get("not done yet")


def test_the_barrier_excludes_no_flip(tmp_path: Path) -> None:
    # the potential energy of flips is at least that of one rod up, the other down
    starts = STARTS.columns(0, 400)
    m1, m2, l1, l2, g = dp.DEFAULTS
    first, second = (m1 + m2) * g * l1, m2 * g * l2
    start = -first * np.cos(starts["theta1"]) - second * np.cos(starts["theta2"])
    proved = start < min(first - second, second - first)
    with_barrier = run(tmp_path / "a", dp, STARTS, 8.0, {"flip": First(FLIP, TOPS)})
    without = run(tmp_path / "b", dp, STARTS, 8.0, {"flip": First(FLIP)})
    assert (with_barrier.status == STATUSES.index("proved")).tolist() == proved.tolist()
    assert 100 < proved.sum() < 200
    assert with_barrier.maps["flip"].tobytes() == without.maps["flip"].tobytes()


@pytest.mark.long("other tests reach its code")
def test_uniform_rods_do_not_flip_below_heyl_s_energy(tmp_path: Path) -> None:
    # J. S. Heyl (2008): below 3 cos θ1 + cos θ2 = 2, for uniform rods alike
    definition = find("bar_flips", load_module)
    axes = Grid({name: values[::8] for name, values in definition.axes.values.items()})
    results = run(tmp_path, definition.module, axes, 1.0, definition.maps, values=definition.values)
    theta1, theta2 = np.meshgrid(*axes.values.values(), indexing="ij")
    never = 3 * np.cos(theta1) + np.cos(theta2) > 2
    assert ((results.status == STATUSES.index("proved")) == never).all()


@pytest.mark.parametrize(("first", "words"), [
    (First(FLIP, ({"theta1": PI},)), "energy is lower at .*theta2 = -?3.14159; add this position"),
    (First({"theta1_dot": (5.0,)}, TOPS), "only coordinates can be watched, not theta1_dot"),
    (First(FLIP, ({"theta3": PI},)), "'theta3' .did you mean"),
])  # fmt: skip
def test_an_invalid_barrier_is_refused(first: First, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Sweep(dp, STARTS, {"flip": first}, 1.0)


def test_a_barrier_proves_nothing_where_parameters_vary() -> None:
    axes = Grid({"theta1": [0.1], "theta2": [0.1], "g": [9.81, -9.81]})
    with pytest.raises(ValueError, match="g varies and the lowest position depends on it"):
        Sweep(dp, axes, {"flip": First(FLIP, TOPS)}, 1.0)


@pytest.mark.parametrize("name", ["status", "energy"])
def test_a_system_cannot_use_reserved_words(name: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(
        f'gravity = ["0", "0"]\n[coordinates]\nx = {{}}\n[parameters]\n{name} = {{ value = 1 }}\n'
        f'[[masses]]\nmass = "{name}"\nposition = ["x", "0"]\n'
    )
    with pytest.raises(ValueError, match=f"calls a quantity '{name}'"):
        Sweep(load_module(str(path)), Grid({"x": [1.0]}), {"end": Final(("x",))}, 1.0)


def test_finals_samples_and_extremes_equal_those_of_single_motions(tmp_path: Path) -> None:
    n, of = 12, ("theta1", "theta2_dot")
    axes = Random({"theta1": (-1, 1), "theta2": (-1, 1), "m2": (0.5, 2)}, n, seed=1)
    maps = {"end": Final(of), "path": Samples(of, 7), "reach": Extremes(("theta1", "theta2"))}
    maps |= {"drift": EnergyError(), "crossing": First({"theta1": (0.0,)})}
    results = run(tmp_path, dp, axes, 3.0, maps, rtol=1e-11)
    times = np.linspace(0, 3, 3001)
    for k in range(n):
        params = [*dp.DEFAULTS]
        params[dp.PARAMETERS.index("m2")] = results.axes["m2"][k]
        start = (results.axes["theta1"][k], results.axes["theta2"][k], 0, 0)
        y = reference(dp.rhs, (0, 3), start, t_eval=times, args=(params,)).y
        assert_allclose(results.maps["end"][k], y[[0, 3], -1], atol=1e-8)
        assert_allclose(results.maps["path"][k], y[[0, 3]][:, ::500], atol=1e-8)
        # sampled every ms, a parabola's top is missed by (0.5 ms)² times some 10 rad/s²
        assert_allclose(results.maps["reach"][k], np.c_[y[:2].min(1), y[:2].max(1)], atol=5e-6)
        assert (results.maps["reach"][k, :, 0] <= y[:2].min(1) + 1e-9).all()
        assert (results.maps["reach"][k, :, 1] >= y[:2].max(1) - 1e-9).all()
        crossing = np.flatnonzero(np.diff(np.sign(y[0])))[0]
        assert times[crossing] <= results.maps["crossing"][k] <= times[crossing + 1]
    assert 0 < np.abs(results.maps["drift"]).max() < 1e-9


def test_the_extremes_of_a_swing_are_its_initial_angle(tmp_path: Path) -> None:
    axes = Grid({"theta": np.linspace(0.1, 3.1, 20)})
    reach = run(tmp_path, single, axes, 30.0, {"reach": Extremes(("theta",))}).maps["reach"]
    assert Extremes(("theta",)).labels[1] == ("smallest", "largest")
    assert (reach[..., 0] < reach[..., 1]).all()
    assert_allclose(reach[:, 0, 1], axes.values["theta"], rtol=1e-8)
    assert_allclose(reach[:, 0, 0], -axes.values["theta"], rtol=1e-7)


def test_the_lyapunov_exponent_of_an_upright_rod_follows_the_linear_solution(
    tmp_path: Path,
) -> None:
    # δ(t) = δ₀ cosh ωt + δ̇₀ sinh ωt / ω about an upright rod, ω² = g/l
    t, axes = 5.0, Table({"theta": [PI], "l": [0.7]})
    results = run(tmp_path, single, axes, t, {"exponent": Lyapunov()}).maps["exponent"]
    omega = np.sqrt(single.DEFAULTS[single.PARAMETERS.index("g")] / 0.7)
    change = [
        np.cosh(omega * t) + np.sinh(omega * t) / omega,
        omega * np.sinh(omega * t) + np.cosh(omega * t),
    ]
    assert results[0] == pytest.approx(np.log(np.linalg.norm(change) / np.sqrt(2)) / t, rel=1e-7)


def test_the_lyapunov_exponent_equals_the_divergence_of_neighbours(tmp_path: Path) -> None:
    t, axes = 5.0, Random({"theta1": (-2, 2), "theta2": (-2, 2)}, 6, seed=8)
    results = run(tmp_path, dp, axes, t, {"exponent": Lyapunov()})
    for k, exponent in enumerate(results.maps["exponent"]):
        start = np.array([results.axes["theta1"][k], results.axes["theta2"][k], 0, 0])
        ends = [
            reference(dp.rhs, (0, t), start + change, args=(dp.DEFAULTS,)).y[:, -1]
            for change in (-0.5e-6, 0.5e-6)
        ]
        apart = np.linalg.norm(ends[1] - ends[0]) / 2e-6
        assert exponent == pytest.approx(np.log(apart) / t, abs=1e-4)


def test_perturbations_grow_beyond_the_range_of_floats(tmp_path: Path) -> None:
    # at rest on a saddle, x = 0, y = 1, where V'' is -1 along y and 3 along x: of δ₀ = (½, ½, ½, ½)
    # the part along y becomes ½ (1, 1) e^t, the other part oscillates
    start = [[x] for x in (0, 1, 0, 0, *[0.5] * 4)]
    for backend, t in (("python", 100.0), ("compiled", 100.0), ("compiled", 2000.0)):
        options = {"form": "variational", "backend": backend, "t_eval": [50.0]}
        one = ensemble(hh, (0, t), start, (), events=Event(hh, "y", 2.0), **options)
        assert one.growth[0] == pytest.approx(t - np.log(2) / 2, abs=1e-6)
        assert np.log(one.samples[5, 0, 0] * 2) == pytest.approx(50, abs=1e-6)
    results = run(tmp_path, hh, Grid({"y": [1.0]}), t, {"exponent": Lyapunov()}, values={"x": 0.0})
    assert results.count == {"finished": 1}
    assert results.maps["exponent"][0] * t == pytest.approx(t - np.log(2) / 2, abs=1e-6)


def test_henon_heiles_motions_are_regular_at_low_and_chaotic_at_high_energy(tmp_path: Path) -> None:
    # M. Hénon, C. Heiles (1964), figure 7: curves fill the section at 1/12, and almost
    # none of it at 1/6. In regular motion changes grow in proportion to time: exponent ln t/t.
    y, y_dot = np.linspace(-0.3, 0.45, 30), np.linspace(-0.3, 0.3, 9)
    axes = Grid({"energy": [1 / 12, 1 / 6], "y": y, "y_dot": y_dot})
    values = {"x": 0.0, "x_dot": "energy"}
    results = run(tmp_path, hh, axes, 600.0, {"exponent": Lyapunov()}, values=values)
    chaotic = [
        np.mean(e[np.isfinite(e)] > 2.5 * np.log(600) / 600) for e in results.maps["exponent"]
    ]
    assert chaotic[0] < 0.02
    assert chaotic[1] > 0.85


def test_a_velocity_follows_from_the_energy_or_has_no_solution(tmp_path: Path) -> None:
    axes = Random({"energy": (-30.0, 10.0), "theta2": (-3, 3), "theta2_dot": (-3, 3)}, 50, seed=2)
    values = {"theta1": 0.3, "theta1_dot": "energy"}
    results = run(tmp_path, dp, axes, 1e-9, {"start": Final(dp.STATE)}, values=values)
    can = np.isfinite(results.maps["start"]).all(axis=1)
    assert 10 < can.sum() < 50
    assert (results.status[~can] == STATUSES.index("no such energy")).all()
    energy = dp.energy_many(0.0, results.maps["start"][can].T, dp.DEFAULTS)
    assert_allclose(energy, results.axes["energy"][can], atol=1e-6)
    assert (results.maps["start"][can, 2] >= 0).all()
    # without a solution, every velocity has a larger energy
    for k in np.flatnonzero(~can):
        start = np.array([0.3, results.axes["theta2"][k], 0, results.axes["theta2_dot"][k]])
        rates = np.linspace(0, 20, 2001)
        there = dp.energy_many(0.0, [start[0] + 0 * rates, start[1], rates, start[3]], dp.DEFAULTS)
        assert there.min() > results.axes["energy"][k]


def test_a_section_equals_the_crossings_of_single_motions(tmp_path: Path) -> None:
    axes = Grid({"y": [0.1, 0.25], "y_dot": [0.0, 0.1]})
    section = {"section": Section(("y", "y_dot"), 15, "x", 0.0, 1)}
    values = {"x": 0.0, "x_dot": "energy", "energy": 0.1}
    results = run(tmp_path, hh, axes, 60.0, section, values=values)
    for a, b in np.ndindex(2, 2):
        y, rate = axes.values["y"][a], axes.values["y_dot"][b]
        start = (0, y, np.sqrt(0.2 - rate**2 - y**2 + 2 * y**3 / 3), rate)

        def event(_: float, state: np.ndarray, _params: tuple[()]) -> float:
            return float(state[0])

        event.direction = 1  # type: ignore[attr-defined]
        options = {"rtol": 1e-12, "atol": 1e-12, "args": ((),), "events": event}
        one = reference(hh.rhs, (0, 60), start, **options).y_events[0]
        passes = one[np.abs(one[:, 1] - y) + np.abs(one[:, 3] - rate) > 1e-9]  # not the start
        n = min(len(passes), 15)
        assert n > 5
        assert_allclose(results.maps["section"][a, b, :, :n], passes[:n, [1, 3]].T, atol=1e-6)


def test_a_section_without_a_direction_has_crossings_upwards(tmp_path: Path) -> None:
    axes, values = Grid({"y": [0.1]}), {"x": 0.0, "x_dot": "energy", "energy": 0.1}
    both, up, down, default = (
        run(tmp_path / name, hh, axes, 30.0, {"s": Section(("y",), 12, "x", **way)}, values=values)
        for name, way in (
            ("both", {"direction": 0}),
            ("up", {"direction": 1}),
            ("down", {"direction": -1}),
            ("default", {}),
        )
    )
    assert_allclose(default.maps["s"], up.maps["s"], rtol=0, atol=0)
    count = [np.isfinite(one.maps["s"]).sum() for one in (both, up, down)]
    assert count[0] == count[1] + count[2]
    assert min(count[1:]) >= 3
    # one component is plotted over the number of the point, not over itself
    (panel,) = figure(up).axes
    (points,) = panel.lines
    assert points.get_xdata().tolist() == list(range(1, 13))
    assert_array_equal(points.get_ydata(), up.maps["s"][0, 0])
    assert panel.get_xlabel() == "number of the point"


@pytest.mark.parametrize(("axes", "titles"), [
    (Table({"energy": [0.08, 0.1]}), ["$E$ = 0.08 J", "$E$ = 0.1 J"]),
    (Table({"energy": [0.08, 0.1], "y": [0.1, 0.2]}), [""]),
    (Table({"y": [0.1, 0.2]}), [""]),
])  # fmt: skip
def test_a_section_of_listed_energies_has_a_panel_for_each(
    axes: Table, titles: list[str], tmp_path: Path
) -> None:
    values = {"x": 0.0, "x_dot": "energy", "y": 0.1, "energy": 0.1}
    values = {name: value for name, value in values.items() if name not in axes.values}
    section = {"s": Section(("y", "y_dot"), 3, "x", direction=1)}
    shown = figure(run(tmp_path, hh, axes, 30.0, section, values=values))
    assert [panel.get_title() for panel in shown.axes if panel.axison] == titles


def test_the_boundary_of_an_image_is_that_of_the_middle_of_other_axes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sweep_panels, "BOUNDARY", 60)
    angles = np.linspace(-3, 3, 5)
    axes = Grid({"theta1": angles, "theta2": angles, "theta1_dot": [0.0, 1.0, 3.0]})
    results = run(tmp_path, dp, axes, 0.1, {"flip": First(FLIP, TOPS)})
    (lines,) = [c for c in figure(results).axes[0].collections if isinstance(c, ContourSet)]
    theta1, theta2 = np.vstack([path.vertices for path in lines.get_paths()]).T
    # m = 1 kg and l = 2 m: at the lower barrier the upper rod hangs, and the other one stands
    weight, kinetic = 2 * 9.81, 2 * 2.0**2 / 2
    energy = kinetic - weight * (2 * np.cos(theta1) + np.cos(theta2))
    assert_allclose(energy, -weight, atol=0.1)


def test_coordinates_of_a_table_are_all_of_its_values() -> None:
    table = {"theta1": [0.1, 0.2, 0.3], "theta2": [3.0, 2.0, 1.0]}
    found = Table(table).coordinates()
    assert {name: values.tolist() for name, values in found.items()} == table


def test_any_span_of_random_axes_is_generated_by_itself() -> None:
    axes = Random({"theta1": (-1, 2), "l1": (3, 4)}, 3 * BLOCK, seed=5)
    whole = axes.columns(0, 3 * BLOCK)
    for begin, end in ((0, 1), (7, BLOCK), (BLOCK - 1, BLOCK + 1), (BLOCK, 2 * BLOCK), (50, 9000)):
        part = axes.columns(begin, end)
        assert all((part[name] == whole[name][begin:end]).all() for name in whole)
    assert_allclose([whole["theta1"].mean(), whole["l1"].mean()], [0.5, 3.5], atol=0.03)
    other = Random({"theta1": (-1, 2), "l1": (3, 4)}, 10, seed=6).columns(0, 10)
    assert (other["l1"] != whole["l1"][:10]).all()


def test_a_motion_that_fails_has_a_status_and_no_values(tmp_path: Path) -> None:
    axes = Grid({"theta1": [0.1, 3.0], "theta2": [0.1, 3.0]})
    results = run(tmp_path, dp, axes, 10.0, {"end": Final(("theta1",))}, max_steps=200)
    assert results.count == {"finished": 1, "step limit": 3}
    assert np.isnan(results.maps["end"]).ravel().tolist() == [False, True, True, True]


def test_a_module_that_does_not_ship_travels_as_text(tmp_path: Path) -> None:
    module = load_module("chain_4")
    names = [f"theta{k}" for k in range(1, 5)]
    axes = Random(dict.fromkeys(names, (-1, 1)), 5, seed=0)
    definition = pickle.loads(pickle.dumps(Sweep(module, axes, {"end": Final(("theta4",))}, 1.0)))
    assert definition.module is not module
    results = sweep(definition, tmp_path)
    for k in range(5):
        start = [*(results.axes[name][k] for name in names), 0, 0, 0, 0]
        one = integrate(module, (0, 1), start, module.DEFAULTS, backend="python", rtol=1e-10)
        assert results.maps["end"][k, 0] == pytest.approx(one.y[3, -1], abs=1e-7)


@pytest.mark.parametrize(("changes", "words"), [
    ({"maps": {}}, "no maps"),
    ({"maps": {"status": Lyapunov()}}, "'status' cannot be a map's name"),
    ({"maps": {"Status": Lyapunov()}}, "'Status' cannot be a map's name"),
    ({"maps": {"a": Final(("theta1",)), "A": Lyapunov()}}, "nor the name of another map"),
    ({"maps": {"l1": Lyapunov()}, "axes": Grid({"theta1": [1], "theta2": [1], "l1": [1]})},
     "cannot be a map's name"),
    ({"maps": {"a": Samples(("theta1",), 5), "b": Samples(("theta1",), 6)}}, "the same number"),
    ({"maps": {"a": Final(())}}, "map a: `of` is empty; name some of theta1"),
    ({"maps": {"a": Final(("theta",))}}, "'theta' .did you mean 'theta"),
    ({"axes": Grid({"theta1": [1.0]})}, "theta2 is missing"),
    ({"axes": Grid({"thet1": [1.0]})}, "'thet1' .did you mean 'theta1'"),
    ({"values": {"theta1": 1.0}}, "theta1 varies and has the value 1.0"),
    ({"values": {"l1": -1.0}}, "l1 = -1.0 must be positive"),
    ({"axes": Grid({"theta1": [1], "theta2": [1], "l1": [1, 0]})}, "l1 = 0.0 must be positive"),
    ({"values": {"theta1_dot": np.inf}}, "theta1_dot = inf must be a finite real number"),
    ({"values": {"theta1_dot": "energy"}}, "an energy requires a velocity"),
    ({"values": {"energy": 1.0}}, "an energy requires a velocity"),
    ({"values": {"energy": 1.0, "l1": "energy"}}, "determines one velocity"),
    ({"values": {"energy": 1.0, "theta1_dot": "energy", "theta2_dot": "energy"}},
     "determines one velocity, one of theta1_dot, theta2_dot"),
    ({"duration": -1.0}, "duration = -1.0 must be positive"),
    ({"method": "rk5"}, "no method is called 'rk5'"),
    ({"method": "DOP853"}, "no method is called 'DOP853'"),
    ({"method": "gauss2"}, "does not estimate its error: use one of"),
    ({"rtol": 0.0, "atol": 0.0}, "no step is short enough"),
])  # fmt: skip
def test_an_invalid_sweep_is_refused(changes: dict[str, Any], words: str) -> None:
    valid = {"axes": STARTS, "maps": {"exponent": Lyapunov()}, "duration": 1.0}
    with pytest.raises(ValueError, match=words):
        Sweep(dp, **(valid | changes))


def test_names_of_maps_and_numbers_of_motions_have_limits() -> None:
    at_most = {"a" * 50: Lyapunov()}
    assert Sweep(dp, STARTS, at_most, 1.0).maps == at_most
    with pytest.raises(ValueError, match="cannot be a map's name: use up to 50 letters"):
        Sweep(dp, STARTS, {"a" * 51: Lyapunov()}, 1.0)
    with pytest.raises(ValueError, match="the number of motions = 27000000000000000 must be"):
        Grid(dict.fromkeys(("theta1", "theta2", "m2"), np.linspace(0, 1, 300_000)))


def test_energy_errors_need_a_conserved_energy() -> None:
    axes = Grid({name: [0.1] for name in driven.COORDINATES})
    with pytest.raises(ValueError, match="does not conserve its energy"):
        Sweep(driven, axes, {"drift": EnergyError()}, 1.0)
    with pytest.raises(ValueError, match="workers"):
        Pool(workers=0)


@pytest.mark.parametrize(("axes", "words"), [
    (lambda: Grid({}), "nothing varies"),
    (lambda: Grid({"theta1": []}), "finite numbers, at least one"),
    (lambda: Grid({"theta1": [1, np.nan]}), r"theta1\[1\] = nan must be a finite real number"),
    (lambda: Table({"theta1": [1, 2], "theta2": [1]}), "different lengths"),
    (lambda: Random({"theta1": (0, 1)}, 0, 1), "count = 0 must be from 1"),
    (lambda: Random({"theta1": (0, 1)}, 5, -1), "seed = -1 must be from 0"),
])  # fmt: skip
def test_axes_without_values_are_refused(axes: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        axes()


def test_all_maps_form_one_dataset_with_names_and_units(tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    axes = Grid({"theta1": [0.1, 0.2, 0.3], "l1": [1.0, 2.0]})
    maps = {"end": Final(("theta1", "theta2_dot")), "reach": Extremes(("theta1",))}
    maps["flip"] = First(FLIP)
    results = run(tmp_path / "a", dp, axes, 1.0, maps, values={"theta2": 0.0})
    results.dataset().to_zarr(tmp_path / "maps.zarr", consolidated=False)
    whole = xarray.open_zarr(tmp_path / "maps.zarr", consolidated=False)
    inner = {"end_component": 2, "reach_component": 1, "reach_extreme": 2}
    assert dict(whole.sizes) == {"theta1": 3, "l1": 2, **inner}
    assert json.loads(whole.definition)["duration"] == 1.0
    assert (whole.theta1.units, whole.l1.units, whole.flip.units) == ("rad", "m", "s")
    assert whole.end_component.values.tolist() == ["theta1", "theta2_dot"]
    chosen = whole.end.sel(theta1=0.2, l1=2.0, end_component="theta1")
    assert float(chosen) == results.maps["end"][1, 1, 0]
    rows = run(tmp_path / "b", dp, STARTS, 0.1, {"end": Final(("theta1",))}).dataset()
    assert rows.theta1.dims == ("motion",)
    assert rows.end.shape == (400, 1)


@pytest.mark.parametrize("name", names())
def test_shipped_sweeps_run_and_their_files_are_plain_numpy(name: str, tmp_path: Path) -> None:
    definition = find(name, load_module)
    few = Grid(
        {key: values[:: max(1, len(values) // 4)] for key, values in definition.axes.values.items()}
    )
    duration, values = definition.duration and min(definition.duration, 20), definition.values
    results = run(tmp_path, definition.module, few, duration, definition.maps, values=values)
    for path in tmp_path.glob("*.npy"):
        np.load(path, allow_pickle=False)
    assert set(results.count) <= {"finished", "event", "proved", "no such energy"}
    for key, one in definition.maps.items():
        assert results.maps[key].shape == (*few.shape, *one.shape)


def test_axes_may_be_a_csv_file(tmp_path: Path) -> None:
    with open(tmp_path / "starts.csv", "w", newline="") as file:
        csv.writer(file).writerows([["theta1", "theta2"], ["90 deg", "pi/2"], [0.1, -0.2]])
    (tmp_path / "mine.toml").write_text(
        'system = "double_pendulum"\nduration = 1\naxes = "starts.csv"\n'
        '[maps.end]\nkind = "final"\nof = ["theta1"]\n'
    )
    definition = find(str(tmp_path / "mine.toml"), load_module)
    assert isinstance(definition.axes, Table)
    assert_allclose(definition.axes.values["theta1"], [PI / 2, 0.1])
    assert_allclose(definition.axes.values["theta2"], [PI / 2, -0.2])
