"""Convergence of a sweep: changes of the maps with tighter tolerances."""

from dataclasses import dataclass

import numpy as np

from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.worker import run_chunk

#: Number of motions that are repeated, and the ratio of the tolerances.
REPEATED, RATIO = 64, 100.0
#: The smallest relative tolerance, limited by rounding.
MIN_RTOL = 1e-14


@dataclass(frozen=True)
class Convergence:
    """Changes of a map's numbers with tighter tolerances."""

    motions: int  # that were compared
    median: float  # a change that half of the numbers do not exceed
    most: float  # a change that nine tenths do not exceed
    lost: float  # share of the numbers that exist with one tolerance only


def tighter_rtol(sweep: Sweep) -> float:
    """The relative tolerance of the repeated motions."""
    return max(sweep.rtol / RATIO, MIN_RTOL)


def convergence(sweep: Sweep) -> dict[str, Convergence]:
    """Changes of each map, from motions all over the sweep."""
    tight = sweep.unchecked(rtol=tighter_rtol(sweep), atol=sweep.atol / RATIO)
    columns = sweep.axes.subset(REPEATED)
    original, repeated = run_chunk(sweep, columns), run_chunk(tight, columns)
    changes = {}
    for name in sweep.maps:
        known = np.isfinite(original[name]), np.isfinite(repeated[name])
        change = np.abs(original[name] - repeated[name])[known[0] & known[1]]
        if change.size:
            median, most = np.quantile(change, (0.5, 0.9)).tolist()
            lost = float(np.mean(known[0] != known[1]))
            changes[name] = Convergence(len(original), median, most, lost)
    return changes
