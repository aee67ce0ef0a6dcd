"""How far a sweep can be trusted: some of its motions once more, with tighter tolerances."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from solvers.sweeps.axes import some
from solvers.sweeps.job import Job
from solvers.sweeps.sweep import Sweep
from solvers.sweeps.worker import work

#: Motions that are done again, and by how much tighter their tolerances are.
AGAIN, TIGHTER = 64, 100.0
#: The tightest relative tolerance that numbers allow.
TIGHTEST = 1e-14


@dataclass(frozen=True)
class Trust:
    """By how much the numbers of a map change under tighter tolerances.

    Attributes
    ----------
    motions : int
        How many were compared.
    median, most : float
        Changes that half of the numbers, and all but a tenth of them, do not exceed.
    lost : float
        The share of numbers that are there with one tolerance only.
    """

    motions: int
    median: float
    most: float
    lost: float


def tighter(asked: Sweep) -> float:
    """The relative tolerance with which motions are done again."""
    return max(asked.rtol / TIGHTER, TIGHTEST)


def trust(asked: Sweep) -> dict[str, Trust]:
    """How much each map changes, from motions all over the sweep."""
    job = Job.of(asked)
    tight = replace(job, rtol=tighter(asked), atol=asked.atol / TIGHTER)
    columns = some(asked.axes, AGAIN)
    once, again = work(job, columns), work(tight, columns)
    found = {}
    for name in asked.maps:
        there = np.isfinite(once[name]), np.isfinite(again[name])
        apart = np.abs(once[name] - again[name])[there[0] & there[1]]
        if apart.size:
            median, most = np.quantile(apart, (0.5, 0.9)).tolist()
            lost = float(np.mean(there[0] != there[1]))
            found[name] = Trust(len(once), median, most, lost)
    return found
