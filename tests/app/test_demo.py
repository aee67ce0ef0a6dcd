"""The demonstration: one screen of text, and one page that fits every screen and loads nothing."""

import json
import math
import re
from collections.abc import Iterator
from contextlib import redirect_stdout
from functools import partial
from io import StringIO
from math import inf
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

import generated.double_pendulum as dp
from derive.verification.report.report_judgement import EQUATIONS
from solvers.app.cli import main
from solvers.app.commands.demo import _in_two_columns
from solvers.app.demo import demo_page, equations_stage, motions_stage
from solvers.app.demo.demo_page import write_page
from solvers.app.demo.equations_stage import FUNCTIONS, generation
from solvers.app.demo.stage import Stage, table
from solvers.app.modules import load as load_module
from solvers.equations.module import operations_on_state
from solvers.integration.integrate import integrate
from solvers.scenes.scene_reading import find
from solvers.studies.work_precision import measured_curves
from solvers.studies.work_precision.cost_curve import CostCurve, MeasuredRun
from solvers.sweeps.definition import sweep_reading


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    """The terminal text and the path of the page."""
    folder = tmp_path_factory.mktemp("demo")
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(StringIO()) as screen:
        # which methods are listed must not depend on the speed of the machine
        patch.setitem(measured_curves.LONGEST, "scipy", inf)
        assert main(["demo", "--output", str(folder)]) == 0
    return screen.getvalue(), folder / "demo.html"


@pytest.fixture(params=[1280, 390])
def opened(driver: Any, demo: tuple[str, Path], request: pytest.FixtureRequest) -> Iterator[Any]:
    driver.get("about:blank")
    driver.get_log("browser")
    driver.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {
            "width": request.param,
            "height": 800,
            "deviceScaleFactor": 1,
            "mobile": False,
        },
    )
    driver.execute_cdp_cmd(
        "Emulation.setEmulatedMedia",
        {
            "features": [
                {"name": "prefers-reduced-motion", "value": "reduce"},
            ]
        },
    )
    driver.get(demo[1].as_uri())
    yield driver
    assert driver.get_log("browser") == []


@pytest.mark.long("the whole demonstration; `make demo` runs it, too")
def test_all_stages_fit_on_one_screen(demo: tuple[str, Path]) -> None:
    text, page = demo
    assert "119 verified" in text
    assert "up to date" in text
    assert "theta1 = 2.22806424" in text
    assert str(page) in text
    lines = text.splitlines()
    assert len(lines) <= 40
    assert max(len(line) for line in lines if str(page) not in line) <= 80
    assert {path.name for path in page.parent.iterdir()} == {"demo.html", "live.html", "flips"}


@pytest.mark.long("the whole demonstration")
def test_the_page_fits_every_screen_without_console_messages(opened: Any) -> None:
    wide, room = opened.execute_script(
        "for (const one of document.querySelectorAll('details')) one.open = true;"
        "return [document.documentElement.scrollWidth, innerWidth]"
    )
    assert wide <= room
    # whatever reaches beyond the screen can be moved there
    hidden = opened.execute_script("""
        const reach = (one) => one.getBoundingClientRect().right > innerWidth + 1;
        const moves = (one) => one && (getComputedStyle(one).overflowX === 'auto'
          || moves(one.parentElement));
        return [...document.querySelectorAll('main *')]
          .filter((one) => reach(one) && !moves(one)).map((one) => one.outerHTML.slice(0, 80))""")
    assert hidden == []


@pytest.mark.long("the whole demonstration")
def test_no_formula_is_cut_on_a_wide_screen(opened: Any) -> None:
    cut, width = opened.execute_script("""
        for (const one of document.querySelectorAll('details')) one.open = true;
        return [[...document.querySelectorAll('.formula')]
          .filter((one) => one.scrollWidth > one.clientWidth + 1).map((one) => one.textContent),
          innerWidth]""")
    assert cut == [] or width < 1280


