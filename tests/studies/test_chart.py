"""Work-precision curves, their frontier, and the findings that follow from them."""

import json
import re
from dataclasses import replace
from functools import partial
from math import inf, isnan, nan
from pathlib import Path

import numpy as np
import pytest
from sharing import Shared

import generated.double_pendulum as dp
from solvers.app.cli import main
from solvers.app.commands.chart import _measured
from solvers.app.modules import load as load_module
from solvers.io.figures import save
from solvers.runge_kutta.method_catalogue import SCIPY, load
from solvers.scenes.scene import Scene
from solvers.scenes.scene_reading import find
from solvers.studies.work_precision import (
    measured_curves,
    scene_curves,
    work_precision_plots,
)
from solvers.studies.work_precision.cost_curve import (
    CostCurve,
    MeasuredRun,
    frontier,
    least_pair,
    work_at,
)
from solvers.studies.work_precision.measured_curves import TimedRun, combinations, curves, timed_run
from solvers.studies.work_precision.reference import Reference
from solvers.studies.work_precision.scene_curves import (
    RoundingLimit,
    SceneCurves,
    misleading_energy,
    record,
    rounding_limits,
    wrong_above,
)

REPORT = find("report", load_module)


@pytest.fixture(autouse=True)
def few_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measured_curves, "TOLERANCES", 10.0 ** -np.arange(1, 9))
    monkeypatch.setattr(measured_curves, "STEPS", 10 * 2 ** np.arange(12))
    # the runs must not depend on the speed of the machine
    monkeypatch.setattr(measured_curves, "LONGEST", dict.fromkeys(measured_curves.LONGEST, inf))
    monkeypatch.setattr(measured_curves, "LONGEST_REPORT", inf)


@pytest.fixture(scope="module")
def truth(shared: Shared) -> Reference:
    return shared("reference_report", lambda: Reference.of(find("report", load_module)))


@pytest.fixture
def long_truth(shared: Shared) -> Reference:
    return shared("reference_long", lambda: Reference.of(find("long", load_module)))


def point(seconds: float, error: float, energy: float = 1.0) -> MeasuredRun:
    return MeasuredRun({"rtol": error}, seconds, int(seconds * 100), error, energy)


def curve(method: str, form: str, backend: str, *points: MeasuredRun) -> CostCurve:
    return CostCurve("scene", method, form, backend, list(points))


def agrees(found: Reference, least: float) -> bool:
    """Whether references of other families differ by less than `least`."""
    is_long = np.finfo(np.longdouble).nmant > 60
    return max(found.differences.values()) < (least if is_long else 1e-6)


def test_an_independent_reference_agrees_more_closely_than_curves_need(truth: Reference) -> None:
    # curves end at 1e-13, a hundred times the error of references
    assert agrees(truth, 1e-15)


@pytest.mark.long("references of all scenes")
def test_independent_references_of_other_scenes_agree(
    truth: Reference, long_truth: Reference
) -> None:
    # curves end at 1e-7 after 20 s of chaos
    single = Reference.of(find("single", load_module))
    assert agrees(long_truth, 1e-9)
    assert agrees(single, 1e-13)
    assert max(found.global_error for found in (truth, long_truth, single)) < 1e-14


@pytest.mark.long("other tests reach its code")
def test_the_error_of_the_reference_is_estimated_with_fewer_digits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("solvers.studies.work_precision.reference.FEWER", 8)
    assert 1e-10 < Reference.of(find("report", load_module)).global_error < 1e-4


