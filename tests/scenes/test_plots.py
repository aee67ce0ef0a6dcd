"""Plots show the numbers of their results, where they belong, and say what they are."""

from dataclasses import replace
from math import erf, inf, sqrt
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from figure_descriptions import described
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PathCollection
from matplotlib.colors import LogNorm, to_rgba
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from recording import Record

import generated.double_pendulum as dp
import generated.driven_pendulum as driven
import generated.henon_heiles as hh
import generated.single_pendulum as sp
from solvers.app.modules import load as load_module
from solvers.equations.energy import EnergyUnit
from solvers.io.figures import panels
from solvers.player import motion_plots as scene_plots
from solvers.player.sampled_motion import mass_positions, projected
from solvers.runge_kutta.method_catalogue import load
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.scenes.fitting import fit_plots
from solvers.scenes.scene import Scene
from solvers.scenes.scene_output import together
from solvers.scenes.scene_reading import find
from solvers.scenes.scene_run import SceneResult, run_scene
from solvers.studies.stability import CriticalStep, boundaries, regions
from solvers.studies.work_precision import work_precision_plots as chart_plots
from solvers.studies.work_precision.cost_curve import CostCurve, MeasuredRun
from solvers.sweeps.definition.axes import Grid, Random
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.sweep_run import sweep
from solvers.sweeps.maps.energy_error import EnergyError
from solvers.sweeps.maps.extremes import Extremes
from solvers.sweeps.maps.final import Final
from solvers.sweeps.maps.first import First
from solvers.sweeps.maps.samples import Samples
from solvers.sweeps.maps.section import Section
from solvers.sweeps.plot_quantity import add_colour_bar, wrapped
from solvers.sweeps.sweep_figure import figure
from solvers.sweeps.sweep_panels import CURVES, MARKED

PI = np.pi


def panels_of(chart: Figure) -> list[Axes]:
    """Panels without colour bars."""
    return [panel for panel in chart.axes if panel.axison and panel.get_label() != "<colorbar>"]


def one_panel(chart: Figure) -> Axes:
    (panel,) = panels_of(chart)
    return panel


def points(line: Any) -> np.ndarray:
    return np.column_stack(line.get_data())


def report(*pictures: str, **changes: Any) -> SceneResult:
    scene = replace(find("report", load_module), pictures=pictures, accuracy=1e-6, **changes)
    return run_scene(scene)


def test_paths_end_in_markers_of_their_colour_joined_by_rods() -> None:
    result = report("path")
    panel = one_panel(scene_plots.figure(together([result])))
    paths = projected(mass_positions(result.sampled_motions()[0]))
    lines = {"None": [], "o": [], "+": []}
    for line in panel.lines:
        lines[str(line.get_marker())].append(line)
    rods = [line for line in lines["None"] if len(line.get_xdata()) == 2]
    drawn = [line for line in lines["None"] if line not in rods]
    assert [line.get_color() for line in drawn] == [line.get_color() for line in lines["o"]]
    assert len({line.get_color() for line in drawn}) == 2
    for path, line, end in zip(paths, drawn, lines["o"], strict=True):
        assert np.array_equal(points(line), path.T)
        assert np.array_equal(points(end), path.T[-1:])
    ends = paths[:, :, -1]
    expected = [[[0, 0], ends[0]], [ends[0], ends[1]]]
    assert np.array_equal([points(rod) for rod in rods], expected)
    assert [points(pivot).tolist() for pivot in lines["+"]] == [[[0, 0]]]
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("x / m", "y / m")
    assert panel.get_aspect() == 1


def test_a_pivot_that_moves_is_not_drawn_at_rest() -> None:
    scene = Scene(driven, driven.DEFAULTS, (1.0, 0.0), 1.0, accuracy=1e-6, pictures=("path",))
    panel = one_panel(scene_plots.figure(together([run_scene(scene)])))
    assert "+" not in {line.get_marker() for line in panel.lines}