@pytest.mark.long("the whole demonstration")
def test_charts_follow_the_colours_of_the_page(opened: Any) -> None:
    corner = """
        const done = arguments[0], images = [...document.querySelectorAll('img')];
        Promise.all(images.map((one) => one.decode())).then(() => done(images.map((one) => {
          const canvas = new OffscreenCanvas(one.naturalWidth, one.naturalHeight);
          const context = canvas.getContext('2d');
          context.drawImage(one, 0, 0);
          const pixels = context.getImageData(0, 0, canvas.width, canvas.height).data;
          let light = 0, dark = 0;  // opaque pixels of text and lines
          for (let k = 0; k < pixels.length; k += 4) {
            const [red, green, blue, alpha] = pixels.slice(k, k + 4);
            if (alpha > 200 && red === green && green === blue && red < 100) dark += 1;
            if (alpha > 200 && red === 0xe7 && green === 0xe9 && blue === 0xeb) light += 1;
          }
          return [[...pixels.slice(0, 4)], light, dark];
        })))"""
    for scheme in ("light", "dark"):
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        opened.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
        opened.refresh()
        charts = opened.execute_async_script(corner)
        assert len(charts) == 3
        colours = opened.execute_script(
            "return ['.line p', '#numbers th']"
            ".map((one) => getComputedStyle(document.querySelector(one)).color)"
        )
        assert len({*colours}) == 1  # notes beside verdicts are as legible as heads of tables
        for pixel, light, dark in charts:
            if scheme == "light":
                assert pixel == [255, 255, 255, 255]
                assert dark > 100 > light
            else:
                assert pixel[3] == 0  # the page shows through
                assert light > 100
                assert dark == 0


@pytest.mark.long("the whole demonstration")
def test_formulas_charts_and_motion_are_rendered(opened: Any) -> None:
    sizes = opened.execute_script(
        "for (const one of document.querySelectorAll('details')) one.open = true;"
        "return [...document.querySelectorAll('math')].map("
        "(one) => Math.min(one.getBoundingClientRect().width, one.getBoundingClientRect().height))"
    )
    assert len(sizes) > 200
    assert min(sizes) > 4
    charts = opened.execute_script(
        "return [...document.querySelectorAll('img')].map((one) => one.naturalWidth)"
    )
    assert len(charts) == 3
    assert min(charts) > 300
    assert opened.execute_script("return document.querySelectorAll('#panels canvas').length") == 2


@pytest.mark.long("the whole demonstration")
def test_the_space_key_plays_a_visible_motion_and_scrolls_elsewhere(opened: Any) -> None:
    from selenium.webdriver import ActionChains

    def space() -> tuple[bool, float]:
        ActionChains(opened).send_keys(" ").perform()
        opened.execute_async_script("setTimeout(arguments[0], 400)")
        return opened.execute_script("return document.documentElement.dataset.playing"), float(
            opened.execute_script("return scrollY")
        )

    opened.execute_script("document.querySelector('#play').blur(); scrollTo(0, 0)")
    opened.execute_script("document.querySelector('#player').scrollIntoView()")
    before = opened.execute_script("return scrollY")
    assert space() == ("true", before)
    assert space() == ("false", before)
    opened.execute_script("document.querySelector('#verify').scrollIntoView()")
    before = opened.execute_script("return scrollY")
    playing, after = space()
    assert playing == "false"
    assert after > before


@pytest.mark.long("the whole demonstration")
def test_every_misprint_is_followed_by_its_correction(demo: tuple[str, Path]) -> None:
    page = demo[1].read_text(encoding="utf-8")
    verdict = page.partition("All misprints")[2].partition("</details>")[0]
    lines = re.findall(r'<div class="line misprint">', verdict)
    assert len(lines) == verdict.count("<p>should be</p>") == 23
    assert len(EQUATIONS) == 150
    for words in (
        "119</strong> hold as printed",
        "23</strong> are misprints",
        "6</strong> are definitions",
        "7</strong> cannot be tested",
    ):
        assert page.count(f"<strong>{words}") == 1


@pytest.mark.long("the whole demonstration")
def test_methods_are_ordered_by_cost_and_two_programs_agree(demo: tuple[str, Path]) -> None:
    page = demo[1].read_text(encoding="utf-8")
    rows = page.partition("<th>times as long</th>")[2].partition("</table>")[0]
    ratios = list(map(float, re.findall(r"<td>([\d.e+]+)</td></tr>", rows)))
    assert len(ratios) == 5
    assert ratios == sorted(ratios)
    assert ratios[0] == 1
    apart = re.findall(r"two programs after 5 s</td><td>(\S+) rad or rad/s", page)
    assert 0 < float(apart[0]) < 1e-9


