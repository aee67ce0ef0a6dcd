"""The page that the demonstration ends in: one file, which loads nothing from anywhere."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from pathlib import Path

from solvers.app.demo.html import table
from solvers.app.demo.station import Station
from solvers.io.atomic_write import write_text
from solvers.player import page as motions
from solvers.player.document import document

STYLE = Path(__file__).with_name("demo.css")

#: Sections by station, in the order of the page: their titles, and what to look at.
SECTIONS = {
    "integrate": (
        "Motion",
        "The report's scene: two masses of 1 kg on rods of 2 m, released from rest. Beside it the "
        "same equations by Euler's method, which gains energy out of nothing.",
    ),
    "derive": (
        "Derivation",
        "What SymPy derives from the positions alone, and beside it the report's own lines, each "
        "judged by computation.",
    ),
    "verify": (
        "The verdict on the report",
        "The technical report Comparing Method in Double Pendulum derives these equations by hand "
        "and compares methods. Every formula and every conclusion of it is judged by computation.",
    ),
    "generate": (
        "Generated code",
        "The equations are written as readable Python and C; the rational form calls no function.",
    ),
    "chart": (
        "Speed against accuracy",
        "What a smaller error costs, measured while this page was made: compiled loops of "
        "holonomic (lines), and SciPy's solve_ivp with the same generated equations (dashed).",
    ),
    "stability": (
        "How long steps may be",
        "Inside its line a method lets small motions fade; oscillations live on the vertical axis. "
        "The table gives the longest step for the report's pendulum: none means that "
        "oscillations grow with every step, any that none does.",
    ),
    "map": (
        "A quarter of a million motions",
        "How long until one of two rods first turns over, from rest at any two angles. It is a "
        "fractal (J. S. Heyl, 2008).",
    ),
}


def page(
    stations: Mapping[str, Station], made: Mapping[str, str], style: str
) -> str:  # fmt: skip
    """The page as text.

    Parameters
    ----------
    stations : mapping of str to Station
        By their names, as in `SECTIONS`; those that are not there are left out.
    made : mapping of str to str
        Where and with what the page was made.
    style : str
        Of the derivation, as CSS.

    Returns
    -------
    str
        HTML, a whole file.
    """
    title = "Double pendulum: from positions to motion"
    body = [
        f"<header><h1>{title}</h1><p>From the positions of two masses to equations, code, motion "
        "and their proof, made by <code>holonomic demo</code>.</p><nav>",
        *(f'<a href="#{name}">{escape(SECTIONS[name][0])}</a> ' for name in _shown(stations)),
        '<a href="#numbers">Numbers</a></nav></header><main>',
        *(_section(name, stations[name]) for name in _shown(stations)),
        _numbers(stations, made),
        "</main>",
    ]
    looks = motions.style() + style + STYLE.read_text(encoding="utf-8")
    return document(title, "\n".join(body), style=looks, script=motions.script())


def write_demo(
    path: Path, stations: Mapping[str, Station], made: Mapping[str, str], style: str
) -> None:  # fmt: skip
    """Write the page beside its name first, and move it into place."""
    write_text(path, page(stations, made, style))


def _shown(stations: Mapping[str, Station]) -> list[str]:
    return [name for name in SECTIONS if name in stations]


def _section(name: str, station: Station) -> str:
    title, words = SECTIONS[name]
    head = f"<h2>{escape(title)}</h2><p>{escape(words)}</p>"
    return f'<section id="{name}">{head}{station.html}</section>'


def _numbers(stations: Mapping[str, Station], made: Mapping[str, str]) -> str:
    numbers = [number for name in _shown(stations) for number in stations[name].numbers]
    rows = [(number.what, number.value, number.how, number.command) for number in numbers]
    return (
        '<section id="numbers"><h2>Numbers, and where they come from</h2>'
        + table(("what", "value", "how", "again by"), rows)
        + table(("made with", ""), made.items())
        + "</section>"
    )
