"""A map of very many motions: when a double pendulum first turns over."""

from __future__ import annotations

import time
from pathlib import Path

from solvers.app.demo.html import image
from solvers.app.demo.station import Number, Station
from solvers.sweeps.convergence import tighter, trust
from solvers.sweeps.plots.figure import drawn
from solvers.sweeps.run import sweep
from solvers.sweeps.sweep import Sweep


def flips(asked: Sweep, folder: Path) -> Station:
    """Run a sweep, or what is left of it, and draw it."""
    start = time.perf_counter()
    results = sweep(asked, folder)
    seconds = time.perf_counter() - start
    doubt = trust(asked)["flip"]
    flipped = results.count.get("event", 0)
    return Station(
        (
            f"{asked.motions:,} motions of {asked.duration:g} s: {flipped:,} turn over "
            f"({seconds:.1f} s this time)",
        ),
        image(drawn(results), "Map of the time until one of the rods turns over"),
        (
            Number(
                f"motions of {asked.motions:,} that turn over within {asked.duration:g} s",
                f"{flipped:,}", f"{doubt.motions} of them again with rtol = {tighter(asked):.0e}: "
                f"half of the times change by less than {doubt.median:.0e} s",
                f"holonomic sweep {asked.name}",
            ),
        ),
    )  # fmt: skip
