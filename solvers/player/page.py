"""A page: the player and the motions in one file without external resources."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template

from solvers.io.atomic_write import write_text
from solvers.player.document import document
from solvers.player.track import Track

SOURCES = Path(__file__).parent
#: The parts of the player; each uses those before it.
SCRIPTS = ("motion.js", "canvas.js", "panel.js", "energy_chart.js", "player.js")


@dataclass(frozen=True)
class Page:
    """A page that plays motions side by side; notebooks display it.

    Parameters
    ----------
    title, note : str
        Title and description, as plain text.
    tracks : sequence of Track
        The runs. A run with more than 20 000 samples is reduced to 20 000 evenly spaced ones.

    Raises
    ------
    ValueError
        When there is no track, or one cannot be played; the message states the reason.
    """

    title: str
    note: str
    tracks: Sequence[Track]

    def __post_init__(self) -> None:
        _check(self.tracks)

    @property
    def html(self) -> str:
        """The whole file as text."""
        head = f'<h1>{escape(self.title)}</h1>\n<p id="note">{escape(self.note)}</p>'
        body = f"<header>\n{head}\n</header>\n<main>\n{player(self.tracks)}</main>"
        return document(self.title, body, style=style(), script=script())

    def write(self, path: Path) -> None:
        """Write the file atomically; missing folders are created, an existing file is replaced.

        Parameters
        ----------
        path : Path
            Path of the file.

        Raises
        ------
        OSError
            When it cannot be written.
        """
        write_text(path, self.html)

    def _repr_html_(self) -> str:
        attributes = 'width="100%" height="760" style="border: 0"'
        return f'<iframe {attributes} srcdoc="{escape(self.html)}"></iframe>'


def player(tracks: Sequence[Track]) -> str:
    """The part of a page that plays `tracks`, as HTML; it needs `style` and `script`."""
    _check(tracks)
    motions = json.dumps([track.json_values() for track in tracks], separators=(",", ":"))
    return Template(_source("player.html")).substitute(motions=_escaped(motions))


def _check(tracks: Sequence[Track]) -> None:
    if not tracks:
        raise ValueError("tracks is empty, but a page plays at least one: give it a Track")
    for track in tracks:
        track.check()


def style() -> str:
    """The style sheet of a page and the player in it."""
    return _source("player.css")


def script() -> str:
    """The script of the player."""
    return "\n".join(map(_source, SCRIPTS))


def _source(name: str) -> str:
    return (SOURCES / name).read_text(encoding="utf-8")


def _escaped(data: str) -> str:
    """JSON without characters that start or end a tag or a comment."""
    return data.replace("&", r"\u0026").replace("<", r"\u003c").replace(">", r"\u003e")
