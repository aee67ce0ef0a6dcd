"""``holonomic bench``."""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

from solvers.app.commands import options

SUMMARY = "time compiled loops and other programs"
PARTS = (
    *("pendulum", "starts", "precision", "events", "fits", "pipelines", "chains", "maps"),
    "mechanisms",
)


def add_arguments(parser: ArgumentParser) -> None:
    """Describe the command and its arguments."""
    parser.description = (
        "Time compiled loops and other programs at equal global error. All parts take about "
        "fifteen minutes; nothing else should run on the machine meanwhile."
    )
    meaning = f"one of {', '.join(PARTS)} (default: all)"
    action = parser.add_argument("parts", nargs="*", metavar="PART", help=meaning)
    options.complete_with(action, "parts", PARTS)
    options.add_output(parser, "the plot of growth")
    options.add_json(parser)
    options.add_examples(parser, "holonomic bench --json > figures.json", "holonomic bench chains")


def run(arguments: Namespace) -> int:
    """Measure and print."""
    results = {}
    if unknown := {*arguments.parts} - {*PARTS}:
        raise ValueError(f"PART must be one of {', '.join(PARTS)}, not {min(unknown)[:50]!r}")
    _check_compiler()
    for part in [part for part in PARTS if part in (arguments.parts or PARTS)]:
        results[part], lines = _results(part, arguments.output)
        if not arguments.json:
            print(*lines, sep="\n", flush=True)
    if arguments.json:
        options.print_json(results)
    return 0


def _check_compiler() -> None:
    """Raise `NoCompilerError` before anything is measured."""
    from solvers.app.modules import load
    from solvers.integration.prepare import prepare

    module = load("double_pendulum")
    prepare(module, module.DEFAULTS)


def _results(part: str, folder: Path) -> tuple[Any, Iterable[str]]:
    """Measurements of a part, and lines of text."""
    from solvers.app import derivation_timing as timing
    from solvers.app.modules import load
    from solvers.io.figures import save
    from solvers.studies import exudyn
    from solvers.studies.benchmarks import (
        chains,
        double_pendulum,
        events,
        fits,
        flip_maps,
        mechanisms,
        pipeline,
        precision,
        squeezer,
        starts,
    )
    from solvers.studies.benchmarks.mechanism_models import MECHANISMS

    peer = partial(options.required_package, extra="bench")
    module = load("double_pendulum")
    match part:
        case "pendulum":
            results = double_pendulum.figures(module, timing.lambdified_rhs(), peer("heyoka"))
            return results, double_pendulum.summary(results)
        case "starts":
            ratios = starts.figures({name: load(name) for name in starts.SYSTEMS}, peer("heyoka"))
            return ratios, starts.summary(ratios)
        case "precision":
            times = precision.figures(module, peer("heyoka"))
            return times, precision.summary(times)
        case "events":
            crossings = events.figures(module, peer("heyoka"))
            return crossings, events.summary(crossings)
        case "fits":
            programs = fits.figures(module, peer)
            return programs, fits.summary(programs)
        case "pipelines":
            rows = pipeline.pipelines(module, peer, timing.chain, timing.mechanics)
            return rows, [*pipeline.summary(rows), ""]
        case "chains":
            results = chains.figures(timing.chain, timing.lagranges_method, load, peer("heyoka"))
            plot = folder / "growth.png"
            save(chains.plot(results["growth"]), plot)
            return results, [*chains.summary(results), f"plot: {plot}"]
        case "maps":
            results = flip_maps.figures(module, peer("heyoka"), peer("numba"))
            return results, flip_maps.summary(results)
        case _:  # mechanisms
            systems = {name: load(name) for name in MECHANISMS}
            beside = mechanisms.figures(systems, exudyn.fast(peer))
            squeezed = squeezer.figures(load("andrews_squeezer"))
            lines = [*mechanisms.summary(beside), *squeezer.summary(squeezed)]
            return {"exudyn": beside, "squeezer": squeezed}, lines