def test_coordinates_and_the_energy_error_are_drawn_over_the_whole_time() -> None:
    result = report("theta1_dot over t", "energy", "theta2 over theta1")
    rate, energy, angles = panels_of(scene_plots.figure(together([result])))
    assert np.array_equal(points(rate.lines[0]), np.column_stack([result.t, result.y[2]]))
    assert rate.get_xlim() == (0, 5)
    assert np.array_equal(points(angles.lines[0]), result.y[:2].T)
    (curve,) = energy.lines
    assert energy.get_yscale() == "log"
    energies = dp.energy_many(0.0, result.y, dp.DEFAULTS)
    above_rest = energies[0] - dp.energy(0.0, (0, 0, 0, 0), dp.DEFAULTS)
    errors = np.maximum(np.abs(energies - energies[0]) / above_rest, scene_plots.LEAST)
    assert np.allclose(points(curve), np.column_stack([result.t, errors]), rtol=1e-9, atol=1e-16)
    assert energy.get_ylabel() == "energy error / energy above rest"
    assert curve.get_linewidth() < rate.lines[0].get_linewidth()  # it is not smooth


def test_runs_side_by_side_differ_in_style_and_are_named() -> None:
    main = report("theta1, theta2 over t", label="first $1")
    other = report("theta1, theta2 over t", method="rk4", step=0.01, label="second")
    chart = scene_plots.figure(together([main, other]))
    panel = one_panel(chart)
    assert len({(line.get_color(), line.get_linestyle()) for line in panel.lines}) == 4
    assert len({line.get_color() for line in panel.lines}) == 4
    words = [text.get_text() for text in chart.legends[0].get_texts()]
    theta1, theta2 = (rf"$\theta_{{{k}}}$" for k in (1, 2))
    assert words[:2] == [rf"{theta1}, first \$1", rf"{theta2}, first \$1"]
    assert words[2:] == [f"{theta1}, second", f"{theta2}, second"]


def test_a_scene_s_figure_grows_with_its_panels_and_its_note() -> None:
    def size(count: int, note: str = "") -> tuple[float, float]:
        pictures = ["theta1 over t"] * count
        chart = scene_plots.figure(together([report(*pictures, note=note)]))
        assert len(panels_of(chart)) == count
        return tuple(chart.get_size_inches())

    one, three, four, seven = map(size, (1, 3, 4, 7))
    assert three[0] > 1.5 * one[0]
    assert seven[0] > 1.2 * four[0] == 1.2 * three[0]  # four in a row instead of three
    assert seven[1] == four[1] > 1.5 * three[1]
    assert size(1, "a word or two " * 60)[1] > one[1] + 1


def drawn(folder: Path, axes: Any, maps: Any, duration: float = 1.0, **options: Any) -> Any:
    module = options.pop("module", sp)
    results = sweep(Sweep(module, axes, maps, duration, **options), folder)
    return results, figure(results)


def test_one_quantity_that_varies_is_a_line_with_markers_where_there_are_few(
    tmp_path: Path,
) -> None:
    few, many = np.linspace(0.1, 1.0, MARKED), np.linspace(0.1, 1.0, MARKED + 1)
    for angles, marker in ((few, "."), (many, "None")):
        axes = Grid({"theta": angles})
        results, chart = drawn(tmp_path / marker, axes, {"end": Final(("theta_dot",))})
        (line,) = one_panel(chart).lines
        assert np.array_equal(points(line), np.c_[angles, results.maps["end"][:, 0]])
        assert (line.get_marker(), line.get_linestyle()) == (marker, "-")
    panel = one_panel(chart)
    assert (panel.get_xlabel(), panel.get_ylabel()) == (
        r"$\theta$ / rad",
        r"$\dot{\theta}$ / (rad/s)",
    )
    assert panel.get_title() == ""  # one panel needs no name
    # random values are not joined; where some are unknown, the others are marked
    random = Random({"theta": (0.1, 1.0)}, MARKED + 1, seed=0)
    _, chart = drawn(tmp_path / "random", random, {"end": Final(("theta_dot",))})
    assert [(a.get_marker(), a.get_linestyle()) for a in one_panel(chart).lines] == [(".", "None")]
    axes = Grid({"theta": many})
    _, chart = drawn(tmp_path / "nan", axes, {"low": First({"theta": (-0.5,)})}, 2.0)
    assert [a.get_marker() for a in one_panel(chart).lines] == ["."]
    assert chart.get_supxlabel() == "grey or empty: no event within 2 s"
    _, chart = drawn(tmp_path / "none", axes, {"low": First({"theta": (-3.0,)})})
    assert [text.get_text() for text in one_panel(chart).texts] == ["no values"]


