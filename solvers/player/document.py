"""One HTML file without external resources, with a policy that permits none."""

from __future__ import annotations

import hashlib
from base64 import b64encode
from html import escape
from pathlib import Path
from string import Template

TEMPLATE = Path(__file__).with_name("document.html")


def document(title: str, body: str, *, style: str, script: str) -> str:
    """A page as text; the browser applies and runs no other style and script."""
    # Template substitutes once, so that nothing is substituted in the texts themselves
    values = {"title": escape(title), "style": style, "body": body, "script": script}
    template = Template(TEMPLATE.read_text(encoding="utf-8"))
    return template.substitute(values, policy=_policy(script, style))


def _policy(script: str, style: str) -> str:
    """Permit exactly this script and style, and no requests."""
    return (
        f"default-src 'none'; script-src {_hash(script)}; style-src {_hash(style)}; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
