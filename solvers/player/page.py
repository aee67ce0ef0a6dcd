"""A page: the player and the motions in one file, which loads nothing from anywhere."""

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
#: The player's parts, each of which uses those before it.
SCRIPTS = ("motion.js", "sheet.js", "panel.js", "strip.js", "player.js")


@dataclass(frozen=True)
class Page:
    """A page that plays motions side by side; notebooks show it as it is.

    Parameters
    ----------
    title, note : str
        What the page shows, and what to look at; plain text.
    tracks : sequence of Track
        The runs. Of more than 20 000 samples of a run, 20 000 evenly chosen ones are kept.

    Raises
    ------
    ValueError
        When there is no track, or one cannot be played: the message says why.
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
        """Write the file beside its name, and move it into place; missing folders are made.

        Parameters
        ----------
        path : Path
            Its name; what stands there is replaced.

        Raises
        ------
        OSError
            When it cannot be written.
        """
        write_text(path, self.html)

    def _repr_html_(self) -> str:
        look = 'width="100%" height="760" style="border: 0"'
        return f'<iframe {look} srcdoc="{escape(self.html)}"></iframe>'


def player(tracks: Sequence[Track]) -> str:
    """The part of a page that plays `tracks`; it needs `style` and `script`.

    Parameters
    ----------
    tracks : sequence of Track
        The runs, one at least.

    Returns
    -------
    str
        HTML, to stand in a body.

    Raises
    ------
    ValueError
        When there is no track, or one cannot be played: the message says why.
    """
    _check(tracks)
    motions = json.dumps([track.plain() for track in tracks], separators=(",", ":"))
    return Template(_source("player.html")).substitute(motions=_inert(motions))


def _check(tracks: Sequence[Track]) -> None:
    if not tracks:
        raise ValueError("tracks is empty, but a page plays at least one: give it a Track")
    for track in tracks:
        track.check()


def style() -> str:
    """How a page looks, and the player in it."""
    return _source("player.css")


def script() -> str:
    """What the player does."""
    return "\n".join(map(_source, SCRIPTS))


def _source(name: str) -> str:
    return (SOURCES / name).read_text(encoding="utf-8")


def _inert(data: str) -> str:
    """JSON in which no tag or comment can end or begin."""
    return data.replace("&", r"\u0026").replace("<", r"\u003c").replace(">", r"\u003e")
