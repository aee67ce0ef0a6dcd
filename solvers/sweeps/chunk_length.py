"""Number of motions in a chunk."""

from solvers.sweeps.initial_states import initial_states
from solvers.sweeps.sweep import Sweep
from solvers.sweeps.worker import integrated

#: Longest duration of a chunk in s, approximately, and its overhead.
CHUNK, COST = 1.0, 0.004
#: Number of motions that are timed.
TRIALS = 64
#: Seconds for each evaluation of a right-hand side of n components: this times n^1.5.
EVALUATION = 0.25e-9
#: Largest number of bytes for the states of a chunk; its working memory is about ten times as much.
MAX_BYTES = 8e6


def chunk_length(sweep: Sweep) -> int:
    """Number of motions in a chunk: about a second of work, less in short sweeps."""
    # in short sweeps chunks cost as much as waiting for the last of them; time follows from the
    # number of evaluations, not from the clock, so that a sweep is always divided in the same way
    starts, params, status = initial_states(sweep, sweep.axes.subset(TRIALS))
    runs = status == 0
    evaluations = 1
    if runs.any():
        evaluations += int(integrated(sweep, starts[runs], [p[runs] for p in params]).nfev.sum())
    size = len(sweep.state)
    each = evaluations / len(status) * EVALUATION * size**1.5
    events = sum(one.occurrences * len(one.events(sweep.module)) for one in sweep.maps.values())
    most = MAX_BYTES / (8 * size * (1 + sweep.samples + events))
    seconds = min(CHUNK, (COST * each * sweep.motions) ** 0.5)
    return max(1, int(min(seconds / each, most)))