def test_two_random_quantities_are_coloured_points(tmp_path: Path) -> None:
    axes = Random({"theta": (0.1, 1.0), "l": (1.0, 2.0)}, 50, seed=0)
    results, chart = drawn(tmp_path, axes, {"low": First({"theta": (-0.5,)})}, 2.0)
    panel = one_panel(chart)
    unknown, known = (one for one in panel.collections if isinstance(one, PathCollection))
    where, values = np.c_[results.axes["theta"], results.axes["l"]], results.maps["low"]
    lost = np.isnan(values)
    assert 0 < lost.sum() < 50
    assert np.array_equal(unknown.get_offsets(), where[lost])
    assert np.array_equal(unknown.get_facecolor(), [to_rgba("#c8c8c8")])
    assert np.array_equal(known.get_offsets()[~lost], where[~lost])
    assert np.array_equal(np.ma.filled(known.get_array(), np.nan)[~lost], values[~lost])
    assert isinstance(known.norm, LogNorm)
    assert (panel.get_xlabel(), panel.get_ylabel()) == (r"$\theta$ / rad", "$l$ / m")


def test_an_image_has_its_pixels_around_their_values(tmp_path: Path) -> None:
    angles, lengths = np.linspace(-PI, PI, 9), np.linspace(1, 2, 6)
    axes = Grid({"theta": angles, "l": lengths, "g": [9.0, 9.81, 10.0]})
    results, chart = drawn(tmp_path, axes, {"reach": Extremes(("theta",)), "e": EnergyError()})
    low, high, energy = panels_of(chart)
    assert [panel.get_title() for panel in (low, high, energy)] == [
        r"reach $\theta$ smallest",
        r"reach $\theta$ largest",
        "e",
    ]
    for panel, values in ((low, results.maps["reach"][..., 0, 0]), (energy, results.maps["e"])):
        image = panel.images[0]
        assert np.allclose(image.get_extent(), [-9 / 8 * PI, 9 / 8 * PI, 0.9, 2.1])
        shown = np.abs(values) if panel is energy else values
        assert np.array_equal(image.get_array(), shown[:, :, 1].T)  # in the middle of g
        assert panel.get_xlabel() == r"$\theta$ / rad, at $g$ = 9.81 m/s^2"
    assert isinstance(energy.images[0].norm, LogNorm)


@pytest.mark.parametrize(("span", "ticks"), [(2 * PI, True), (5.5 * PI, False), (1.0, False)])
def test_angles_about_a_turn_have_ticks_at_multiples_of_pi(
    span: float, ticks: bool, tmp_path: Path
) -> None:
    axes = Grid({"theta": np.linspace(-span / 2, span / 2, 5)})
    _, chart = drawn(tmp_path, axes, {"end": Final(("theta",))})
    axis = one_panel(chart).xaxis
    words = [axis.get_major_formatter()(value, 0) for value in np.arange(-2, 4) * PI / 2]
    assert (words == ["−π", "−π/2", "0", "π/2", "π", "3π/2"]) == ticks


