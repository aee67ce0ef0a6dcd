"""``holonomic systems``: what there is, with drawings, coordinates and parameters."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from itertools import groupby
from textwrap import indent, wrap

from derive.system.catalogue import UnknownSystemError, drawing, load, names
from derive.system.parts import SystemDefinitionError

WIDTH = 96


def main(argv: Sequence[str]) -> int:
    """Run the command and return its exit code: 0, or 2 for an unknown system."""
    parser = argparse.ArgumentParser(
        prog="holonomic systems",
        description="List the systems that ship, with drawing, coordinates and parameters.",
        epilog="example:\n  holonomic systems chain_5",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "systems", nargs="*", metavar="SYSTEM", help="such as chain_5; default: all"
    )
    wanted = parser.parse_args(argv).systems or names()
    try:
        print("\n\n".join(description(name) for name in wanted))
    except (UnknownSystemError, SystemDefinitionError) as error:
        print(f"holonomic systems: {error}", file=sys.stderr)
        return 2
    return 0


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
