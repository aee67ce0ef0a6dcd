"""The results of a stage of the demonstration, and the elements of its HTML."""

from base64 import b64encode
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from html import escape
from typing import NamedTuple

from matplotlib.figure import Figure

from solvers.io.figures import darken, png, svg

#: On a narrow screen the cells of a table with so many columns are stacked.
STACKED = 4


class ReportedNumber(NamedTuple):
    """A reported number and its origin: a proof, a computation or a measurement."""

    quantity: str
    value: str  # with its unit
    method: str
    command: str  # which reproduces it


@dataclass(frozen=True)
class Stage:
    """Results of a stage: `lines` for the terminal, `html` and `numbers` for the page."""

    lines: tuple[str, ...]
    html: str = ""
    numbers: tuple[ReportedNumber, ...] = ()


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of plain text."""
    head = "".join(f"<th>{escape(cell)}</th>" for cell in heads)
    body = "".join(
        f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows
    )
    kind = ' class="stacks"' if len(heads) >= STACKED else ""
    return f"<table{kind}><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def pair(left: str, right: str) -> str:
    """Two columns where the screen is wide enough."""
    return f'<div class="pair"><div>{left}</div><div>{right}</div></div>'


def svg_image(figure: Figure, alternative: str) -> str:
    """A chart as vector graphics; `figure` is dark afterwards."""
    return _image("svg+xml", lambda: svg(figure).encode(), figure, alternative)


def png_image(figure: Figure, alternative: str) -> str:
    """A chart as pixels; `figure` is dark afterwards."""
    return _image("png", lambda: png(figure), figure, alternative)


def _image(kind: str, content: Callable[[], bytes], figure: Figure, alternative: str) -> str:
    """A light and a dark variant, between which the reader's settings decide."""

    def source() -> str:
        return f"data:image/{kind};base64,{b64encode(content()).decode()}"

    light = source()
    darken(figure)
    dark = f'<source media="(prefers-color-scheme: dark)" srcset="{source()}">'
    image = f'<img class="chart" src="{light}" alt="{escape(alternative)}">'
    return f"<picture>{dark}{image}</picture>"


def details(summary: str, html: str) -> str:
    """Collapsed content below a summary."""
    return f"<details><summary>{escape(summary)}</summary>{html}</details>"
