"""Run a sweep: compute its chunks and store them in its folder."""

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from solvers.equations.signature_checks import checked
from solvers.io.terminal import ProgressRate
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.folder import Folder
from solvers.sweeps.execution.pool import Pool
from solvers.sweeps.results import Results

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
