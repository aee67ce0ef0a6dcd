"""``holonomic sweep``: maps of very many motions."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

from solvers.equations.module import GeneratedModule
from solvers.io.figures import save
from solvers.io.json_values import jsonable
from solvers.io.progress import Progress
from solvers.sweeps.convergence import convergence
from solvers.sweeps.plots.figure import figure
from solvers.sweeps.pool import Pool
from solvers.sweeps.reading import find, names
from solvers.sweeps.run import partial_results, sweep
from solvers.sweeps.summary import GOOD, as_json, summary

#: Seconds to wait for a scheduler.
PATIENCE = 20


def main(
    argv: Sequence[str], module: Callable[[str], GeneratedModule],
    package: Callable[[str], ModuleType | None],
) -> int:  # fmt: skip
    """Run a sweep, plot its maps and print a summary.

    Parameters
    ----------
    argv : sequence of str
        Options.
    module : callable
        Gives a generated module by its name; raises `LookupError` for an unknown one.
    package : callable
        Gives a package by its name, or None if it is not installed.

    Returns
    -------
    int
        Exit code: 0, or 3 when no motion has ended as it should.

    Raises
    ------
    KeyboardInterrupt
        When the user interrupts; the chunks that are done are kept.
    ValueError
        When the sweep makes no sense, or another one is in its folder.
    OSError
        When no scheduler answers, Dask is not installed, or a file cannot be written.
    """
    parser = argparse.ArgumentParser(
        prog="holonomic sweep",
        description="Maps of many motions, as a file defines them. After an interruption the same "
        "command resumes.",
        epilog=f"sweeps: {', '.join(names())}\n\nexample:\n  holonomic sweep flips --output flips",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("sweep", metavar="SWEEP",
                        help="name of a sweep, or a file that ends in .toml")  # fmt: skip
    parser.add_argument("--output", type=Path, metavar="DIR",
                        help="folder of this sweep (default: out/SWEEP)")  # fmt: skip
    parser.add_argument(
        "--workers", type=int, metavar="N",
        help="number of chunks at a time (default: one for each processor)",
    )  # fmt: skip
    parser.add_argument(
        "--scheduler", metavar="ADDRESS",
        help="address of a Dask cluster to compute on, as tcp://host:8786",
    )  # fmt: skip
    parser.add_argument("--draw", action="store_true",
                        help="plot the results so far, and compute nothing")  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print numbers for programs")
    arguments = parser.parse_args(argv)
    definition = find(arguments.sweep, module)
    folder = arguments.output or Path("out") / definition.name
    start, changes = time.perf_counter(), {}
    with Progress() as report:
        report("the first motions")
        if arguments.draw:
            results = partial_results(definition, folder)
        else:
            try:
                with _pool(arguments.scheduler, arguments.workers, package) as pool:
                    results = sweep(definition, folder, pool=pool, report=report)
            except KeyboardInterrupt:
                print("interrupted: the same command resumes", file=sys.stderr)
                raise
        seconds = time.perf_counter() - start
        if not arguments.draw:
            report("some motions again, with tighter tolerances")
            changes = convergence(definition)
        report("the figure")
        picture = folder / f"{definition.name}.png"
        save(figure(results), picture)
    if arguments.json:
        print(json.dumps(jsonable(as_json(results, seconds, changes)), indent=2))
    else:
        print(*summary(results, None if arguments.draw else seconds, changes), sep="\n")
        print(f"files: {picture}" + ("" if arguments.draw else f" and {folder}/*.npy"))
    return 0 if any(status in GOOD for status in results.count) else 3


@contextmanager
def _pool(
    address: str | None, workers: int | None, package: Callable[[str], ModuleType | None]
) -> Iterator[Pool]:
    """Who does the work: threads here, or the cluster behind a scheduler."""
    if address is None:
        yield Pool(workers=workers)
        return
    distributed: Any = package("distributed")
    if distributed is None:
        raise OSError("--scheduler needs Dask: pip install 'holonomic[cluster]'")
    try:
        client = distributed.Client(address, timeout=PATIENCE)
    except (OSError, ValueError, TimeoutError) as error:
        raise OSError(f"no scheduler answers at {address}: {error}") from error
    with client:
        threads = sum(client.nthreads().values())
        yield Pool(client.get_executor(), workers or max(threads, 1))
