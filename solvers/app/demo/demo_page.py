"""The demonstration: its stages, from positions to a map of motions, and their page."""

import platform
from collections.abc import Callable, Mapping
from datetime import date
from html import escape
from importlib.metadata import version
from pathlib import Path

from derive.verification.report.derivation_beside_report import STYLE as DERIVATION_STYLE
from solvers.app.demo.equations_stage import derivation, generation, verification
from solvers.app.demo.motions_stage import cost, flips, limits, motion
from solvers.app.demo.stage import ReportedNumber, Stage, table
from solvers.app.modules import load
from solvers.integration.prepare import no_compiler
from solvers.io.atomic_write import write_text
from solvers.io.html_page import html_page
from solvers.player import player_page as motions
from solvers.scenes.scene_reading import find
from solvers.sweeps.definition import sweep_reading

#: Packages whose versions the page states.
PACKAGES = ("holonomic", "sympy", "numpy", "scipy", "matplotlib")


def stages(folder: Path) -> dict[str, Callable[[], Stage]]:
    """The stages by name, in their order; the map of motions needs a compiler."""
    scene = find("report", load)

    def flip_map() -> Stage:
        if missing := no_compiler(scene.module):
            return Stage((f"left out: {missing}",))
        return flips(sweep_reading.find("flips", load), folder / "flips")

    return {
        "derive": derivation,
        "verify": verification,
        "generate": lambda: generation(load("double_pendulum")),
        "integrate": lambda: motion(scene),
        "chart": lambda: cost(scene),
        "stability": lambda: limits(scene),
        "map": flip_map,
    }


def versions() -> dict[str, str]:
    """Date, machine and versions."""
    return {
        "date": date.today().isoformat(),
        "machine": f"{platform.system()} {platform.machine()}",
        "Python": platform.python_version(),
        **{name: version(name) for name in PACKAGES},
    }


STYLE = Path(__file__).with_name("demo.css")
TITLE = "Double pendulum: from positions to motion"

#: Titles and introductions of the sections, by stage, in the order of the page.
SECTIONS = {
    "integrate": (
        "Motion",
        "The scene of the report: two masses of 1 kg on rods of 2 m, released from rest. Beside "
        "it, Euler's method integrates the same equations and gains energy.",
    ),
    "derive": (
        "Derivation",
        "The equations that SymPy derives from the positions alone, beside the equations of the "
        "report, each verified by computation.",
    ),
    "verify": (
        "Verification of the report",
        "The technical report Comparing Method in Double Pendulum derives these equations by hand "
        "and compares methods. All of its formulas and conclusions are tested by computation.",
    ),
    "generate": (
        "Generated code",
        "The equations are written as readable Python and C; the rational form calls no function.",
    ),
    "chart": (
        "Speed against accuracy",
        "The cost of a smaller error, measured when this page was written: compiled loops of "
        "holonomic (solid lines), and SciPy's solve_ivp with the same equations (dashed lines).",
    ),
    "stability": (
        "Longest stable steps",
        "Inside the boundary of its stability region a method damps small motions; eigenvalues of "
        "undamped oscillations are on the vertical axis. The table gives the longest stable step "
        "for the pendulum of the report: with none, oscillations grow at every step size; with "
        "any, they grow at none.",
    ),
    "map": (
        "A quarter of a million motions",
        "The time until one of the two rods first flips, from rest at any two angles. The map is "
        "a fractal (J. S. Heyl, 2008).",
    ),
}


#: The page beside it that integrates.
LIVE_PAGE = "live.html"


def write_page(path: Path, stages: Mapping[str, Stage], versions: Mapping[str, str]) -> None:
    """Write the page atomically; stages without content are left out."""
    shown = {name: stages[name] for name in SECTIONS if name in stages and stages[name].html}
    links = "".join(f'<a href="#{name}">{escape(SECTIONS[name][0])}</a> ' for name in shown)
    header = (
        f"<header><h1>{TITLE}</h1><p>Equations, code, motions and their verification, from the "
        f"positions of two masses. Written by <code>holonomic demo</code>.</p><nav>{links}"
        '<a href="#numbers">Numbers</a> '
        f'<a href="{LIVE_PAGE}">Live page: drag the masses</a></nav></header>'
    )
    sections = "\n".join(_section(name, stage) for name, stage in shown.items())
    body = f"{header}<main>{sections}{_numbers(shown, versions)}</main>"
    style = motions.style() + DERIVATION_STYLE + STYLE.read_text(encoding="utf-8")
    write_text(path, html_page(TITLE, body, style, motions.script()))


def _section(name: str, stage: Stage) -> str:
    title, introduction = SECTIONS[name]
    head = f"<h2>{escape(title)}</h2><p>{escape(introduction)}</p>"
    return f'<section id="{name}">{head}{stage.html}</section>'


def _numbers(stages: Mapping[str, Stage], versions: Mapping[str, str]) -> str:
    numbers = [number for stage in stages.values() for number in stage.numbers]
    tables = table(ReportedNumber._fields, numbers) + table(("environment", ""), versions.items())
    return f'<section id="numbers"><h2>Numbers and their origins</h2>{tables}</section>'
