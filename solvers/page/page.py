"""Write the page: the player and the motions in one file, which loads nothing from anywhere."""

from __future__ import annotations

import json
from collections.abc import Sequence
from html import escape
from pathlib import Path
from string import Template

from solvers.page.document import document
from solvers.page.track import Track
from solvers.written import written

SOURCES = Path(__file__).parent
#: The player's parts, each of which uses those before it.
SCRIPTS = ("motion.js", "sheet.js", "panel.js", "strip.js", "player.js")


def write_page(path: Path, title: str, note: str, tracks: Sequence[Track]) -> None:
    """Write a page that plays `tracks` side by side.

    Parameters
    ----------
    path : Path
        The HTML file; it is written beside its name and moved into place. Missing
        folders are made.
    title, note : str
        What the page shows, and what to look at; plain text.
    tracks : sequence of Track
        The runs. Of more than 20 000 samples of a run, 20 000 evenly chosen ones are kept.

    Raises
    ------
    ValueError
        When there is no track, or one cannot be played: the message says why.
    OSError
        When the file cannot be written.
    """
    head = f'<header>\n<h1>{escape(title)}</h1>\n<p id="note">{escape(note)}</p>\n</header>'
    body = f"{head}\n<main>\n{player(tracks)}</main>"
    written(path, document(title, body, style=style(), script=script()))


def player(tracks: Sequence[Track]) -> str:
    """The part of a page that plays `tracks`; it needs `style` and `script`.

    Raises
    ------
    ValueError
        When there is no track, or one cannot be played: the message says why.
    """
    if not tracks:
        raise ValueError("tracks is empty, but a page plays at least one: give it a Track")
    for track in tracks:
        track.check()
    motions = json.dumps([track.plain() for track in tracks], separators=(",", ":"))
    return Template(_source("player.html")).substitute(motions=_inert(motions))


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
