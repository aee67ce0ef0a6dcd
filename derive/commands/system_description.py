"""Descriptions of systems: drawings, coordinates, state and parameters."""

import re
import tomllib
from itertools import groupby
from textwrap import TextWrapper

from derive.system.files.shipped import USUAL, large_names, names
from derive.system.files.system_catalogue import LARGEST, drawing, load, published

WIDTH = 96
#: Remark on systems whose modules do not ship.
LARGE = "derived when it is first used"


def description(name: str) -> str:
    """Drawing of a system, and names and units of its coordinates, state and parameters."""
    system = load(name)
    _, *picture = drawing(name).splitlines()  # the title replaces the first line
    coordinates = [
        f"{', '.join(str(c.symbol) for c in group)} [{unit}], {meaning}"
        for (unit, meaning), group in groupby(system.coordinates, lambda c: (c.unit, c.meaning))
    ]
    parameters = [f"{p.symbol} = {p.default:g} {p.unit}" for p in system.parameters]
    rows = {
        "coordinates": "; ".join(coordinates),
        "state": ", ".join(s.name for s in system.q + system.qdot),
        "parameters": ", ".join(parameters) or "none",
    }
    if system.inputs:
        rows["inputs"] = ", ".join(f"{u.symbol} [{u.unit}]" for u in system.inputs)
    if name in large_names():
        rows["module"] = LARGE
    layout = TextWrapper(WIDTH + 2, initial_indent="  ", subsequent_indent=" " * 6)
    lines = [layout.fill(f"{title}: {text}") for title, text in rows.items()]
    return "\n".join([f"{name}: {system.title}", *picture, "", *lines])


def markdown_table() -> str:
    """The systems that ship, as a table in Markdown; each row comes from the system's file."""
    head = "| system | coordinates | description | source of the published equations |"
    return "\n".join([head, "|---|---|---|---|", *map(_row, (*names(), *large_names())), ""])


def _row(name: str) -> str:
    coordinates = ", ".join(f"`{q.name}`" for q in load(name).q)
    summary = drawing(name).partition("\n")[0].rstrip(".")
    source = tomllib.loads(published(name)).get("source", "")
    stem = re.sub(rf"{USUAL}\Z", "", name)
    family = f"; `{stem}1` to `{stem}{LARGEST}`" if stem != name else ""
    remark = f" ({LARGE})" if name in large_names() else ""
    return f"| `{name}`{family}{remark} | {coordinates} | {summary} | {source} |"