@pytest.mark.long("the whole demonstration")
def test_every_number_states_its_method_and_command(demo: tuple[str, Path]) -> None:
    page = demo[1].read_text(encoding="utf-8")
    rows = re.findall(r"<tr>(.*?)</tr>", page.partition('id="numbers"')[2])[1:]
    figures = [re.findall(r"<td>(.*?)</td>", row) for row in rows]
    figures = [cells for cells in figures if len(cells) == 4]
    assert len(figures) >= 8
    assert all(map(all, figures))
    assert all(cells[3].startswith("holonomic ") for cells in figures)


def test_operation_counts_equal_those_of_the_generated_module() -> None:
    assert {name: dp.OPERATIONS[name][0] for name in FUNCTIONS} == {
        "rhs": 32,
        "rhs_hamiltonian": 35,
        "rhs_rational": 39,
        "rhs_variational": 77,
        "jacobian": 84,
        "energy": 26,
    }
    assert operations_on_state(dp, "rhs_rational") == 34


def test_the_numbers_of_the_motion_are_its_largest_errors() -> None:
    scene = find("report", load_module)
    stage = motions_stage.motion(scene)
    difference, change = (number.value for number in stage.numbers)
    run = partial(integrate, dp, (0, 5), scene.y0, dp.DEFAULTS, method="verner98", energy=True)
    fine = run(rtol=1e-12, atol=1e-12, t_eval=scene.times)
    above_rest = fine.energy[0] - dp.energy(0.0, (0, 0, 0, 0), dp.DEFAULTS)
    error = np.abs(fine.energy - fine.energy[0]).max() / above_rest
    assert change == f"{error:.1e}"
    other = solve_ivp(
        dp.rhs, (0, 5), scene.y0, "DOP853", rtol=1e-12, atol=1e-12, args=(dp.DEFAULTS,)
    )
    apart = np.abs(fine.y[:, -1] - other.y[:, -1]).max()
    assert difference == f"{apart:.1e} rad or rad/s"
    assert stage.lines[0].startswith("after 5 s: theta1 = 2.22806424")
    text = f"difference from SciPy's DOP853 {apart:.1g}, energy error {error:.1g}"
    assert stage.lines[2] == text
    assert 1e-13 < apart < 1e-9


