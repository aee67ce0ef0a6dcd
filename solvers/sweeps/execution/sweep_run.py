"""Run a sweep: compute its chunks, store them, and estimate how far the maps converged."""

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from solvers.equations.signature_checks import checked
from solvers.io.terminal import ProgressRate
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.folder import Folder
from solvers.sweeps.execution.pool import Pool
from solvers.sweeps.execution.worker import run_chunk
from solvers.sweeps.results import Results

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


THREADS = Pool()
#: Number of motions that are integrated first, to estimate times and to compare the arithmetic.
SAMPLE = 64


def sweep(
    definition: Sweep,
    folder: str | Path,
    *,
    pool: Pool = THREADS,
    report: Callable[[str], None] = lambda _: None,
) -> Results:
    """Compute the maps of a sweep in a folder, as `solvers.sweep` does."""
    stored = Folder(Path(folder), definition)
    sample = definition.axes.subset(SAMPLE)
    with stored.locked():
        if stored.is_new:
            stored.begin(*pool.first_motions(definition, sample))
        chunks = {*range(stored.chunks)} - {*stored.completed}
        missing = {stored.span(chunk): chunk for chunk in sorted(chunks)}
        rate = ProgressRate(definition.motions, sum(stop - start for start, stop in missing))
        results = pool.completed(definition, [*missing], sample, stored.arithmetic)
        with closing(results) as completed:
            for span, chunk in completed:
                stored.store(missing[span], chunk)
                report(rate(len(chunk)))
        stored.gather()
    return Results.of(definition, Path(folder))


@checked
def partial_results(definition: Sweep, folder: str | Path) -> Results:
    """The results so far of a sweep that is not finished; it may be running.

    Parameters
    ----------
    definition : Sweep
        The motions and maps.
    folder : str or Path
        The folder of the sweep; nothing in it is changed.

    Returns
    -------
    Results
        With NaN and status 0 for motions that are not done yet.

    Raises
    ------
    solvers.sweeps.execution.folder.FolderError
        When another sweep is in the folder, or none.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> from solvers import Final, Grid, Sweep, partial_results, sweep
    >>> definition = Sweep(dp, Grid({"theta1": [0.1], "theta2": [0.2]}),
    ...                    {"end": Final(("theta1",))}, duration=5)
    >>> results = sweep(definition, "end")
    >>> partial_results(definition, "end").count
    {'finished': 1}
    """
    stored = Folder(Path(folder), definition)
    stored.check()
    finished = {name: stored.finished(name) for name in ("status", *definition.maps)}
    status, *maps = (numbers for numbers, _ in finished.values())
    numbers = dict(zip(definition.maps, maps, strict=True))
    records = {name: one for name, (_, one) in finished.items() if one}
    axes = definition.axes.coordinates()
    return Results(definition, Path(folder), numbers, axes, status, records)
