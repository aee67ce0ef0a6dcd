"""Stability functions are exact, and running steppers obey them."""

import json
from fractions import Fraction
from functools import partial
from math import inf, log, sqrt
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from numpy.polynomial import polynomial

import generated.double_pendulum as dp
import generated.elastic_pendulum as ep
import generated.single_pendulum as sp
from solvers.app.cli import main
from solvers.app.modules import load as load_module
from solvers.equations.linearisation.normal_modes import Modes, local_eigenvalues
from solvers.integration.integrate import integrate
from solvers.integration.problem.status import Status
from solvers.runge_kutta.method_catalogue import load, names
from solvers.runge_kutta.stability_function import StabilityFunction, nonnegative_interval
from solvers.runge_kutta.stepper import Stepper
from solvers.scenes.scene_reading import find
from solvers.studies import stability
from solvers.studies.failure_modes import study
from solvers.studies.failure_modes.chaos import Chaos, ChaosResults
from solvers.studies.stability import (
    CriticalStep,
    SceneStability,
    boundaries,
    critical_step,
    limit,
    regions,
)

F = Fraction
RUNGE_KUTTA = [name for name in names() if not load(name).is_splitting]


@pytest.mark.parametrize("method", RUNGE_KUTTA)
def test_a_step_of_the_linear_test_equation_multiplies_by_the_stability_function(
    method: str,
) -> None:
    function = StabilityFunction.of(load(method))
    for z in (0.3j, 1.7j, -0.8, -1.1 + 0.9j):
        # y' = λy as a real system
        matrix = np.array([[z.real, -z.imag], [z.imag, z.real]])
        stepper = Stepper(load(method), lambda _, y, A=matrix: A @ y, lambda _, y, A=matrix: A)
        start = np.array([1.0, 0.0])
        end, *_ = stepper.step(0.0, start, 1.0, stepper.derivative(0.0, start))
        assert complex(*end) == pytest.approx(complex(function(z)), rel=1e-12)


@pytest.mark.parametrize("method", RUNGE_KUTTA)
def test_the_stability_function_agrees_with_the_exponential_to_the_order(method: str) -> None:
    tableau, function = load(method), StabilityFunction.of(load(method))
    order = tableau.order
    # P - exp Q vanishes up to z^order and no further, in exact fractions
    P, Q = function.numerator, function.denominator
    exponential = [F(1)]
    for k in range(1, order + 2):
        exponential.append(exponential[-1] / k)

    def defect(k: int) -> Fraction:
        return (P[k] if k < len(P) else F(0)) - sum(
            exponential[k - j] * q for j, q in enumerate(Q) if j <= k
        )

    assert all(defect(k) == 0 for k in range(order + 1))
    assert defect(order + 1) != 0


def test_intervals_are_those_of_the_textbooks() -> None:
    # imaginary: E. Hairer, G. Wanner, section IV.2 and exercises; sqrt(3) and 2 sqrt(2) by hand
    found = {name: StabilityFunction.of(load(name)) for name in names()}
    for name, interval in {
        "rk1": 0.0,
        "midpoint": 0.0,
        "heun": 0.0,
        "ralston": 0.0,
        "rk3": sqrt(3),
        "bs32": sqrt(3),
        "rk4": 2 * sqrt(2),
        "rk4_38": 2 * sqrt(2),
        "gauss1": inf,
        "gauss2": inf,
        "gauss3": inf,
        "radau2": inf,
        "radau3": inf,
    }.items():
        assert found[name].imaginary_stability_interval == pytest.approx(interval, rel=1e-14), name
    for name, interval in {
        "rk1": 2.0,
        "midpoint": 2.0,
        "rk3": 2.5127453266183286,
        "rk4": 2.7852935634052817,
        "dp54": 3.3065678926,
        "gauss3": inf,
        "radau3": inf,
    }.items():
        assert found[name].real_stability_interval == pytest.approx(interval, rel=1e-10), name


@pytest.mark.parametrize("method", RUNGE_KUTTA)
def test_intervals_end_where_the_stability_function_leaves_the_unit_circle(method: str) -> None:
    function = StabilityFunction.of(load(method))
    for direction, interval in (
        (1j, function.imaginary_stability_interval),
        (-1.0, function.real_stability_interval),
    ):
        inside = np.linspace(0, min(interval, 100.0), 2001)
        assert np.abs(function(inside * direction)).max() <= 1 + 1e-13
        if interval < inf:
            beyond = max(interval * 1.01, 1.0)
            assert np.abs(function(beyond * direction)) > 1 + 1e-11


