"""A map of many motions: the time until a double pendulum first flips."""

from __future__ import annotations

import time
from pathlib import Path

from solvers.app.demo.html import png_image
from solvers.app.demo.stage import Number, Stage
from solvers.sweeps.convergence import convergence, tighter_rtol
from solvers.sweeps.plots.figure import figure
from solvers.sweeps.run import sweep
from solvers.sweeps.sweep import Sweep


def flips(definition: Sweep, folder: Path) -> Stage:
    """Run or resume a sweep and plot its map."""
    start = time.perf_counter()
    results = sweep(definition, folder)
    seconds = time.perf_counter() - start
    change = convergence(definition)["flip"]
    motions, duration = f"{definition.motions:,}", f"{definition.duration:g} s"
    flipped = f"{results.count.get('event', 0):,}"
    method = (
        f"{change.motions} of them repeated with rtol = {tighter_rtol(definition):.0e}: "
        f"half of the times change by less than {change.median:.0e} s"
    )
    quantity = f"motions of {motions} that flip within {duration}"
    return Stage(
        (f"{motions} motions of {duration}: {flipped} flip ({seconds:.1f} s this time)",),
        png_image(figure(results), "Map of the time until one of the rods flips"),
        (Number(quantity, flipped, method, f"holonomic sweep {definition.name}"),),
    )
