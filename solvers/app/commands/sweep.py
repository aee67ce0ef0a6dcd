"""``holonomic sweep``: maps of very many motions."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.io.figures import save
from solvers.io.json_values import jsonable
from solvers.io.progress import Progress
from solvers.runge_kutta.catalogue import load
from solvers.sweeps.convergence import Trust, tighter, trust
from solvers.sweeps.maps import Extremes
from solvers.sweeps.plots.figure import drawn
from solvers.sweeps.pool import Pool
from solvers.sweeps.reading import find, names
from solvers.sweeps.results import Results
from solvers.sweeps.run import sofar, sweep
from solvers.sweeps.sweep import Sweep

#: Seconds to wait for a scheduler.
PATIENCE = 20
#: How motions end that have something in the maps.
GOOD = ("finished", "event", "proved")
#: What to do about others.
HINTS = {"step limit": "raise max_steps", "step too small": "a singularity, most likely",
         "not done yet": "the same command without --draw goes on"}  # fmt: skip


def main(
    argv: Sequence[str], module: Callable[[str], GeneratedModule],
    package: Callable[[str], ModuleType | None],
) -> int:  # fmt: skip
    """Run a sweep, draw its maps and print what they hold.

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
        description="Map very many motions: what varies and what is kept of each stands in a "
        "file. The same command goes on where it was interrupted.",
        epilog=f"sweeps: {', '.join(names())}\n\nexample:\n  holonomic sweep flips --output flips",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("sweep", metavar="SWEEP",
                        help="what to do: a name, or a file that ends in .toml")  # fmt: skip
    parser.add_argument("--output", type=Path, metavar="DIR",
                        help="folder of this sweep (default: out/SWEEP)")  # fmt: skip
    parser.add_argument(
        "--workers", type=int, metavar="N",
        help="how many chunks at a time (default: one for each processor)",
    )  # fmt: skip
    parser.add_argument(
        "--scheduler", metavar="ADDRESS",
        help="of a Dask cluster that does the work, as tcp://host:8786",
    )  # fmt: skip
    parser.add_argument("--draw", action="store_true",
                        help="draw what is there so far, and do nothing else")  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print figures for programs")
    arguments = parser.parse_args(argv)
    asked = find(arguments.sweep, module)
    folder = arguments.output or Path("out") / asked.name
    begun, doubts = time.perf_counter(), {}
    with Progress() as tell:
        tell("the first motions")
        if arguments.draw:
            results = sofar(asked, folder)
        else:
            try:
                with _pool(arguments.scheduler, arguments.workers, package) as pool:
                    results = sweep(asked, folder, pool=pool, tell=tell)
            except KeyboardInterrupt:
                print("interrupted: the same command goes on from here", file=sys.stderr)
                raise
        seconds = time.perf_counter() - begun
        if not arguments.draw:
            tell("some motions once more, with tighter tolerances")
            doubts = trust(asked)
        tell("the picture")
        picture = folder / f"{asked.name}.png"
        save(drawn(results), picture)
    if arguments.json:
        print(json.dumps(jsonable(figures(results, seconds, doubts)), indent=2))
    else:
        print(*told(results, None if arguments.draw else seconds, doubts), sep="\n")
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


def told(
    results: Results, seconds: float | None, doubts: Mapping[str, Trust]
) -> Iterator[str]:  # fmt: skip
    """What was done, how the motions ended, what the maps hold, and how sure that is."""
    asked = results.asked
    yield asked.title
    took = "" if seconds is None else f": {seconds:.3g} s this time"
    yield (
        f"{asked.motions:,} motions of {asked.duration:g} s, {load(asked.method).title}, "
        f"{asked.form} form, rtol = {asked.rtol:g}{took}"
    )
    yield "ended: " + ", ".join(
        f"{name} {n:,}{f' ({HINTS[name]})' if name in HINTS else ''}"
        for name, n in results.count.items()
    )
    for name, values in ranges(results).items():
        low, middle, high = values["smallest"], values["median"], values["largest"]
        unit = values["unit"] and f" {values['unit']}"
        if not values["known"]:
            yield f"{name}: nothing"
            continue
        yield (
            f"{name}: {low:.6g} to {high:.6g}{unit}, median {middle:.6g}{unit}; "
            f"{values['known']:.1%} of the map is known"
        )
    for name, doubt in doubts.items():
        unit = asked.maps[name].unit(asked.module)
        lost = f", and {doubt.lost:.0%} are lost or found" if doubt.lost else ""
        yield (
            f"of {doubt.motions} motions once more with rtol = {tighter(asked):g}, half of {name} "
            f"changes by less than {doubt.median:.1g} {unit}".rstrip()
            + f", nine tenths by less than {doubt.most:.1g} {unit}".rstrip()
            + lost
        )


def ranges(results: Results) -> dict[str, dict[str, Any]]:
    """What each map holds; of several components, what of each."""
    found, module = {}, results.asked.module
    for name, one in results.asked.maps.items():
        # the smallest and the largest value of something have no common median
        labels = one.labels[: 2 if isinstance(one, Extremes) else 1]
        rows = results.maps[name].reshape(-1, *one.shape)
        for place in np.ndindex(*map(len, labels)):
            words = [part[k] for part, k in zip(labels, place, strict=True)]
            values = rows[(slice(None), *place)]
            finite = values[np.isfinite(values)]
            low, middle, high = (
                np.percentile(finite, (0, 50, 100)).tolist() if finite.size else [np.nan] * 3
            )
            found[" ".join([name, *words])] = {
                "smallest": low, "median": middle, "largest": high,
                "unit": module.UNITS[words[0]] if words else one.unit(module),
                "known": finite.size / values.size,
            }  # fmt: skip
    return found


def figures(
    results: Results, seconds: float, doubts: Mapping[str, Trust]
) -> dict[str, Any]:  # fmt: skip
    """The same for programs."""
    asked: Sweep = results.asked
    return {
        "sweep": asked.name, "folder": str(results.folder), "asked": asked.asked,
        "motions": asked.motions, "seconds": seconds, "ended": results.count,
        "maps": ranges(results), "under tighter tolerances": doubts,
    }  # fmt: skip
