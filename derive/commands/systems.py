"""Descriptions of systems: drawings, coordinates, state and parameters."""

from __future__ import annotations

from itertools import groupby
from textwrap import indent, wrap

from derive.system.catalogue import drawing, load

WIDTH = 96


def description(name: str) -> str:
    """A system's drawing, and what its state and parameters are called."""
    system = load(name)
    # of the file's docstring the first line says what the title says
    _, *picture = drawing(name).splitlines()
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
    lines = [
        line
        for title, text in rows.items()
        for line in wrap(f"{title}: {text}", WIDTH, subsequent_indent="    ")
    ]
    return "\n".join([f"{name}: {system.title}", *picture, "", indent("\n".join(lines), "  ")])
