"""``holonomic sweep``."""

import logging
import sys
import time
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from solvers.app.commands import options

if TYPE_CHECKING:
    from solvers.sweeps.execution.pool import Pool

SUMMARY = "map many motions: flips, exponents, sections"
#: Seconds to wait for a scheduler.
PATIENCE = 20


def add_arguments(parser: ArgumentParser) -> None:
    """Describe the command and its arguments."""
    parser.description = (
        "Map many motions: a file specifies which values vary and which results are kept. An "
        "interrupted sweep resumes when the same command runs again."
    )
    meaning = "a name, or a file that ends in .toml"
    action = parser.add_argument("sweep", metavar="SWEEP", help=meaning)
    options.complete_with(action, "sweeps", options.shipped("sweeps"))
    options.add_list(parser, "sweeps", "title")
    options.add_output(parser, "the sweep", "out/SWEEP")
    parser.set_defaults(output=None)  # the name of the sweep is not known yet
    workers = "number of concurrent chunks (default: one for each processor)"
    parser.add_argument("--workers", type=int, metavar="N", help=workers)
    scheduler = "address of a Dask scheduler that runs the chunks, such as tcp://host:8786"
    parser.add_argument("--scheduler", metavar="ADDRESS", help=scheduler)
    parser.add_argument("--draw", action="store_true", help="plot partial results and exit")
    options.add_json(parser)
    options.add_examples(parser, "holonomic sweep flips --output flips")


def run(arguments: Namespace) -> int:
    """Run or resume a sweep, plot its maps and print statistics; return 3 if none completed."""
    from solvers.app.modules import load
    from solvers.io.figures import save
    from solvers.io.terminal import Progress
    from solvers.sweeps.definition.sweep_reading import find
    from solvers.sweeps.execution.sweep_run import convergence, partial_results, sweep
    from solvers.sweeps.results import GOOD
    from solvers.sweeps.sweep_figure import figure
    from solvers.sweeps.sweep_summary import as_json, summary

    definition = find(arguments.sweep, load)
    folder = arguments.output or Path("out") / definition.name
    start, changes = time.perf_counter(), {}
    with Progress() as report:
        report("the first motions")
        if arguments.draw:
            results = partial_results(definition, folder)
        else:
            try:
                with _pool(arguments) as pool:
                    results = sweep(definition, folder, pool=pool, report=report)
            except KeyboardInterrupt:
                print("interrupted: the same command resumes the sweep", file=sys.stderr)
                raise
        seconds = time.perf_counter() - start
        if not arguments.draw:
            report("a sample of motions with tighter tolerances")
            changes = convergence(definition)
        report("the plot")
        plot = folder / f"{definition.name}.png"
        save(figure(results), plot)
    if arguments.json:
        options.print_json(as_json(results, seconds, changes))
    else:
        print(*summary(results, None if arguments.draw else seconds, changes), sep="\n")
        print(f"files: {plot}" + ("" if arguments.draw else f" and {folder}/*.npy"))
    return 0 if any(status in GOOD for status in results.count) else 3


@contextmanager
def _pool(arguments: Namespace) -> "Iterator[Pool]":
    """Threads of this process, or the cluster behind a scheduler."""
    from solvers.sweeps.execution.pool import LostWorkersError, Pool

    address, workers = arguments.scheduler, arguments.workers
    if address is None:
        yield Pool(workers=workers)
        return
    distributed: Any = options.required_package("distributed", "cluster")
    logging.disable()  # the exceptions suffice
    try:
        try:
            client = distributed.Client(address, timeout=PATIENCE)
        except (OSError, ValueError, TimeoutError) as error:
            raise OSError(f"no scheduler answers at {address}: {error}") from error
        with client:
            yield Pool(client.get_executor(), workers, lambda: sum(client.nthreads().values()))
    except (LostWorkersError, distributed.scheduler.KilledWorker) as error:
        raise LostWorkersError(
            f"the cluster at {address} is gone, or its workers fail: completed chunks are kept, "
            "and the same command resumes the sweep"
        ) from error
    finally:
        logging.disable(logging.NOTSET)
