"""Pages without external resources: the player and the motions in one HTML file."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template

from solvers.io.atomic_write import write_text
from solvers.io.html_page import html_page
from solvers.player.track import Track

SOURCES = Path(__file__).parent
#: The parts of the player; each uses those before it. A page that integrates has the view, too.
VIEW = ("motion.js", "following.js", "camera.js", "canvas.js", "shapes.js", "panel.js")
SCRIPTS = ("recorded.js", *VIEW, "energy_chart.js", "state_chart.js", "player.js")


@dataclass(frozen=True)
class Page:
    """A page that plays motions side by side; notebooks display it.

    Parameters
    ----------
    title, note : str
        Title and description, as plain text.
    tracks : sequence of Track
        The runs. A run with more than 20 000 samples is reduced to 20 000 evenly spaced ones.
    equations : str, optional
        Equations of motion, as HTML.

    Raises
    ------
    ValueError
        When there is no track, or one cannot be played; the message states the reason.
    """

    title: str
    note: str
    tracks: Sequence[Track]
    equations: str = ""

    def __post_init__(self) -> None:
        _check(self.tracks)

    @property
    def html(self) -> str:
        """The whole file as text."""
        head = f'<h1>{escape(self.title)}</h1>\n<p id="note">{escape(self.note)}</p>'
        main = player(self.tracks)
        if self.equations:
            title = '<h2 id="equations-title">Equations of motion</h2>'
            part = '<section id="equations" aria-labelledby="equations-title">'
            main += f"{part}\n{title}\n{self.equations}\n</section>\n"
        body = f"<header>\n{head}\n</header>\n<main>\n{main}</main>"
        return html_page(self.title, body, style(), script())

    def write(self, path: Path) -> None:
        """Write the file atomically; missing folders are created, an existing file is replaced."""
        write_text(path, self.html)

    def _repr_html_(self) -> str:
        attributes = 'width="100%" height="760" style="border: 0"'
        return f'<iframe {attributes} srcdoc="{escape(self.html)}"></iframe>'


def player(tracks: Sequence[Track]) -> str:
    """The part of a page that plays `tracks`, as HTML; it needs `style` and `script`."""
    _check(tracks)
    motions = as_json([track.json_values() for track in tracks])
    unit = tracks[0].energy_unit
    words = "in J" if unit == "J" else f"relative to the {unit}"
    return Template(source("player.html")).substitute(motions=motions, unit=escape(words))


def _check(tracks: Sequence[Track]) -> None:
    if not tracks:
        raise ValueError("tracks is empty, but a page plays at least one: give it a Track")
    units = [track.energy_unit for track in tracks]
    if len({*units}) > 1:
        text = f"the units of energy errors are {', '.join(map(repr, units))}"
        raise ValueError(f"{text}, but they share an axis: convert them to J")
    labels = {tuple(one.label for one in track.coordinates) for track in tracks}
    if len(labels) > 1:
        raise ValueError(
            f"the coordinates of the tracks are {labels}, but they share charts: give all tracks "
            "the same ones, or none"
        )
    for track in tracks:
        track.check()


def style() -> str:
    """The style sheet of a page and the player in it."""
    return source("player.css")


def script() -> str:
    """The script of the player."""
    return "\n".join(map(source, SCRIPTS))


def as_json(value: object) -> str:
    """JSON in which no character of a text starts or ends a tag or a comment of HTML."""
    text = json.dumps(value, separators=(",", ":"))
    for character in "&<>":
        text = text.replace(character, rf"\u{ord(character):04x}")
    return text


def source(name: str) -> str:
    """The text of a file of the player."""
    return (SOURCES / name).read_text(encoding="utf-8")
