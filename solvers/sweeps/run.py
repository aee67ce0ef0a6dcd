"""Run a sweep: its chunks go to whoever executes them, and into its folder as they come back."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.io.atomic_write import write_text
from solvers.io.progress import Rate
from solvers.sweeps.axes import Grid
from solvers.sweeps.chunk_length import chunk_length
from solvers.sweeps.folder import Folder
from solvers.sweeps.job import Job
from solvers.sweeps.pool import Pool
from solvers.sweeps.results import Results
from solvers.sweeps.sweep import Sweep

THREADS = Pool()


def sweep(
    asked: Sweep,
    folder: str | Path,
    *,
    pool: Pool = THREADS,
    tell: Callable[[str], None] = lambda _: None,
) -> Results:
    """Run a sweep, or what is left of it, and put its maps together.

    Parameters
    ----------
    asked : Sweep
        What is to be done.
    folder : str or Path
        Where it is kept; it is made. What is there of the same sweep is not done again.
    pool : Pool, optional
        Who does it; by default threads, one for each processor.
    tell : callable, optional
        ``tell(text)`` is told how far it is.

    Returns
    -------
    Results
        The maps. They are the same to the last bit however the work was shared out, on
        processors of one kind.

    Raises
    ------
    solvers.sweeps.folder.FolderError
        When another sweep is in the folder, or another process works there.
    OSError
        When something cannot be written, or there is not room enough.
    KeyboardInterrupt
        When the user interrupts; the chunks that are done are kept, and the same call goes on.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> from solvers.sweeps.axes import Grid
    >>> from solvers.sweeps.maps import Extremes
    >>> from solvers.sweeps.sweep import Sweep
    >>> axes = Grid({"theta1": [0.1, 0.2, 0.3], "theta2": [0.0, 0.1]})
    >>> results = sweep(Sweep(dp, axes, {"reach": Extremes(("theta2",))}, duration=5), "reach")
    >>> results.maps["reach"].shape
    (3, 2, 1, 2)
    >>> results.count
    {'finished': 6}
    """
    job = Job.of(asked)
    with _folder(asked, job, folder) as kept:
        left = {kept.span(chunk): chunk for chunk in range(kept.chunks) if chunk not in kept.done}
        rate = Rate(asked.motions, sum(end - begin for begin, end in left))
        with (
            pool.opened() as executor,
            closing(pool.completed(executor, job, asked.axes, [*left])) as completed,
        ):
            for span, found in completed:
                kept.keep(left[span], found)
                tell(rate(len(found)))
        gathered(asked, kept)
    return Results.of(asked, Path(folder))


def sofar(asked: Sweep, folder: str | Path) -> Results:
    """What is there of a sweep that is not finished; it may be going on.

    Parameters
    ----------
    asked : Sweep
        What is being done.
    folder : str or Path
        Where it is kept; nothing in it is changed.

    Returns
    -------
    Results
        With NaN for motions that are not done yet, whose status is 0.

    Raises
    ------
    solvers.sweeps.folder.FolderError
        When another sweep is in the folder, or none.
    """
    job = Job.of(asked)
    kept = _folder(asked, job, folder)
    kept.look()

    def whole(name: str) -> NDArray[Any]:
        found = np.concatenate([*kept.rows(name)])
        return found.reshape(*asked.axes.shape, *found.shape[1:])

    varied = asked.axes.columns(0, asked.motions)
    axes = asked.axes.values if isinstance(asked.axes, Grid) else varied
    maps = {name: whole(name) for name in asked.maps}
    return Results(asked, Path(folder), maps, dict(axes), whole("status"))


def _folder(asked: Sweep, job: Job, folder: str | Path) -> Folder:
    return Folder(
        Path(folder), asked.asked, asked.motions, lambda: chunk_length(asked, job), job.dtype
    )


def gathered(asked: Sweep, kept: Folder) -> None:
    """Put together what is there, and write the axes of a grid."""
    kept.gather(asked.axes.shape)
    if isinstance(asked.axes, Grid):
        for name, values in asked.axes.values.items():
            file = BytesIO()
            np.save(file, values, allow_pickle=False)
            write_text(kept.path / f"{name}.npy", file.getvalue())
