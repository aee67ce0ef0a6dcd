"""One HTML file that loads nothing from anywhere: its head, and what the browser may do."""

from __future__ import annotations

import hashlib
from base64 import b64encode
from html import escape
from pathlib import Path
from string import Template

FRAME = Path(__file__).with_name("document.html")


def document(title: str, body: str, *, style: str, script: str) -> str:
    """A page as text.

    Parameters
    ----------
    title : str
        Plain text.
    body : str
        HTML. Its style attributes and scripts are not obeyed.
    style, script : str
        The only ones that the browser may obey.

    Returns
    -------
    str
        HTML, a whole file.
    """
    # Template fills in once, so that no text of the user's is itself filled in
    return Template(FRAME.read_text(encoding="utf-8")).substitute(
        policy=_policy(script, style), title=escape(title), style=style, body=body, script=script,
    )  # fmt: skip


def _policy(script: str, style: str) -> str:
    """Run exactly this script and style, and fetch nothing."""
    return (
        f"default-src 'none'; script-src {_hash(script)}; style-src {_hash(style)}; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
