"""Write the page: the player and the motions in one file, which loads nothing from anywhere."""

from __future__ import annotations

import hashlib
import json
from base64 import b64encode
from collections.abc import Sequence
from html import escape
from pathlib import Path
from string import Template

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
    if not tracks:
        raise ValueError("tracks is empty, but a page plays at least one: give it a Track")
    for track in tracks:
        track.check()
    written(path, _page(title, note, tracks))


def _page(title: str, note: str, tracks: Sequence[Track]) -> str:
    style = _source("player.css")
    script = "\n".join(_source(name) for name in SCRIPTS)
    # Template fills in once, so that no text of the user's is itself filled in
    return Template(_source("player.html")).substitute(
        policy=_policy(script, style),
        title=escape(title),
        note=escape(note),
        style=style,
        script=script,
        motions=_inert(json.dumps([track.plain() for track in tracks], separators=(",", ":"))),
    )


def _source(name: str) -> str:
    return (SOURCES / name).read_text(encoding="utf-8")


def _inert(data: str) -> str:
    """JSON in which no tag or comment can end or begin."""
    return data.replace("&", r"\u0026").replace("<", r"\u003c").replace(">", r"\u003e")


def _policy(script: str, style: str) -> str:
    """What the browser may do: run exactly this script and style, and fetch nothing."""
    return (
        f"default-src 'none'; script-src {_hash(script)}; style-src {_hash(style)}; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
