"""Parts of the page: tables, pictures, and what is opened on demand."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Sequence
from html import escape

from matplotlib.figure import Figure

from solvers.io.figures import png, svg

#: A table with so many columns stands as one cell below the other on a narrow screen.
MANY = 4


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Plain text in rows and columns."""
    head = "".join(f"<th>{escape(cell)}</th>" for cell in heads)
    body = "".join(
        f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows
    )
    kind = ' class="stacks"' if len(heads) >= MANY else ""
    return f"<table{kind}><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def pair(one: str, other: str) -> str:
    """Beside each other where there is room."""
    return f'<div class="pair"><div>{one}</div><div>{other}</div></div>'


def drawing(figure: Figure, words: str) -> str:
    """A chart that stays sharp on every screen."""
    return _image("svg+xml", svg(figure).encode(), words)


def image(figure: Figure, words: str) -> str:
    """A picture of many pixels."""
    return _image("png", png(figure), words)


def _image(kind: str, data: bytes, words: str) -> str:
    source = f"data:image/{kind};base64,{b64encode(data).decode()}"
    return f'<img class="chart" src="{source}" alt="{escape(words)}">'


def opened(summary: str, html: str) -> str:
    """What is shown when it is asked for."""
    return f"<details><summary>{escape(summary)}</summary>{html}</details>"
