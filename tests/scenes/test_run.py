"""``holonomic run``: its output, files and plots, and its exit codes."""

import json
import os
import pty
import re
import subprocess
import sys
import time
from argparse import Namespace
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

import generated.double_pendulum as dp
from solvers.app.cli import main
from solvers.app.commands.options import selected_scenes
from solvers.app.modules import load as load_module
from solvers.app.modules import specialiser
from solvers.equations.module import equations_of_motion, title
from solvers.io.figure_names import symbol
from solvers.player.motion_plots import _labelled, default_pictures, figure
from solvers.player.sampled_motion import ELEVATION, projected, tracks
from solvers.references.taylor import taylor
from solvers.scenes.scene import Scene
from solvers.scenes.scene_output import file_names, summary, table, together, write_files
from solvers.scenes.scene_reading import find
from solvers.scenes.scene_run import SceneResult, run_scene

KEYS = {"model", "method", "form", "final_state", "requested_accuracy", "error_estimate", "why"}


def run(*arguments: str, folder: Path) -> int:
    return main(["run", *arguments, "--output", str(folder)])


@pytest.mark.long("other tests reach its code")
def test_the_json_contains_the_model_the_reason_and_the_final_state(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run("report", "--json", folder=tmp_path) == 0
    result = json.loads(capsys.readouterr().out)
    assert set(result) >= KEYS
    assert (result["model"], result["form"]) == ("full equations", "rational")
    assert result["method"] in ("verner853", "verner98", "gauss8")  # as recorded
    truth = taylor(dp, dp.DEFAULTS, find("report", load_module).y0, [0, 5])[-1]
    assert list(result["final_state"]) == [*dp.STATE]
    assert (
        np.abs(np.array(list(result["final_state"].values())) - truth).max()
        <= (result["error_estimate"])
    )
    assert result["error_estimate"] <= result["requested_accuracy"] == 1e-9
    assert result["accuracy_met"] is True
    assert set(result["declined_models"]) >= {"rest", "normal modes", "quadrature"}
    names = {Path(path).name for path in result["files"].values()}
    assert names == {"report.csv", "report.html"}
    assert names == {path.name for path in tmp_path.iterdir()}


@pytest.mark.parametrize(("scene", "options", "is_plotted"), [
    ("single", [], False), ("single", ["--plot"], True), ("figure_4_2", [], True),
])  # fmt: skip
def test_a_scene_is_plotted_on_request_and_where_it_specifies_pictures(
    scene: str, options: list[str], is_plotted: bool, tmp_path: Path
) -> None:
    assert run(scene, *options, folder=tmp_path) == 0
    assert (tmp_path / f"{scene}.png").is_file() is is_plotted


def test_a_run_without_a_plot_loads_neither_matplotlib_nor_parts_of_scipy(tmp_path: Path) -> None:
    code = (
        "import sys\nfrom solvers.app.cli import main\n"
        f"assert main(['run', 'small', '--output', {str(tmp_path)!r}]) == 0\n"
        "parts = {'.'.join(name.split('.')[:2]) for name in sys.modules}\n"
        "print(sorted(parts & {'matplotlib', 'sympy', 'scipy.linalg', 'scipy.special'}))"
    )
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert printed.stdout.splitlines()[-1] == b"[]"


SCENE = """
system = "single_pendulum"
duration = 1
[initial]
theta = 0.1
"""
BESIDE = "[[beside]]\nlabel = 'longer'\nparameters = { l = 2 }\n"


@pytest.mark.parametrize(("command", "first", "second", "file"), [
    ("run", "a", "other/a", "a.csv"),
    ("run", "a", "a_2", "a_2.csv"),  # the table of the second run in a.toml
    ("run", "a_2", "a", "a_2.csv"),
    ("run", "a", "A", "A.csv"),  # where the file system does not distinguish them
    ("run", "a", "A_2", "A_2.csv"),
    ("run", "\u00e9", "e\u0301", "e\u0301.csv"),
    ("chart", "a", "other/A", "A"),
    ("stability", "a", "other/a", "a"),
])  # fmt: skip
def test_scenes_that_would_write_the_same_file_are_refused_before_the_work(
    command: str,
    first: str,
    second: str,
    file: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    paths = [tmp_path / f"{name}.toml" for name in (first, second)]
    for path in paths:
        path.parent.mkdir(exist_ok=True)
        path.write_text(SCENE + BESIDE * (path.stem == "a"))
    assert main([command, *map(str, paths), "--output", str(tmp_path / "out")]) == 2
    names = " and ".join(repr(path.stem) for path in paths)
    message = f"the scenes {names} would both write {file}: rename one of them"
    assert message in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_scenes_with_other_files_are_accepted(tmp_path: Path) -> None:
    paths = [tmp_path / f"{name}.toml" for name in ("a", "a_3", "ab")]
    for path in paths:
        path.write_text(SCENE + BESIDE)
    arguments = Namespace(scenes=[*map(str, paths)], output=tmp_path)
    names = {
        one.name: [*file_names(one, 2, plot=True).values()]
        for one in selected_scenes(arguments, ())
    }
    assert selected_scenes(arguments, (), lambda one: names[one.name])
    tables = [name for files in names.values() for name in files if name.endswith("csv")]
    assert tables == ["a.csv", "a_2.csv", "a_3.csv", "a_3_2.csv", "ab.csv", "ab_2.csv"]


def test_a_prescribed_method_is_reported_with_its_error_and_the_runs_beside_it(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run("program_3", "--json", folder=tmp_path) == 0
    result = json.loads(capsys.readouterr().out)
    scene = find("program_3", load_module)
    labels = [run.label for run in (scene, *scene.beside)]
    assert [run["label"] for run in (result, *result["beside"])] == labels
    assert (result["method"], result["setting"], result["accuracy_met"]) == (
        "rk4",
        {"h": 0.01},
        False,
    )
    (motion,) = result["beside"]
    assert motion["accuracy_met"] is True
    apart = [abs(result["final_state"][k] - motion["final_state"][k]) for k in dp.STATE]
    assert 1e-8 < max(apart) < result["error_estimate"] < 1e-5
    assert run("program_3", folder=tmp_path) == 0
    assert "NOT MET, since the scene names the model or the step" in capsys.readouterr().out


def test_only_significant_digits_are_printed(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run("flea", "one_bob", folder=tmp_path) == 0
    flea, one_bob = capsys.readouterr().out.split("files: ")[:2]
    estimate = float(re.search(r"error estimate (\S+),", flea)[1])
    (digits,) = re.findall(r"theta1 = -?\d+\.(\d+) rad,", flea)
    assert 10.0 ** -len(digits) >= estimate / 10
    assert "theta2" not in one_bob.split("final state:")[1]
    assert "not normal modes: theta2 has no inertia" in one_bob


def test_the_table_is_the_motion_with_units(tmp_path: Path) -> None:
    scene = replace(find("small", load_module), outputs=("theta1", "energy"), samples=5)
    result = run_scene(scene)
    lines = table(result).splitlines()
    assert lines[0] == "t [s],theta1 [rad],energy [J]"
    rows = np.array([line.split(",") for line in lines[1:]], dtype=float)
    assert rows[:, 0].tolist() == [0, 5, 10, 15, 20]
    assert rows[:, 1].tolist() == result.y[0].tolist()
    assert np.ptp(rows[:, 2]) < 1e-6
    # no energy unless it is requested
    assert run_scene(replace(scene, outputs=("theta1",))).energy is None


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("name", ["report", "tremor", "single", "weightless", "rest"])
def test_a_motion_starts_exactly_at_the_initial_state(name: str) -> None:
    scene = find(name, load_module)
    assert run_scene(scene).y[:, 0].tolist() == [*scene.y0]


def test_rods_and_springs_are_distinguished_by_their_lengths() -> None:
    runs = (run_scene(find(name, load_module)) for name in ("report", "spring"))
    rods, spring = tracks(together([*runs]))
    assert rods.links == (("rod", (-1, 0)), ("rod", (0, 1)))
    assert spring.links == (("spring", (-1, 0)),)
    assert len(rods.points) == len(spring.points) == 0  # links end at masses and the origin


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(("system", "initial", "rods"), [
    ("spherical_pendulum", "theta = 1\nphi = 0\nphi_dot = 2", [(-1, 0)]),
    ("chain_3", "theta1 = 1\ntheta2 = 0\ntheta3 = 0", [(-1, 0), (0, 1), (1, 2)]),
])  # fmt: skip
def test_masses_at_a_constant_distance_are_joined(
    system: str, initial: str, rods: list[tuple[int, int]], tmp_path: Path
) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(f'system = "{system}"\nduration = 2\naccuracy = 1e-6\n[initial]\n{initial}\n')
    (motion,) = tracks(together([run_scene(find(str(path), load_module))]))
    assert list(motion.links) == [("rod", pair) for pair in rods]


def test_pages_show_coordinates_that_all_runs_have_and_the_equations(tmp_path: Path) -> None:
    both, light = run_scene(find("report", load_module)), run_scene(find("one_bob", load_module))
    labels = [[one.label for one in track.coordinates] for track in tracks(together([both]))]
    assert labels == [["θ₁", "θ₂"]]
    common = tracks(together([both, light]))
    assert [[one.label for one in track.coordinates] for track in common] == [["θ₁"]] * 2
    assert common[0].coordinates[0].rates.tolist() == both.y[2].tolist()
    assert run("single", folder=tmp_path) == 0
    text = (tmp_path / "single.html").read_text()
    assert '<h2 id="equations-title">Equations of motion</h2>' in text
    formula = text.partition('id="equations-title"')[2]
    assert formula.count('<div class="formula">') == 1
    assert "<mi>sin</mi>" in formula


def test_formulas_of_a_docstring_are_whole() -> None:
    first, second = equations_of_motion(dp)
    assert first.startswith("g*l1*(m1 + m2)*sin(theta1) + ")
    assert first.endswith(" = 0")
    assert "\n" not in first + second
    assert "  " not in first + second
    text = """Title.

Constraints, with their multipliers:
    x**2 + y**2 - l**2 = 0: rod [N/m], tension

Equations of motion:
    m*x_ddot
        - 2*rod*x = 0
"""
    module = SimpleNamespace(__doc__=text)
    assert equations_of_motion(module) == ("m*x_ddot - 2*rod*x = 0", "x**2 + y**2 - l**2 = 0")
    assert equations_of_motion(SimpleNamespace(__doc__="Title.\n\nMasses:\n    m")) == ()


def test_the_title_of_a_module_is_its_first_line_without_a_full_stop() -> None:
    assert title(SimpleNamespace(__doc__="A rod. And more.\n\nMasses:\n    m")) == "A rod. And more"
    assert title(SimpleNamespace(__doc__="A rod")) == "A rod"


def test_motions_in_space_are_projected_obliquely() -> None:
    # of three unit vectors the upright one stays upright, and areas of the ground shrink by
    # the sine of the elevation
    east, north, up = projected(np.eye(3)[:, :, None])[:, :, 0]
    assert up == pytest.approx([0, np.cos(ELEVATION)])
    assert abs(np.linalg.det([east, north])) == pytest.approx(np.sin(ELEVATION))
    assert np.hypot(east[0], north[0]) == pytest.approx(1)


def test_specialised_code_is_generated_on_request() -> None:
    scene = replace(find("report", load_module), code="specialised")
    result = run_scene(scene, specialiser)
    assert result.selection.model.run.motion.module.PARAMETERS == ()
    assert "def rhs_rational(" in Path(result.specialised_module.__file__).read_text()
    (line,) = (line for line in summary(result) if "specialised code" in line)
    assert "specialised code (29 operations instead of 34" in line
    assert 0.1 < float(re.findall(r"general code takes (\S+) x as long", line)[0]) < 10
    plain = run_scene(replace(scene, code=None), specialiser)
    assert plain.selection.model.run.motion.module is dp
    assert result.general_code_seconds > 0
    assert np.isnan(plain.general_code_seconds)  # there is no other code to compare with
    assert np.abs(result.y - plain.y).max() < 2 * scene.accuracy
    with pytest.raises(ValueError, match="needs a specialiser"):
        run_scene(scene)


@pytest.mark.parametrize(("text", "code", "words"), [
    ("system = 1\n", 2, "is missing"),
    ('system = "double_pendulum"\nduration = 20\nmethod = "dop853"\n'
     'initial = { theta1 = "pi/2", theta2 = "pi" }\n', 3, "dop853 reaches"),
    ('system = "double_pendulum"\nduration = 1\nmodel = "full"\nparameters = { m2 = "absent" }\n'
     "initial = { theta1 = 1, theta2 = 0 }\n", 2, "theta2 has no inertia"),
])  # fmt: skip
def test_the_exit_code_depends_on_the_kind_of_error(
    text: str, code: int, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(text)
    assert run(str(path), folder=tmp_path) == code
    message = capsys.readouterr().err
    assert words in message
    assert "Traceback" not in message
    assert [p.name for p in tmp_path.iterdir()] == ["scene.toml"]


def test_other_commands_refuse_unsuitable_scenes(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["stability", "weightless", "--output", str(tmp_path)]) == 2
    assert "does not oscillate about rest" in capsys.readouterr().err
    assert run("none.toml", folder=tmp_path) == 2
    assert "there is no such file" in capsys.readouterr().err


def test_text_with_dollar_signs_is_plotted_unchanged(tmp_path: Path) -> None:
    text = 'title = "costs $5 and $x^"\nsystem = "single_pendulum"\nduration = 1\n'
    (tmp_path / "s.toml").write_text(text + "initial = { theta = 1 }\n")
    assert run(str(tmp_path / "s.toml"), "--plot", folder=tmp_path / "out") == 0
    assert len(list((tmp_path / "out").iterdir())) == 3
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "s.toml").write_text(text + "initial = { theta = 2 }\n")
    both = [str(tmp_path / "s.toml"), str(tmp_path / "other" / "s.toml")]
    assert run(*both, folder=tmp_path / "out") == 2


def lines_of(chart: Figure) -> list[tuple[str, int]]:
    return [(panel.get_ylabel(), len(panel.lines)) for panel in chart.axes if panel.axison]


def test_plots_show_all_existing_quantities_with_units_and_equal_axes_in_space() -> None:
    scene = find("report", load_module)
    assert default_pictures(*run_scene(scene).sampled_motions()) == (
        "theta1, theta2 over t",
        "theta1_dot over theta1",
        "theta2_dot over theta2",
        "theta2 over theta1",
        "theta2_dot over theta1_dot",
        "path",
        "energy",
    )
    chart = figure(together([run_scene(scene)]))
    panels = [panel for panel in chart.axes if panel.axison]
    assert len(panels) == 7
    for panel in panels:
        for label in (panel.get_xlabel(), panel.get_ylabel()):
            assert re.search(r"/ (\(?(s|rad|m|rad/s)\)?|energy above rest)$", label), label
    assert [panel.get_aspect() for panel in panels].count(1.0) == 1
    assert symbol("theta1_dot") == r"$\dot{\theta}_{1}$"
    assert (symbol("r"), symbol("t")) == ("$r$", "$t$")
    without = run_scene(find("one_bob", load_module))
    assert default_pictures(without.sampled_motions()[0]) == (
        "theta1 over t",
        "theta1_dot over theta1",
        "path",
        "energy",
    )
    # the curves are the motion
    angles = panels[0].lines
    assert np.array_equal(angles[1].get_ydata(), run_scene(scene).y[1])


@pytest.mark.long("other tests reach its code")
def test_the_report_s_figures_are_plotted_with_a_note_on_what_is_known() -> None:
    for name, curves in (
        ("figure_3_1", 4),
        ("figure_3_3", 2),
        ("figure_3_6", 1),
        ("figure_4_2", 1),
        ("figure_4_5", 2),
    ):
        scene = find(name, load_module)
        chart = figure(together([run_scene(one) for one in (scene, *scene.beside)]))
        (panel,) = chart.axes
        assert len(panel.lines) == curves
        note = chart.get_supxlabel()
        assert "lost" in note
        assert "error estimate" in note


@pytest.mark.parametrize("name", ["tremor", "single"])
def test_a_run_reports_the_model_that_it_evaluates(name: str) -> None:
    messages: list[str] = []
    result = run_scene(find(name, load_module), report=messages.append)
    assert messages[-1] == result.selection.model.name
    assert messages.count(messages[-1]) == 2  # tried, then evaluated


def test_the_cost_is_compared_with_that_of_the_full_equations_where_they_cost_more() -> None:
    result = run_scene(find("tremor", load_module))
    slower = replace(result, work_seconds=1e-3, full_equations_seconds=4e-3)
    assert [*summary(slower)][-1].endswith("; the full equations take about 4 ms, 4 times as long")
    faster = replace(slower, full_equations_seconds=5e-4)
    assert "full equations" not in [*summary(faster)][-1]


def test_values_of_unknown_error_have_no_decimals() -> None:
    result = run_scene(find("tremor", load_module))
    model = replace(result.selection.model, error_estimate=np.inf)
    unknown = replace(result, selection=replace(result.selection, model=model))
    (line,) = (line for line in summary(unknown) if line.startswith("final state: "))
    assert re.fullmatch(r"final state: theta1 = -?\d+ rad, .* \(none of these .*\)", line)


def test_the_files_of_a_scene_with_specialised_code_include_this(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    results = [run_scene(Scene(dp, {}, {"theta1": 1e-4, "theta2": 0.0}, 1.0, samples=5))]
    assert "code" not in write_files(results, tmp_path)
    monkeypatch.setattr(SceneResult, "specialised_module", dp)
    assert write_files(results, tmp_path)["code"].name == "double_pendulum.py"


def test_progress_is_shown_on_a_terminal_only_and_erased(tmp_path: Path) -> None:
    command = [
        sys.executable,
        "-c",
        (
            "import time\nfrom solvers.io.terminal import Progress\n"
            "with Progress() as report:\n    report('working')\n    time.sleep(1.6)\nprint('done')"
        ),
    ]
    ours, theirs = pty.openpty()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=theirs)
    plain = subprocess.run(command, capture_output=True, check=True, text=True)
    assert (plain.stdout, plain.stderr) == ("done\n", "")
    process.wait(timeout=60)
    time.sleep(0.1)
    shown = os.read(ours, 100_000).decode()
    os.close(ours)
    os.close(theirs)
    assert "working, 1 s" in shown
    assert shown.endswith("\r" + " " * 78 + "\r")


def test_axis_labels_contain_the_units_of_all_quantities() -> None:
    units = {"x": "m", "theta1": "rad", "theta2": "rad"}
    assert _labelled(["theta1", "theta2"], units) == r"$\theta_{1}$, $\theta_{2}$ / rad"
    assert _labelled(["x", "theta1"], units) == r"$x$ / m, $\theta_{1}$ / rad"