def test_methods_are_listed_by_their_cost_for_the_same_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of three curves: two reach the error, midway between two runs."""

    def curve(method: str, seconds: float, *errors: float) -> CostCurve:
        runs = [MeasuredRun({}, seconds * 100**k, None, error, 0.0)
                for k, error in enumerate(errors)]  # fmt: skip
        form, backend = ("rational", "compiled") if method != "RK45" else ("lagrangian", "scipy")
        return CostCurve("report", method, form, backend, runs)

    measured = [curve("RK45", 2.5e-3, 1e-5, 1e-7), curve("rk1", 1e-6, 1e-1, 1e-2),
                curve("verner98", 2e-6, 1e-5, 1e-7)]  # fmt: skip
    reference = SimpleNamespace(METHOD="a series", global_error=3e-14)
    monkeypatch.setattr(motions_stage, "curves", lambda *_: measured)
    monkeypatch.setattr(motions_stage.Reference, "of", lambda _: reference)
    monkeypatch.setattr(motions_stage, "svg_image", lambda *_: "image")
    stage = motions_stage.cost(find("report", load_module))
    assert stage.lines == (
        "an error of 1e-06 takes Verner 9(8) 20 µs;", "SciPy RK45 1250 ×",
    )  # fmt: skip
    assert "<td>Verner 9(8)</td><td>1</td></tr><tr><td>SciPy RK45</td><td>1250</td>" in stage.html
    (number,) = stage.numbers
    assert number.value == "Verner 9(8) 20 µs; SciPy RK45 1250 ×"
    assert "errors against a series, own error 3e-14" in number.method
    assert number.command == "holonomic chart report"
    assert [motions_stage._ratio(value) for value in (3.14159, 99.96, 100.4)] == [
        "3.14", "100", "100",
    ]  # fmt: skip
    (panel,) = motions_stage._work_precision(measured).axes
    for line, one in zip(panel.lines, measured, strict=True):
        seconds = [run.work_seconds for run in one.points]
        assert line.get_xdata() == pytest.approx(seconds)
        assert line.get_ydata() == pytest.approx([run.global_error for run in one.points])
        assert line.get_linestyle() == ("--" if one.method == "RK45" else "-")


def test_the_longest_stable_steps_are_those_of_the_fastest_oscillation(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    fastest = math.sqrt((2 + math.sqrt(2)) * 9.81 / 2)  # two equal rods of 2 m
    rk4 = SimpleNamespace(predicted=0.123456, measured=0.123789)
    monkeypatch.setattr(motions_stage, "critical_step", lambda *_: rk4)
    monkeypatch.setattr(motions_stage, "LISTED", ("rk1", "rk3", "rk4", "gauss1"))
    monkeypatch.setattr(motions_stage, "PLOTTED", {"rk1": "Euler"})
    monkeypatch.setattr(motions_stage, "boundaries", list)
    monkeypatch.setattr(motions_stage, "svg_image", lambda *_: "image")
    stage = motions_stage.limits(find("report", load_module))
    cells = re.findall(r"<tr><td>(\w+): .*?</td><td>(\d)</td><td>(.*?)</td></tr>", stage.html)
    assert cells == [
        ("rk1", "1", "none"),
        ("rk3", "3", f"{math.sqrt(3) / fastest:.4g} s"),
        ("rk4", "4", f"{math.sqrt(8) / fastest:.4g} s"),
        ("gauss1", "2", "any"),
    ]
    words = "longest stable step of RK4: 0.12346 s predicted, 0.12379 s measured"
    assert stage.lines == (words,)
    assert [number.value for number in stage.numbers] == ["0.12346 s", "0.12379 s"]
    assert f"{fastest:.5g} rad/s" in stage.numbers[0].method


def test_the_map_of_motions_has_its_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter([10.0, 12.34])
    change = SimpleNamespace(motions=64, median=3e-7)
    results = SimpleNamespace(count={"event": 1234, "finished": 5})
    monkeypatch.setattr(motions_stage.time, "perf_counter", lambda: next(clock))
    monkeypatch.setattr(motions_stage, "sweep", lambda *_: results)
    monkeypatch.setattr(motions_stage, "convergence", lambda _: {"flip": change})
    monkeypatch.setattr(motions_stage, "figure", lambda _: Figure())
    monkeypatch.setattr(motions_stage, "png_image", lambda *_: "image")
    definition = sweep_reading.find("flips", load_module)
    stage = motions_stage.flips(definition, tmp_path)
    assert stage.html == "image"
    motions = f"{definition.motions:,} motions of {definition.duration:g} s"
    assert stage.lines == (f"{motions}: 1,234 flip (2.3 s this time)",)
    (number,) = stage.numbers
    assert number.value == "1,234"
    assert number.command == "holonomic sweep flips"
    assert number.method.startswith("64 of them repeated with rtol = ")
    assert number.method.endswith("half of the times change by less than 3e-07 s")


def test_the_derivation_prints_equations_that_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    """M q̈ = f and L as printed are those of the generated module at a random state."""
    steps = [SimpleNamespace(section=one) for one in ("<p>first</p>", "<p>second</p>")]
    monkeypatch.setattr(equations_stage, "compare_steps", lambda *_: steps)
    stage = equations_stage.derivation()
    assert stage.html == "<p>first</p><p>second</p>"
    text = " ".join(" ".join(stage.lines).split())
    found = re.fullmatch(
        r"L = (.*) M = (\[.*?\]) (\[.*?\]) and M qddot = \(f1, f2\) with f1 = (.*) f2 = (.*)", text
    )
    assert found
    values = np.random.default_rng(3).uniform(0.5, 2.0, 9).tolist()
    symbols = dict(zip([*dp.STATE, *dp.PARAMETERS], values, strict=True))
    names = symbols | {"sin": math.sin, "cos": math.cos}
    L, first, second, *forces = (np.array(eval(one, names)) for one in found.groups())
    y, params = values[:4], values[4:]
    accelerations = np.linalg.solve([first, second], forces)
    assert accelerations == pytest.approx(dp.rhs(0.0, y, params)[2:], rel=1e-12)
    at_rest = dp.energy(0.0, [*y[:2], 0.0, 0.0], params)
    assert float(L) == pytest.approx(dp.energy(0.0, y, params) - 2 * at_rest, rel=1e-12)


def test_the_generated_code_is_shown_with_its_operations() -> None:
    stage = generation(dp)
    assert stage.lines[1] == "operations: rhs 32, rhs_hamiltonian 35, jacobian 84, energy 26"
    row = "<td>rhs_rational</td><td>rational form, in sines and cosines</td><td>39</td>"
    assert row in stage.html
    for name in ("rhs", "rhs_rational"):
        summary = f"<summary>{name}, as generated</summary><pre>def {name}("
        assert stage.html.count(summary) == 1
    assert [number.value for number in stage.numbers] == ["32"]


def test_programs_and_claims_are_listed_with_their_reasons() -> None:
    equations = [{"id": "2.1", "verdict": "verified"}, {"id": "2.2", "verdict": "verified"}]
    programs = [{"stops": []}, {"stops": ["no import", "x < 1 is wrong"]}]
    claims = [{"id": "C1", "claim": "RK4 is best", "verdict": "contradicted", "number": "5 < 9"}]
    html = equations_stage._section(equations, programs, claims)
    assert html.startswith(
        "<p>Of 2 equations, <strong>2</strong> hold as printed. Of 1 objectives, claims and "
        "recommendations, <strong>1</strong> do not hold.</p>"
    )
    assert "<td>C1</td><td>RK4 is best</td><td>contradicted</td><td>5 &lt; 9</td>" in html
    rows = ("program 1", "runs as printed"), ("program 2", "no import; x &lt; 1 is wrong")
    assert all(f"<tr><td>{name}</td><td>{text}</td></tr>" in html for name, text in rows)


def test_the_stages_of_the_demonstration_have_their_order(tmp_path: Path) -> None:
    order = ["derive", "verify", "generate", "integrate", "chart", "stability", "map"]
    assert [*demo_page.stages(tmp_path)] == order


def test_without_a_compiler_the_map_is_left_out_with_a_message(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(demo_page, "no_compiler", lambda _: "no C compiler")
    for name in ("derivation", "verification", "generation", "motion", "cost", "limits"):
        monkeypatch.setattr(demo_page, name, lambda *_: Stage(("a line",), "<p>content</p>"))
    folder = tmp_path / "not" / "yet"
    assert main(["demo", "--output", str(folder)]) == 0
    text = capsys.readouterr().out
    assert "left out: no C compiler" in text
    seconds = re.findall(r"^ *(?:\d \w+)? +([\d.-]+) s", text, re.MULTILINE)
    assert len(seconds) == 7
    assert all(0 <= float(time) < 60 for time in seconds)
    page = (folder / "demo.html").read_text(encoding="utf-8")
    assert 'id="chart"' in page
    assert 'id="map"' not in page


def test_the_command_writes_both_pages_into_the_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = Stage(("a line",), "<p>content</p>")
    monkeypatch.setattr(demo_page, "stages", lambda _: {"derive": lambda: stage})
    assert main(["demo", "--output", str(tmp_path)]) == 0
    assert "<p>content</p>" in (tmp_path / "demo.html").read_text(encoding="utf-8")
    assert "<canvas" in (tmp_path / "live.html").read_text(encoding="utf-8")


def test_text_in_tables_is_escaped() -> None:
    assert "<b>" not in table(("<b>",), [("<b>",)])


def test_tables_of_four_columns_are_stacked_on_narrow_screens() -> None:
    kinds = [table(["head"] * n, [["cell"] * n]).partition(">")[0] for n in (3, 4, 5)]
    assert kinds == ["<table", '<table class="stacks"', '<table class="stacks"']


@pytest.mark.long("the whole demonstration")
def test_the_page_is_written_atomically(demo: tuple[str, Path], tmp_path: Path) -> None:
    (tmp_path / "demo.html").mkdir()
    with pytest.raises(OSError, match=r"demo\.html"):
        write_page(tmp_path / "demo.html", {}, {})
    assert [path.name for path in tmp_path.iterdir()] == ["demo.html"]
    json.loads(re.findall(r'id="motions">(.*?)</script>', demo[1].read_text(encoding="utf-8"))[0])


def test_columns_of_text_break_neither_names_nor_long_words() -> None:
    words = ["Methods of", 40 * "ab", "are Euler-Lagrange's", "Dormand-Prince's"]
    lines = [*_in_two_columns("motions", "2 s", [" ".join(words), "Another paragraph"])]
    assert [line[13:] for line in lines] == [
        words[0], "  " + words[1], "  " + " ".join(words[2:]), "Another paragraph"
    ]  # fmt: skip
    assert [line[:13].strip() for line in lines] == ["motions", "2 s", "", ""]