def test_the_barrier_is_the_line_of_its_energy(tmp_path: Path) -> None:
    angles = np.linspace(-3, 3, 13)
    flip = First({"theta2": (-PI, PI)}, ({"theta1": PI}, {"theta2": PI}))
    axes = Grid({"theta1": angles, "theta2": angles})
    _, chart = drawn(tmp_path, axes, {"flip": flip}, module=dp)
    assert chart.get_supxlabel().startswith("white, inside the line: not enough energy; grey")
    (line,) = (one for one in one_panel(chart).collections if isinstance(one, ContourSet))
    vertices = np.concatenate([path.vertices for path in line.get_paths()])
    # Heyl's energy, of the lower rod upright below the upper one
    m1, m2, l1, l2, _ = dp.DEFAULTS
    level = (m1 + m2) * l1 * np.cos(vertices[:, 0]) + m2 * l2 * np.cos(vertices[:, 1])
    assert len(vertices) > 100
    assert np.abs(level - ((m1 + m2) * l1 - m2 * l2)).max() < 1e-3


def test_samples_are_curves_over_time_of_motions_from_all_over_the_sweep(tmp_path: Path) -> None:
    motions = 3 * CURVES
    axes = Grid({"theta": np.linspace(0.1, 3.0, motions)})
    results, chart = drawn(tmp_path / "a", axes, {"path": Samples(("theta", "theta_dot"), 6)}, 2.5)
    theta, rate = panels_of(chart)
    assert [panel.get_title() for panel in (theta, rate)] == [
        r"path: $\theta$",
        r"path: $\dot{\theta}$",
    ]
    for panel, k in ((theta, 0), (rate, 1)):
        for line, values in zip(panel.lines, results.maps["path"][::3, k], strict=True):
            assert np.allclose(points(line), np.c_[np.linspace(0, 2.5, 6), values])
        assert len({tuple(line.get_color()) for line in panel.lines}) == CURVES
    assert chart.get_supxlabel() == f"about {CURVES} of {motions} motions over time"
    few = Grid({"theta": [0.1, 0.2]})
    _, chart = drawn(tmp_path / "b", few, {"path": Samples(("theta",), 6)})
    assert chart.get_supxlabel() == ""


def test_a_section_has_a_panel_for_each_energy_and_a_colour_for_each_motion(
    tmp_path: Path,
) -> None:
    axes = Grid({"energy": [0.05, 0.1], "y": [0.1, 0.2, 0.9]})
    section = {"section": Section(("y", "y_dot"), 5, "x", 0.0, 1)}
    values = {"x": 0.0, "x_dot": "energy"}
    results, chart = drawn(tmp_path, axes, section, 60.0, module=hh, values=values)
    panels = panels_of(chart)
    assert [panel.get_title()[:10] for panel in panels] == ["$E$ = 0.05", "$E$ = 0.1 "]
    for k, panel in enumerate(panels):
        crossings = results.maps["section"][k]
        known = crossings[np.isfinite(crossings).any(axis=(1, 2))]
        assert len(known) == 2  # no velocity at y = 0.9 has so small an energy
        for line, motion in zip(panel.lines, known, strict=True):
            assert np.array_equal(points(line), motion.T, equal_nan=True)
            assert (line.get_marker(), line.get_linestyle()) == (".", "None")
        assert len({tuple(line.get_color()) for line in panel.lines}) == 2
        assert "y" in panel.get_xlabel()
        assert r"\dot" in panel.get_ylabel()
        # the points fill the axes
        drawn_points = np.concatenate([points(line) for line in panel.lines])
        spans = np.nanmax(drawn_points, axis=0) - np.nanmin(drawn_points, axis=0)
        assert (spans > 0.8 * np.ptp([panel.get_xlim(), panel.get_ylim()], axis=1)).all()


