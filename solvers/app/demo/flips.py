"""A map of many motions: when a double pendulum first turns over."""

from __future__ import annotations

import time
from pathlib import Path

from solvers.app.demo.html import image
from solvers.app.demo.station import Number, Station
from solvers.sweeps.convergence import convergence, tighter_rtol
from solvers.sweeps.plots.figure import figure
from solvers.sweeps.run import sweep
from solvers.sweeps.sweep import Sweep


def flips(definition: Sweep, folder: Path) -> Station:
    """Run a sweep and draw its map."""
    start = time.perf_counter()
    results = sweep(definition, folder)
    seconds = time.perf_counter() - start
    change, rtol = convergence(definition)["flip"], tighter_rtol(definition)
    flipped = results.count.get("event", 0)
    first = (
        f"{definition.motions:,} motions of {definition.duration:g} s: {flipped:,} turn over "
        f"({seconds:.1f} s this time)"
    )
    number = Number(
        f"motions of {definition.motions:,} that turn over within {definition.duration:g} s",
        f"{flipped:,}",
        f"{change.motions} of them again with rtol = {rtol:.0e}: half of the times change by less "
        f"than {change.median:.0e} s",
        f"holonomic sweep {definition.name}",
    )
    picture = image(figure(results), "Map of the time until one of the rods turns over")
    return Station((first,), picture, (number,))
