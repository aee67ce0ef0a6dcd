"""How many motions are done at a time."""

from __future__ import annotations

from solvers.sweeps.axes import some
from solvers.sweeps.initial_states import begun
from solvers.sweeps.job import Job
from solvers.sweeps.sweep import Sweep
from solvers.sweeps.worker import integrated

#: Seconds that a chunk takes at most, about, and what it costs beside its motions.
CHUNK, COST = 1.0, 0.004
#: Motions that are tried to see how long they take.
TRIED = 64
#: Seconds for each evaluation of a right-hand side with n numbers: this times n^1.5.
EVALUATION = 0.25e-9
#: Largest number of bytes that a chunk's states may take; all that it keeps of its motions while
#: they run takes about ten times as much.
ROOM = 8e6


def chunk_length(asked: Sweep, job: Job) -> int:
    """How many motions a chunk is to hold: what takes about a second, in short sweeps less.

    There, so much that chunks cost no more than it costs to wait for the last of them. How
    long motions take follows from how often some evaluate their right-hand side, not from
    how fast they happen to be, so that a sweep is always cut alike.

    Parameters
    ----------
    asked : Sweep
        What is to be done.
    job : Job
        The same, for one motion.

    Returns
    -------
    int
        One at least.
    """
    most, maps = asked.motions, asked.maps.values()
    starts, params, status = begun(job, asked.module, some(asked.axes, TRIED))
    there = status == 0
    evaluations = 1
    if there.any():
        tried = integrated(job, asked.module, starts[there], [p[there] for p in params])
        evaluations += int(tried.nfev.sum())
    each = evaluations / len(status) * EVALUATION * len(asked.start) ** 1.5
    events = sum(one.occurrences * len(one.events(asked.module)) for one in maps)
    room = ROOM / (8 * len(asked.start) * (1 + job.samples + events))
    seconds = min(CHUNK, (COST * each * most) ** 0.5)
    return max(1, int(min(seconds / each, room)))