@pytest.mark.parametrize(("direction", "way"), [
    ({}, "upwards"), ({"direction": -1}, "downwards"), ({"direction": 0}, "in both directions"),
])  # fmt: skip
def test_a_section_states_the_crossings(
    direction: dict[str, int], way: str, tmp_path: Path
) -> None:
    values = {"x": 0.0, "x_dot": "energy", "energy": 0.1}
    section = Section(("y", "y_dot"), 5, "x", **direction)
    axes = Grid({"y": [0.1, 0.2]})
    _, chart = drawn(tmp_path, axes, {"cut": section}, 60.0, module=hh, values=values)
    assert chart.get_supxlabel() == f"crossings of $x$ = 0 m {way}"


def test_angles_are_wrapped_to_half_a_turn_on_either_side() -> None:
    angles = np.array([0.0, 3.0, 3.5, -3.5, 7.0])
    assert wrapped(angles) == pytest.approx([0, 3, 3.5 - 2 * PI, 2 * PI - 3.5, 7 - 2 * PI])


def test_directions_are_shown_between_half_turns(tmp_path: Path) -> None:
    axes = Grid({"theta": [0.1, 0.3], "theta_dot": [9.0, 10.0, 11.0]})  # over and over
    results, chart = drawn(tmp_path / "a", axes, {"end": Final(("theta",))}, 3.0)
    angles = results.maps["end"][:, :, 0]
    assert angles.min() > 2 * PI
    image = one_panel(chart).images[0]
    assert np.array_equal(image.get_array(), wrapped(angles).T)
    assert (image.cmap.name, image.norm.vmin, image.norm.vmax) == ("twilight", -PI, PI)
    assert np.allclose(image.get_extent(), [0, 0.4, 8.5, 11.5])  # of two values, too
    # a section: its angles and nothing else
    maps = {"both": Section(sp.STATE, 4, "theta_dot", 8.9), "one": Section(("theta",), 4, "theta")}
    axes = Grid({"theta": [0.1, 0.3], "theta_dot": [9.5]})
    results, chart = drawn(tmp_path / "b", axes, maps, 3.0)
    both, one = panels_of(chart)
    angles, rates = results.maps["both"][0, 0]
    assert np.nanmax(angles) > 2 * PI
    assert np.array_equal(points(both.lines[0]), np.c_[wrapped(angles), rates], equal_nan=True)
    assert (one.get_xlabel(), one.get_ylabel()) == ("number of the point", r"$\theta$ / rad")


@pytest.mark.parametrize(("lengths", "extent"), [
    ([1.0], [0.5, 1.5]), ([1.0, 2.0], [0.5, 2.5]), ([1.0, 2.0, 3.0], [0.5, 3.5]),
])  # fmt: skip
def test_few_values_have_pixels_around_them(
    lengths: list[float], extent: list[float], tmp_path: Path
) -> None:
    axes = Grid({"theta": [0.1, 0.2], "l": lengths})
    _, chart = drawn(tmp_path, axes, {"end": Final(("theta_dot",))}, 0.1)
    assert np.allclose(one_panel(chart).images[0].get_extent(), [0.05, 0.25, *extent])


def curve(method: str, form: str, backend: str, name: str = "h") -> CostCurve:
    settings = (0.1, 0.01, 0.001)
    return CostCurve("s", method, form, backend, [
        MeasuredRun({name: h}, 1 / h, int(100 / h), h**2 + len(method) * 1e-9, h**3)
        for h in settings
    ])  # fmt: skip


def data(panel: Axes) -> dict[str, list[list[float]]]:
    """Points of a panel's lines by label; every run has a marker."""
    assert all(line.get_marker() == "." for line in panel.lines)
    return {str(line.get_label()): points(line).tolist() for line in panel.lines}


