"""Convergence of a sweep: changes of the maps with tighter tolerances."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from solvers.sweeps.axes import subset
from solvers.sweeps.job import Job
from solvers.sweeps.sweep import Sweep
from solvers.sweeps.worker import run_chunk

#: Number of motions that are repeated, and the ratio of the tolerances.
REPEATED, RATIO = 64, 100.0
#: The smallest relative tolerance, limited by rounding.
MIN_RTOL = 1e-14


@dataclass(frozen=True)
class Convergence:
    """Changes of a map's numbers with tighter tolerances."""

    #: Number of motions that were compared.
    motions: int
    #: Changes that half of the numbers, and nine tenths of them, do not exceed.
    median: float
    most: float
    #: Share of the numbers that exist with one tolerance only.
    lost: float


def tighter_rtol(sweep: Sweep) -> float:
    """The relative tolerance of the repeated motions."""
    return max(sweep.rtol / RATIO, MIN_RTOL)


def convergence(sweep: Sweep) -> dict[str, Convergence]:
    """Changes of each map, from motions all over the sweep."""
    job = Job.of(sweep)
    tolerances = {"rtol": tighter_rtol(sweep), "atol": sweep.atol / RATIO}
    tight = replace(job, options=job.options | tolerances)
    columns = subset(sweep.axes, REPEATED)
    original, repeated = run_chunk(job, columns), run_chunk(tight, columns)
    changes = {}
    for name in sweep.maps:
        known = np.isfinite(original[name]), np.isfinite(repeated[name])
        change = np.abs(original[name] - repeated[name])[known[0] & known[1]]
        if change.size:
            median, most = np.quantile(change, (0.5, 0.9)).tolist()
            lost = float(np.mean(known[0] != known[1]))
            changes[name] = Convergence(len(original), median, most, lost)
    return changes
