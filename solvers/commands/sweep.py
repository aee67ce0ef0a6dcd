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

import numpy as np

from solvers.catalogue import load
from solvers.jsonable import jsonable
from solvers.pictures import save
from solvers.progress import Progress
from solvers.said import InputError
from solvers.sweeps.drawn import drawn
from solvers.sweeps.folder import FolderError
from solvers.sweeps.pool import Pool
from solvers.sweeps.reading import find, names
from solvers.sweeps.results import Results
from solvers.sweeps.running import sofar, sweep
from solvers.sweeps.sweep import Sweep

#: Seconds to wait for a scheduler.
PATIENCE = 20


def main(
    argv: Sequence[str], module: Callable[[str], ModuleType],
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
    try:
        asked = find(arguments.sweep, module)
        folder = arguments.output or Path("out") / asked.name
        begun = time.perf_counter()
        with Progress() as tell:
            tell("the first motions")
            if arguments.draw:
                results = sofar(asked, folder)
            else:
                with _pool(arguments.scheduler, arguments.workers, package) as pool:
                    results = sweep(asked, folder, pool=pool, tell=tell)
            seconds = time.perf_counter() - begun
            tell("the picture")
            picture = folder / f"{asked.name}.png"
            save(drawn(results), picture)
    except (InputError, FolderError) as error:
        parser.error(str(error))
    except KeyboardInterrupt:
        print("interrupted: the same command goes on from here", file=sys.stderr)
        raise
    if arguments.json:
        print(json.dumps(jsonable(figures(results, seconds)), indent=2))
    else:
        print(*told(results, seconds), f"files: {picture} and {folder}/*.npy", sep="\n")
    return 0


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


def told(results: Results, seconds: float) -> Iterator[str]:
    """What was done, how the motions ended, and what the maps hold."""
    asked = results.asked
    yield asked.title
    yield (
        f"{asked.motions:,} motions of {asked.duration:g} s, {load(asked.method).title}, "
        f"{asked.form} form, rtol = {asked.rtol:g}: {seconds:.3g} s"
    )
    yield "ended: " + ", ".join(f"{name} {n:,}" for name, n in results.count.items())
    for name, values in ranges(results).items():
        low, middle, high = values["smallest"], values["median"], values["largest"]
        unit = values["unit"] and f" {values['unit']}"
        yield (
            f"{name}: {low:.6g} to {high:.6g}{unit}, median {middle:.6g}{unit}, "
            f"{values['known']:.1%} known"
        )


def ranges(results: Results) -> dict[str, dict[str, Any]]:
    """What each map holds; of several components, what of each."""
    found, module = {}, results.asked.module
    for name, one in results.asked.maps.items():
        of = one.labels[0] if one.labels else ()
        whole = results.maps[name]
        parts = np.moveaxis(whole, -len(one.shape), 0) if of else [whole]
        for component, values in zip(of or ("",), parts, strict=True):
            finite = values[np.isfinite(values)]
            low, middle, high = (
                np.percentile(finite, (0, 50, 100)).tolist() if finite.size else [np.nan] * 3
            )
            found[f"{name} {component}".strip()] = {
                "smallest": low, "median": middle, "largest": high,
                "unit": module.UNITS[component] if component else one.unit(module),
                "known": finite.size / values.size,
            }  # fmt: skip
    return found


def figures(results: Results, seconds: float) -> dict[str, Any]:
    """The same for programs."""
    asked: Sweep = results.asked
    return {
        "sweep": asked.name, "folder": str(results.folder), "asked": asked.asked,
        "motions": asked.motions, "seconds": seconds, "ended": results.count,
        "maps": ranges(results),
    }  # fmt: skip