def test_work_precision_diagrams_show_the_runs_of_each_curve() -> None:
    fast = curve("rk4", "rational", "compiled")
    slow = curve("rk4", "lagrangian", "compiled")
    ours = curve("verner853", "rational", "compiled", "rtol")
    python = curve("verner853", "lagrangian", "python", "rtol")
    chart = chart_plots.work_precision("title", [fast, slow, ours, python])
    seconds, calls, choices = chart.axes

    def costs(one: CostCurve, work: str) -> list[list[float]]:
        return [[getattr(p, work), p.global_error] for p in one.points]

    fastest = {"rk4": fast, "verner853": ours}
    assert data(seconds) == {name: costs(c, "work_seconds") for name, c in fastest.items()}
    assert data(calls) == {name: costs(c, "work_rhs") for name, c in fastest.items()}
    assert data(choices) == {
        "verner853, compiled, rational": costs(ours, "work_seconds"),
        "verner853, python, lagrangian": costs(python, "work_seconds"),
    }
    labels = ["time / s", "calls of the right-hand side", "time / s"]
    assert [panel.get_xlabel() for panel in chart.axes] == labels
    assert {panel.get_ylabel() for panel in chart.axes} == {chart_plots.ERROR}
    for panel in chart.axes:
        assert (panel.get_xscale(), panel.get_yscale()) == ("log", "log")
        styles = [(line.get_color(), line.get_linestyle()) for line in panel.lines]
        assert len({*styles}) == len(styles)


def test_the_methods_of_the_report_are_drawn_over_their_step_and_their_energy_error() -> None:
    rk4, euler = (curve(name, "lagrangian", "compiled") for name in ("rk4", "rk1"))
    (panel,) = chart_plots.steps("title", [euler, rk4, curve("dp54", "lagrangian", "scipy")]).axes
    assert data(panel) == {
        label: [[p.setting["h"], p.global_error] for p in one.points]
        for label, one in (("RK1 (rk1)", euler), ("RK4 (rk4)", rk4))
    }
    assert panel.get_xlabel() == "step / s"
    unit = EnergyUnit("energy above rest", 2.0)
    (panel,) = chart_plots.energy("title", [euler, rk4], 0.1, unit).axes
    runs = next(line for line in panel.lines if line.get_label() == "compiled")
    errors = [[p.energy_error, p.global_error] for one in (euler, rk4) for p in one.points]
    assert points(runs).tolist() == errors
    (limit,) = (line for line in panel.lines if str(line.get_label()).startswith("above"))
    assert {*limit.get_ydata()} == {0.1}


def critical(method: str, limit: float) -> CriticalStep:
    tableau = load(method)
    function = StabilityFunction.of(tableau)
    sizes = tableau.order, tableau.stages
    return CriticalStep(method, tableau.title, *sizes, function, *[limit] * 3, 0.1, 0.0, 0.0)


def test_stability_regions_show_the_eigenvalues_at_the_longest_stable_step() -> None:
    frequencies, eigenvalues = np.array([1.0, 2.0, 4.0]), np.array([0.5j, -0.2 + 0.1j])
    steps = [critical("rk4", 0.7), critical("rk4_38", 0.7), critical("gauss1", inf)]
    chart = regions("title", steps, frequencies, eigenvalues)
    explicit, implicit = panels_of(chart)
    assert explicit.get_title().startswith("rk4, rk4_38\nh ≤ 0.7 s")
    assert implicit.get_title() == "gauss1\nevery step is stable"
    for panel, h in ((explicit, 0.7), (implicit, 1 / 4)):
        along, modes = (line for line in panel.lines if line.get_marker() in (".", "o"))
        assert np.allclose(points(along), h * np.c_[eigenvalues.real, eigenvalues.imag])
        assert np.allclose(points(modes), h * np.c_[[0] * 6, [1, 2, 4, -1, -2, -4]])
        assert (panel.get_xlim(), panel.get_ylim()) == ((-7, 4), (-7, 7))
        boundary = next(c for c in panel.collections if isinstance(c, ContourSet) and not c.filled)
        vertices = np.concatenate([path.vertices for path in boundary.get_paths()])
        function = steps[0 if panel is explicit else 2].function
        assert np.abs(np.abs(function(vertices @ [1, 1j])) - 1).max() < 0.02
    lines = {"R": steps[0].function}
    for panel in (explicit, implicit, *boundaries(lines).axes):
        assert panel.get_aspect() == 1
        ends = [points(line).tolist() for line in panel.lines]
        assert [[0, 0], [1, 0]] in ends  # the axes through zero
        assert [[0, 0], [0, 1]] in ends