def test_a_fall_is_found_exactly_among_touches() -> None:
    assert nonnegative_interval([F(1), F(-2), F(1)]) == inf  # (1 - x)²
    assert nonnegative_interval([F(2), F(-5), F(4), F(-1)]) == 2.0  # (1 - x)² (2 - x)
    assert nonnegative_interval([F(0), F(0), F(-1)]) == 0.0
    assert nonnegative_interval([F(0)]) == nonnegative_interval([F(0), F(3)]) == inf
    generator = np.random.default_rng(0)
    for _ in range(100):
        roots = generator.integers(-6, 7, generator.integers(1, 7))
        sign = generator.choice([-1, 1])
        p = [F(int(c)) * int(sign) for c in polynomial.polyfromroots(roots)]
        ends = [0, *sorted({int(r) for r in roots if r > 0})]
        middles = [(a + b) / 2 for a, b in zip(ends, [*ends[1:], ends[-1] + 2], strict=True)]
        values = [sign * np.prod([m - r for r in roots]) for m in middles]
        expected = next((a for a, value in zip(ends, values, strict=True) if value < 0), inf)
        assert nonnegative_interval(p) == pytest.approx(expected, rel=1e-15)


@pytest.mark.long("a whole study")
def test_the_command_prints_every_method_of_the_scenes(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stability, "names", lambda: ("gauss1", "rk1", "rk4"))
    assert main(["stability", "single", "light_above", "--json", "--output", str(tmp_path)]) == 0
    found = json.loads(capsys.readouterr().out)
    keys = ("scene", "method", "order", "imaginary_stability_interval", "critical_step_predicted")
    assert [tuple(row[key] for key in keys) for row in found["methods"][:3]] == [
        ("single", "gauss1", 2, None, None),
        ("single", "rk1", 1, 0.0, 0.0),
        ("single", "rk4", 4, pytest.approx(2 * sqrt(2)), pytest.approx(sqrt(8 * 2 / 9.81))),
    ]
    assert [row["scene"] for row in found["methods"]] == ["single"] * 3 + ["light_above"] * 3
    for row in found["methods"]:
        expected = row["critical_step_predicted"]
        assert row["critical_step_measured"] == (expected and pytest.approx(expected, rel=1e-2))
    assert found["methods"][2]["stability_function"]["numerator"] == [
        "1",
        "1",
        "1/2",
        "1/6",
        "1/24",
    ]
    assert found["failures"] == {}
    assert {Path(path).name for path in found["pictures"]} == {
        path.name for path in tmp_path.iterdir()
    }
    assert main(["stability", "repotr"]) == 2
    assert "did you mean 'report'" in capsys.readouterr().err