def test_the_error_of_the_reference_is_at_least_its_last_rounding(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("solvers.studies.work_precision.reference.FEWER", 32)
    single = load_module("single_pendulum")
    found = Reference.of(Scene(single, single.DEFAULTS, (-1.5, -3.0), 0.25))
    assert [*found.differences] == ["extrapolated midpoint rule", "elliptic functions"]
    assert found.end.max() < 0  # the largest number is negative
    assert found.global_error == np.spacing(np.abs(found.end).max())


@pytest.mark.long("a whole study")
def test_curves_contain_the_error_relative_to_the_reference(truth: Reference) -> None:
    wanted = [
        ("rk4", "lagrangian", "compiled"),
        ("verner853", "rational", "compiled"),
        ("dp54", "hamiltonian", "python"),
        ("DOP853", "lagrangian", "scipy"),
    ]
    found = curves(find("report", load_module), truth, wanted)
    assert [(c.method, c.form, c.backend) for c in found] == wanted
    for c in found:
        errors = [p.global_error for p in c.points]
        assert min(errors) < 1e-3 < max(errors)
        assert all(a.work_rhs < b.work_rhs for a, b in zip(c.points, c.points[1:], strict=False))
        for p in c.points:
            assert p.work_seconds > 0
            # a right trajectory has the right energy; the converse is false
            assert p.energy_error < 10 * p.global_error
    # the curve shows the order of the method, and the error of the run
    rk4 = found[0].points
    late = [p for p in rk4 if 1e-9 < p.global_error < 1e-4]
    order = np.log(late[0].global_error / late[-1].global_error) / np.log(
        late[0].setting["h"] / late[-1].setting["h"]
    )
    assert order == pytest.approx(4, abs=0.5)
    run = timed_run(
        dp,
        dp.DEFAULTS,
        REPORT.y0,
        5.0,
        method="rk4",
        form="lagrangian",
        backend="compiled",
        h=rk4[-1].setting["h"],
    )
    assert run
    assert np.abs(run.end - truth.end).max() == rk4[-1].global_error
    assert 4 * run.steps <= rk4[-1].work_rhs == run.work_rhs <= 4 * run.steps + 1


def test_every_method_form_and_backend_is_charted() -> None:
    found = set(combinations(dp))
    assert {("verner98", "rational", b) for b in ("compiled", "python")} <= found
    assert {method for method, _, backend in found if backend == "scipy"} == {*SCIPY}
    assert ("gauss2", "hamiltonian", "compiled") in found
    assert ("gauss2", "rational", "compiled") not in found  # no Jacobian
    assert len(found) == len(list(combinations(dp))) == 15 * 3 * 2 + 8 * 2 * 2 + 6 * 3


def test_runs_with_a_large_error_are_left_out(truth: Reference) -> None:
    point_of = partial(measured_curves.point, find("report", load_module), truth)
    options = {"method": "rk4", "form": "lagrangian", "backend": "compiled"}
    run = timed_run(dp, dp.DEFAULTS, REPORT.y0, 5.0, h=0.1, **options)
    assert run
    assert point_of({"h": 0.1}, run.work_seconds, run.work_rhs, run.end)
    assert point_of({}, 1.0, None, np.full(4, nan)) is None
    assert point_of({}, 1.0, None, run.end + 11) is None
    # the error of a run is not known below that of the reference
    exact = point_of({}, 1.0, None, truth.end)
    assert exact
    assert exact.global_error == truth.global_error


def test_work_is_interpolated_and_lucky_runs_do_not_count() -> None:
    errors, works = [1e-2, 1e-4, 1e-6], [1.0, 10.0, 100.0]
    assert work_at(1e-3, errors, works) == pytest.approx(10**0.5)
    assert isnan(work_at(1e-7, errors, works))
    assert isnan(work_at(1.0, errors, works))
    # the second run is lucky: a dearer one has a larger error
    lucky = [1e-2, 1e-9, 1e-3, 1e-10], [*works, 1000.0]
    assert work_at(1e-4, *lucky) == pytest.approx(100 ** (6 / 7) * 1000 ** (1 / 7))
    assert work_at(2e-3, *lucky) == pytest.approx(10 ** (1 - np.log10(2)))
    # even the least error is luck if no other run has it
    assert work_at(1e-6, [1e-2, 1e-3, 1e-7, 1e-5, 1e-6], [1, 2, 3, 4, 5]) == pytest.approx(5)
    assert isnan(work_at(1e-6, [*errors, 1e-5], [*works, 1e3]))
    # runs dearer than the two best neighbours do not count
    assert work_at(2e-6, [*errors, 2e-6, 1e-5], [*works, 1e3, 1e4]) == pytest.approx(100)
    assert isnan(work_at(1e-6, [], []))


def test_a_single_run_has_its_own_work() -> None:
    assert least_pair([1e-3]) == 0
    assert work_at(1e-3, [1e-3], [5.0]) == pytest.approx(5.0)
    assert isnan(work_at(1e-4, [1e-3], [5.0]))


def test_the_frontier_contains_the_cheapest_and_the_cost_of_alternatives() -> None:
    found = frontier([
        curve("a", "x", "c", point(1, 1e-1), point(10, 1e-3)),
        curve("a", "x", "p", point(100, 1e-1), point(1000, 1e-3)),
        curve("b", "x", "c", point(3, 1e-1), point(6, 1e-3)),
        curve("b", "y", "c", point(2, 1e-1), point(30, 1e-3)),
    ])  # fmt: skip
    rough, middle, fine = found
    assert [b.global_error for b in found] == [1e-1, 1e-2, 1e-3]
    assert (rough.method, rough.form, rough.backend) == ("a", "x", "c")
    assert rough.cost_ratios == {
        "method": {"b": pytest.approx(2)},
        "form": {"y": pytest.approx(2)},
        "backend": {"p": pytest.approx(100)},
    }
    assert (fine.method, fine.work_seconds, fine.work_rhs) == ("b", 6, 600)
    assert fine.cost_ratios["method"] == {"a": pytest.approx(10 / 6)}
    assert middle.method == "a"  # 10^(1/2) against 18^(1/2)


def test_shorter_steps_are_better_until_rounding_dominates() -> None:
    def rk4(h: float) -> MeasuredRun:
        return MeasuredRun({"h": h}, 1 / h, int(1 / h), h**4 + 1e-16 / h, 1.0)

    steps = 2.0 ** -np.arange(2, 18)
    (found,) = rounding_limits([curve("rk4", "lagrangian", "compiled", *map(rk4, steps))])
    assert found.order == pytest.approx(4, abs=0.1)
    assert found.h == pytest.approx((1e-16 / 4) ** (1 / 5), rel=0.5)
    assert found.finest_error > 10 * found.global_error
    # Euler's method, whose error does not fall yet
    flat = [MeasuredRun({"h": h}, 1 / h, int(1 / h), 1.0, 1.0) for h in steps]
    (none,) = rounding_limits([curve("rk1", "lagrangian", "compiled", *flat)])
    assert isnan(none.order)


def test_a_rounding_limit_says_where_rounding_begins() -> None:
    limit = RoundingLimit("rk4", 1e-3, 1e-12, 1e-5, 3e-11, 4.0)
    assert "at h = 1.0e-03 s; by rounding it is 3.0e-11 at 1.0e-05 s" in str(limit)
    assert str(replace(limit, finest_error=1.5e-12)).endswith("at the shortest step, 1.0e-05 s")
    assert "no observed order" in str(replace(limit, order=nan))


@pytest.mark.long("a whole study")
def test_in_the_report_s_scene_rounding_limits_rk4(
    truth: Reference, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(measured_curves, "STEPS", 10 * 2 ** np.arange(19))
    found = curves(find("report", load_module), truth, [("rk4", "lagrangian", "compiled")])
    (limit,) = rounding_limits(found)
    assert limit.order == pytest.approx(load("rk4").order, abs=0.3)
    assert 1e-6 < limit.h < 1e-3
    assert limit.global_error < 1e-11
    assert limit.finest_error > 2 * limit.global_error


@pytest.mark.long("a whole study")
def test_a_small_energy_error_can_be_misleading(
    long_truth: Reference, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(measured_curves, "TOLERANCES", 10.0 ** -np.arange(1, 14))
    one = find("long", load_module)
    wanted = [("gauss2", "hamiltonian", "compiled"), ("verner98", "rational", "compiled")]
    found = curves(one, long_truth, wanted)
    case = misleading_energy(found, one, long_truth)
    assert case
    assert case.energy_error < 1e-7
    assert case.global_error > wrong_above(one, long_truth) == 0.1
    right = [c for c in found if c.method == "verner98"]
    right = [replace(right[0], points=[p for p in right[0].points if p.global_error < 0.1])]
    assert misleading_energy(right, one, long_truth) is None
    # in small motion a small error is large
    small = find("small", load_module)
    assert wrong_above(small, Reference.of(small)) < 0.01


def test_runs_with_the_least_energy_errors_are_integrated_again(
    truth: Reference, monkeypatch: pytest.MonkeyPatch
) -> None:
    errors = 10.0 ** -np.arange(1, 9)  # the least is the last
    runs = curve("rk4", "lagrangian", "compiled", *(point(1.0, 1.0, float(e)) for e in errors))
    monkeypatch.setattr(scene_curves, "CANDIDATES", 1)
    integrated = []
    monkeypatch.setattr(
        scene_curves, "_largest_energy_error",
        lambda _scene, _curve, setting: integrated.append(setting["rtol"]) or 1e-5,
    )  # fmt: skip
    points = [replace(one, setting={"rtol": one.energy_error}) for one in runs.points]
    assert misleading_energy([replace(runs, points=points)], REPORT, truth)
    assert integrated == [errors[-1]]


def test_tolerances_of_scipy_end_where_it_refuses_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measured_curves, "TOLERANCES", 10.0 ** -np.arange(12, 16))
    finest = {
        backend: measured_curves._settings(method, backend, 1.0)[-1]["rtol"]
        for method, backend in (("DOP853", "scipy"), ("dop853", "compiled"))
    }
    assert finest == {"scipy": 1e-13, "compiled": 1e-15}


def test_a_large_energy_error_is_not_misleading(truth: Reference) -> None:
    found = curves(find("report", load_module), truth, [("rk1", "lagrangian", "compiled")])
    assert min(p.energy_error for p in found[0].points) < 1
    assert misleading_energy(found, find("report", load_module), truth) is None


def test_energy_that_a_force_changes_is_not_misleading() -> None:
    driven = load_module("driven_pendulum")
    scene = Scene(driven, driven.DEFAULTS, (1.0, 0.0), 1e-6)
    assert measured_curves.unit_of_energy(scene).is_relative
    wrong = CostCurve("s", "dop853", "lagrangian", "compiled", [point(1.0, 1e-3, 0.0)])
    wrong = replace(wrong, points=[replace(wrong.points[0], global_error=1.0)])
    truth = Reference(np.array(scene.y0), 1e-15, {})
    assert misleading_energy([wrong], scene, truth) is None


@pytest.mark.parametrize(("combination", "longest"), [
    (("rk4", "lagrangian", "compiled"), 0.5),  # of the report: until rounding dominates
    (("rk4", "rational", "compiled"), 0.02),
    (("rk4", "lagrangian", "python"), 0.1),
    (("rk4_38", "lagrangian", "compiled"), 0.02),
])  # fmt: skip
def test_a_curve_ends_where_the_next_run_would_take_too_long(
    combination: tuple[str, str, str],
    longest: float,
    truth: Reference,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    limits = {"compiled": 0.02, "python": 0.1, "scipy": 0.1}
    monkeypatch.setattr(measured_curves, "LONGEST", limits)
    monkeypatch.setattr(measured_curves, "LONGEST_REPORT", 0.5)

    def run(*_: object, h: float, **__: object) -> TimedRun:
        return TimedRun(1e-3 / h, 1, 1, truth.end)  # proportional to the number of steps

    monkeypatch.setattr(measured_curves, "timed_run", run)
    (one,) = curves(REPORT, truth, [combination])
    *_, before, last = (p.work_seconds for p in one.points)
    assert before == last / 2 <= longest / 2 < last <= longest


SCENES = {
    "driven_pendulum": "theta = '1 rad'",
    "henon_heiles": "x = '0.1 m'\ny = '0.2 m'\nx_dot = '0.3 m/s'",
    "rotating_hoop": "theta = '1 rad'",
    "swinging_atwood": "r = '1 m'\ntheta = '1 rad'",
}


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("system", SCENES)
def test_systems_of_every_kind_are_charted(
    system: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # driven, without an angle, the state of the single pendulum, no known equilibrium
    wanted = [("dop853", "lagrangian", "compiled"), ("gauss2", "hamiltonian", "compiled")]
    monkeypatch.setattr(measured_curves, "combinations", lambda _: wanted)
    path = tmp_path / f"{system}.toml"
    path.write_text(f"system = '{system}'\nduration = '0.2 s'\n[initial]\n{SCENES[system]}\n")
    assert main(["chart", str(path), "--json", "--output", str(tmp_path)]) == 0
    found = json.loads(capsys.readouterr().out)
    one = found["reference"]["scenes"][system]
    assert one["global_error"] < 1e-14
    assert max(one["differences"].values()) < 1e-12
    assert [c["method"] for c in found["curves"]] == ["dop853", "gauss2"]
    for c in found["curves"]:
        last = c["points"][-1]
        assert last["global_error"] < 1e-7
        assert last["energy_error"] < 100 * last["global_error"]  # of 1 m or 1 rad, and in J
    # the hoop starts below its equilibrium at the bottom, which is unstable
    unit = "J" if system in ("swinging_atwood", "rotating_hoop") else "energy above rest"
    assert found["energy_error_units"] == {system: unit}
    runs = [curve("dop853", "lagrangian", "compiled", point(1.0, 1e-3))]
    figure = work_precision_plots.energy(
        "", runs, 0.1, measured_curves.unit_of_energy(find(str(path), load_module))
    )
    assert figure.axes[0].get_xlabel() == f"energy error at the end / {unit}"


def test_plots_and_summary_show_the_measurements(truth: Reference, tmp_path: Path) -> None:
    wanted = [
        ("rk4", "lagrangian", "compiled"),
        ("verner853", "rational", "compiled"),
        ("verner853", "rational", "python"),
        ("DOP853", "rational", "scipy"),
    ]
    found = curves(find("report", load_module), truth, wanted)
    study = SceneCurves.of(find("report", load_module), truth, found)
    figures = study.plots()
    assert [*figures] == ["work_precision_report", "steps_report", "energy_report"]
    for name, figure in figures.items():
        assert sum(len(axes.lines) for axes in figure.axes) >= 1
        save(figure, tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").stat().st_size > 10_000
    text = "\n".join(study.summary())
    assert "reference: Taylor series, 32 digits, own error" in text
    assert "verner853, rational " in text
    assert "rk4: error falls as h^4" in text


def test_a_record_measures_compiled_loops_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    wanted = [("rk4", "lagrangian", backend) for backend in ("compiled", "python")]
    monkeypatch.setattr(measured_curves, "combinations", lambda _: wanted)
    monkeypatch.setattr(measured_curves, "STEPS", 10 * 2 ** np.arange(6))
    single = load_module("single_pendulum")
    scene = Scene(single, single.DEFAULTS, (1.0, 0.0), 0.2)
    full, compiled = (_measured(scene, compiled_only=only) for only in (False, True))
    assert [one.backend for one in full.curves] == ["compiled", "python"]
    assert [one.backend for one in compiled.curves] == ["compiled"]
    (row,) = json.loads(record([full]))
    assert {point["backend"] for point in row["frontier"]} == {"compiled"}
    assert (row["scene"], row["system"], row["duration"]) == ("scene", "single_pendulum", 0.2)
    assert row["spread"] == 1


@pytest.mark.long("a whole study")
def test_the_command_prints_curves_reference_and_frontier(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wanted = [("rk4", "lagrangian", "compiled"), ("verner853", "rational", "compiled")]
    monkeypatch.setattr(measured_curves, "combinations", lambda _: wanted)
    assert main(["chart", "report", "single", "--json", "--output", str(tmp_path)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert {(c["scene"], c["method"], c["form"], c["backend"]) for c in found["curves"]} == {
        (name, *combination) for name in ("report", "single") for combination in wanted
    }
    for c in found["curves"]:
        keys = {"work_seconds", "work_rhs", "global_error", "energy_error"}
        assert all(keys <= set(p) for p in c["points"])
    assert found["reference"]["method"] == "Taylor series, 32 digits"
    assert 0 < found["reference"]["global_error"] < 1e-14
    assert {row["method"] for row in found["frontier"]} <= {"rk4", "verner853"}
    assert {Path(path).name for path in found["pictures"]} == {p.name for p in tmp_path.iterdir()}
    assert main(["chart", "singel"]) == 2
    assert "did you mean 'single'" in capsys.readouterr().err
    file = tmp_path / "measured.json"
    monkeypatch.setattr("solvers.integration.accuracy.method_choice.RECORD", file)
    assert main(["chart", "single", "--record", "--output", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert "single pendulum from 2 rad, 10 s" in text
    assert "plots: " in text
    assert {method for method, *_ in wanted} == {*re.findall("rk4|verner853", file.read_text())}


@pytest.mark.long("a whole study")
def test_a_scene_that_fails_loses_no_other(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        measured_curves, "combinations", lambda _: [("rk4", "lagrangian", "compiled")]
    )
    reference = Reference.of

    def fails(scene: Scene) -> Reference:
        if scene.name == "report":
            raise ArithmeticError("the equations are not finite")
        return reference(scene)

    monkeypatch.setattr(Reference, "of", fails)
    assert main(["chart", "single", "report", "--json", "--output", str(tmp_path)]) == 3
    output, errors = capsys.readouterr()
    assert "the equations are not finite" in errors
    found = json.loads(output)
    assert [c["scene"] for c in found["curves"]] == ["single"]
    assert [*found["reference"]["scenes"]] == ["single"]