@pytest.mark.parametrize(("high", "marks"), [
    (20.0, [0.5, 1, 2, 5, 10, 20]), (400.0, [0.5, 1, 2, 5, 10, 20, 50, 100, 200]),
    (2000.0, [1, 10, 100, 1000]),
])  # fmt: skip
def test_a_logarithmic_colour_bar_has_round_marks(high: float, marks: list[float]) -> None:
    chart, (panel,) = panels("", size=(5, 5))
    add_colour_bar(panel, ScalarMappable(LogNorm(0.5, high)), "time / s")
    axis = chart.axes[1].yaxis
    shown = [x for x in axis.get_major_locator()() if 0.5 <= x <= high]
    assert shown == pytest.approx(marks)
    assert axis.get_major_formatter()(0.02, 0) == "0.02"


#: Residuals of two runs of a double pendulum's angle and of a formula, with a gap.
NOISE = np.array([0.5, 0.1])
RESIDUALS = [NOISE[:, np.newaxis] * np.random.default_rng(k).normal(size=(2, 60)) for k in (1, 2)]
RESIDUALS[0][1, 7] = np.nan


def invented_fit() -> Any:
    t = np.linspace(0, 3, 60)
    fitted = [np.stack([np.sin(k * t), np.cos(k * t)]) for k in (1, 2)]
    outputs = SimpleNamespace(names=("theta1", "l1*theta2"), units=("rad", ""), module=dp)
    runs = [SimpleNamespace(t=t + k, name=f"run {k}") for k in (1, 2)]
    estimate = SimpleNamespace(noise=NOISE)
    return SimpleNamespace(
        outputs=outputs, runs=runs, fitted=fitted, residuals=RESIDUALS, estimate=estimate
    )


def test_plots_of_a_fit_show_data_motion_and_residuals() -> None:
    fit = invented_fit()
    chart = fit_plots.figure(fit, "title")
    assert len(chart.axes) == 8
    for k, label in enumerate((r"$\theta_{1}$ / rad", "l1*theta2")):
        motion, over_time, histogram, correlation = chart.axes[4 * k : 4 * k + 4]
        assert (motion.get_ylabel(), over_time.get_ylabel()) == (label, f"residual of {label}")
        for n, run in enumerate(fit.runs):
            data, curve = motion.lines[2 * n : 2 * n + 2]
            values = fit.fitted[n][k] + RESIDUALS[n][k]
            assert np.array_equal(points(data), np.c_[run.t, values], equal_nan=True)
            assert np.array_equal(points(curve), np.c_[run.t, fit.fitted[n][k]])
            left = over_time.lines[n]
            assert np.array_equal(points(left), np.c_[run.t, RESIDUALS[n][k]], equal_nan=True)
            assert curve.get_color() == left.get_color()
        levels = [line.get_ydata()[0] for line in over_time.lines[2:]]
        assert levels == [-2 * NOISE[k], 2 * NOISE[k], 0]
        # parts of all values between the edges of bars, and of a normal distribution
        (curve,), bars = histogram.lines, histogram.patches
        both = np.concatenate([residuals[k] for residuals in RESIDUALS]) / NOISE[k]
        for bar in bars:
            low, high = bar.get_x(), bar.get_x() + bar.get_width()
            part = bar.get_height() * bar.get_width() * np.isfinite(both).sum()
            assert part == pytest.approx(((both >= low) & (both < high)).sum(), abs=1.001)
        x, density = curve.get_data()
        assert np.trapezoid(density, x) == pytest.approx(erf(x[-1] / sqrt(2)), rel=1e-3)
        assert (x[-1], erf(x[-1] / sqrt(2))) == pytest.approx((-x[0], 1 - 2e-4), rel=1e-6)
        # against NumPy's correlation of each run with itself
        values = [np.nan_to_num(residuals[k]) for residuals in RESIDUALS]
        sums = sum(np.correlate(one, one, "full")[len(one) - 1 :] for one in values)
        (drawn_lags,) = correlation.collections
        ends = np.array([path.vertices for path in drawn_lags.get_paths()])
        lags = np.arange(1, fit_plots.LAGS + 1)
        assert ends[:, 1] == pytest.approx(np.c_[lags, (sums / sums[0])[lags]])
        assert ends[:, 0] == pytest.approx(np.c_[lags, 0 * lags])
        bound = 2 / sqrt(np.isfinite(both).sum())
        levels = [line.get_ydata()[0] for line in correlation.lines]
        assert levels == pytest.approx([-bound, bound, 0])
    assert [text.get_text() for text in chart.axes[0].get_legend().get_texts()] == [
        "run 1",
        "run 2",
    ]
    assert all(panel.get_legend() is None for panel in chart.axes[1:])