def test_only_without_scenes_the_command_runs_the_studies_of_failures(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    failures = SimpleNamespace(
        name="planted",
        run=lambda _: 7,
        summary=lambda n: [f"{n} failures"],
        plot=lambda _: Figure(),
    )
    monkeypatch.setattr(stability, "names", lambda: ("rk4",))
    monkeypatch.setattr(SceneStability, "plot", lambda _: Figure())
    monkeypatch.setattr(study, "studies", lambda: [failures])
    assert main(["stability", "single", "--json", "--output", str(tmp_path)]) == 0
    assert json.loads(capsys.readouterr().out)["failures"] == {}
    assert main(["stability", "--output", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert f"7 failures\nplot: {tmp_path / 'failures_planted.png'}" in text
    assert "Longest stable steps of the report's scene" in text


@pytest.mark.long("all studies of failures")
@pytest.mark.slow
def test_without_a_scene_the_command_studies_where_methods_fail(
    chaotic: ChaosResults,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(stability, "names", lambda: ("rk1", "rk4"))
    monkeypatch.setattr(Chaos, "run", lambda *_: chaotic)  # which tests of failures use, too
    monkeypatch.setattr(study, "studies", partial(study.studies, small=True))
    assert main(["stability", "--output", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    for line in (
        "Longest stable steps of the report's scene",
        "largest Lyapunov exponent 0.8",
        "implicit methods cost less from a ratio of",
        "Relative energy error",
        "Aligned rods",
        "released upright",
        "Achieved over requested",
    ):
        assert line in text
    drawn = {path.name for path in tmp_path.iterdir()}
    plots = {f"failures_{name}.png" for name in ("drift", "chaos", "tolerances")}
    assert {"stability_report.png", *plots} <= drawn


@pytest.mark.parametrize(("method", "growth"), [("rk1", log(2) / 2), ("midpoint", log(5 / 4) / 2)])
def test_growth_is_probed_at_one_radian_a_step_where_no_step_is_stable(
    method: str, growth: float
) -> None:
    # |1 + i|² = 2 of Euler's method, and |1 + i - 1/2|² = 5/4
    found = critical_step(method, sp, sp.DEFAULTS)
    assert found.measured == 0
    assert found.probe == pytest.approx(sqrt(sp.DEFAULTS[1] / sp.DEFAULTS[2]))
    assert found.growth_predicted == pytest.approx(growth, abs=1e-12)
    assert found.growth_measured == pytest.approx(growth, abs=1e-4)


def test_growth_is_probed_a_little_beyond_the_longest_stable_step() -> None:
    found = critical_step("rk4", sp, sp.DEFAULTS)
    assert found.measured < found.probe < 1.1 * found.measured
    assert found.growth_predicted > 0
    assert found.growth_measured == pytest.approx(found.growth_predicted, rel=1e-3)


@pytest.mark.long("critical steps of all methods")
@pytest.mark.parametrize("method", [name for name in RUNGE_KUTTA if not load(name).lower])
def test_the_critical_step_is_what_the_interval_predicts(
    method: str, report_steps: dict[str, CriticalStep]
) -> None:
    found = report_steps[method]
    tableau = load(method)
    if tableau.is_parallel:
        # the method is stable, but its iteration contracts by the spectral radius of A
        fastest = Modes.at_rest(dp, dp.DEFAULTS).frequencies[-1]
        contracts = 1 / (np.abs(np.linalg.eigvals(np.array(tableau.A, float))).max() * fastest)
        assert found.predicted == inf
        assert 0.4 * contracts < min(found.linear, found.measured)
        assert max(found.linear, found.measured) < contracts
        return
    if found.predicted in (0.0, inf):
        assert found.linear == found.measured == found.predicted
    else:
        assert found.linear == pytest.approx(found.predicted, rel=1e-3)
        assert found.measured == pytest.approx(found.predicted, rel=1e-3)
    assert found.growth_measured == pytest.approx(found.growth_predicted, rel=1e-6, abs=1e-13)


@pytest.mark.long("other tests reach its code")
def test_another_system_has_other_critical_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    stiff = (1.0, 1e4, 1.0, 9.81)  # the spring's own frequency is 100 rad/s
    found = critical_step("rk4", ep, stiff)
    assert found.measured == pytest.approx(2 * sqrt(2) / 100, rel=1e-3)
    # a method that is not the one of the prediction would be found out
    monkeypatch.setattr(
        stability,
        "integrate",
        lambda *args, **options: integrate(*args, **(options | {"method": "rk3"})),
    )
    other = critical_step("rk4", ep, stiff)
    assert other.linear == pytest.approx(other.predicted, rel=1e-3)
    assert other.measured == pytest.approx(sqrt(3) / 100, rel=1e-3)


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("method", ["gauss1", "rk4", "dop853", "verner98"])
def test_rounding_at_a_stretched_equilibrium_is_no_growth(method: str) -> None:
    # small motion of a spring of 1.1 m: its states are rounded to 1e-16 m, not to 1e-16 of 1e-7 m
    assert ep.equilibrium(ep.DEFAULTS)[0] > 1
    found = critical_step(method, ep, ep.DEFAULTS)
    assert found.predicted > 0
    assert found.measured == pytest.approx(found.predicted, rel=1e-3)


def test_limits_are_bisected_whatever_the_growth() -> None:
    assert limit(lambda h: h - 0.7, 1.0) == pytest.approx(0.7, rel=2e-4)
    assert limit(lambda h: 1.0, 1.0) == 0.0
    assert limit(lambda h: -1.0, 1.0) == inf


def test_modes_without_inertia_are_refused_in_words() -> None:
    with pytest.raises(ValueError, match="the mass matrix is not positive definite"):
        Modes.at_rest(sp, (1.0, 0.0, 9.81))


def test_modes_are_those_of_the_textbook() -> None:
    # equal masses and lengths: omega² = (2 ∓ sqrt(2)) g/l (L. D. Landau, E. M. Lifshitz, § 23)
    modes = Modes.at_rest(dp, dp.DEFAULTS)
    assert modes.frequencies**2 == pytest.approx((2 + np.array([-1, 1]) * sqrt(2)) * 9.81 / 2)
    assert modes.shapes.T @ modes.mass_matrix @ modes.shapes == pytest.approx(np.eye(2), abs=1e-15)
    eigenvalues = np.sort_complex(np.linalg.eigvals(modes.matrix))
    assert np.abs(eigenvalues.real).max() < 1e-14
    rest = local_eigenvalues(dp, dp.DEFAULTS, np.zeros((1, 4)))[0]
    assert np.sort(rest.imag) == pytest.approx(np.sort(eigenvalues.imag))
    with pytest.raises(ValueError, match="about rest with m = 1, l = 2, g = -10: squared"):
        Modes.at_rest(sp, (1.0, 2.0, -10.0))


@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_motion_damped_to_nothing_is_still_a_motion(backend: str) -> None:
    # Radau's method damps fast oscillations: after 250 steps a number has lost its digits
    run = integrate(
        sp, (0, 4000), (1e-7, 0.0), sp.DEFAULTS, method="radau2", h=8.0, backend=backend
    )
    assert run.status is Status.FINISHED
    size = np.abs(run.y).max(axis=0)
    assert size[size < 1e-290][0] > 1e-300
    # what is left of the last digits depends on how the processor's linear algebra rounds
    assert size[-1] < 1e-290


def test_boundaries_are_where_nothing_grows_or_fades() -> None:
    function = StabilityFunction.of(load("rk4"))
    (panel,) = boundaries({"RK4": function}).axes
    (contour,) = (one for one in panel.collections if isinstance(one, ContourSet))
    points = np.concatenate([path.vertices for path in contour.get_paths()])
    size = np.abs(function(points[:, 0] + 1j * points[:, 1]))
    assert len(points) > 100
    assert np.abs(size - 1).max() < 0.02
    axes = [[*zip(*line.get_data(), strict=True)] for line in panel.lines]
    assert sorted(axes) == [[(0, 0), (0, 1)], [(0, 0), (1, 0)]]  # through the origin


def test_regions_have_modes_and_motions_in_units_of_the_critical_step() -> None:
    """Against the interval of rk4 on the imaginary axis, and |R| at the edge of its region."""
    frequencies, eigenvalues = np.array([1.0, 4.0]), np.array([-1 + 2j, 3j])
    limits = {"rk4": sqrt(8) / 4, "rk4_38": sqrt(8) / 4, "rk1": 0.0}
    functions = {name: StabilityFunction.of(load(name)) for name in limits}
    rest = (0.0, 0.0, 1.0, 0.0, 0.0)
    steps = [CriticalStep(k, "", 1, 1, functions[k], h, *rest) for k, h in limits.items()]
    figure = regions("title", steps, frequencies, eigenvalues)
    panels = {panel.get_title(): panel for panel in figure.axes if panel.lines}
    # methods with one function share a panel; without a stable step h is 1/frequency
    expected = {"rk4, rk4_38\nh ≤ 0.707 s": sqrt(8) / 4, "rk1\nno step is stable": 1 / 4}
    assert [*panels] == [*expected]
    for panel, h in zip(panels.values(), expected.values(), strict=True):
        dots = {line.get_marker(): line.get_xydata() @ [1, 1j] for line in panel.lines}
        assert dots["."] == pytest.approx(h * eigenvalues)
        assert dots["o"] == pytest.approx(h * np.array([1j, 4j, -1j, -4j]))
    first = next(iter(panels.values()))
    filled, edge = (one for one in first.collections if isinstance(one, ContourSet))
    (area,) = filled.get_paths()
    assert area.contains_points([(-1, 0), (-2.7, 0), (-2.9, 0), (1, 0)]).tolist() == [1, 1, 0, 0]
    points = np.concatenate([path.vertices for path in edge.get_paths()])
    assert np.abs(np.abs(functions["rk4"](points @ [1, 1j])) - 1).max() < 0.02


def test_a_picture_shows_the_eigenvalues_of_the_motion_from_its_start() -> None:
    scene = find("report", load_module)
    step = critical_step("rk4", scene.module, scene.params)
    (panel,) = SceneStability(scene, [step]).plot().axes
    along = next(line for line in panel.lines if line.get_marker() == ".")
    first = step.predicted * local_eigenvalues(scene.module, scene.params, [scene.y0]).ravel()
    points = along.get_xdata()[: len(first)] + 1j * along.get_ydata()[: len(first)]
    assert points == pytest.approx(first, abs=1e-12)