def test_plots_of_predictions_show_the_selected_model_and_all_residuals() -> None:
    fit = invented_fit()
    names = ("plain", "with friction")
    candidates = [
        SimpleNamespace(name=name, fit=fit, predictions=[
            SimpleNamespace(run=run, begin=2.5, predicted=(n + 1) * motion, residuals=n + rest)
            for run, motion, rest in zip(fit.runs, fit.fitted, RESIDUALS, strict=True)
        ])
        for n, name in enumerate(names)
    ]  # fmt: skip
    comparison: Any = SimpleNamespace(selected=candidates[1], candidates=candidates)
    chart = fit_plots.prediction_figure(comparison, "title")
    assert len(chart.axes) == 8
    for row in range(4):
        motion, rest = chart.axes[2 * row : 2 * row + 2]
        run, k = divmod(row, 2)
        one = candidates[1].predictions[run]
        data, curve = (points(line) for line in motion.lines)
        values = one.predicted[k] + one.residuals[k]
        assert np.array_equal(data, np.c_[one.run.t, values], equal_nan=True)
        assert np.array_equal(curve, np.c_[one.run.t, one.predicted[k]])
        assert motion.get_title() == f"run {run + 1}: kept back"
        for line, candidate in zip(rest.lines, candidates, strict=True):
            own = candidate.predictions[run].residuals[k]
            assert np.array_equal(points(line), np.c_[one.run.t, own], equal_nan=True)
        for panel in (motion, rest):  # values before the prediction are shaded
            (span,) = panel.patches
            assert (span.get_x(), span.get_x() + span.get_width()) == (run + 1, 2.5)
        assert (rest.get_legend() is None) == (row > 0)


def test_plots_of_fits_charts_and_stability_are_as_recorded(record: Record) -> None:
    curves = [curve("rk4", "rational", "compiled"), curve("rk1", "lagrangian", "compiled"),
        curve("verner853", "rational", "compiled", "rtol"), curve("dp54", "rational", "scipy"),
        curve("verner853", "lagrangian", "python", "rtol"), curve("taylor", "lagrangian", "heyoka"),
    ]  # fmt: skip
    steps = [critical("rk4", 0.7), critical("rk4_38", 0.7), critical("gauss1", inf)]
    unit = EnergyUnit("energy above rest", 2.0)
    charts = {
        "precision": chart_plots.work_precision("title", curves),
        "steps": chart_plots.steps("title", curves),
        "energy": chart_plots.energy("title", curves, 0.1, unit),
        "regions": regions("title", steps, np.array([1.0, 4.0]), np.array([0.5j, -0.2 + 0.1j])),
        "boundaries": boundaries({one.method: one.function for one in steps}),
        "fit": fit_plots.figure(invented_fit(), "title"),
    }
    record.check_digests({name: described(chart) for name, chart in charts.items()})
