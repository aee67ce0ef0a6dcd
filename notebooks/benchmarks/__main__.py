"""``make bench``: time compiled loops and other programs, at equal global error."""

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from solvers.app.commands import options

PARTS = (
    *("pendulum", "starts", "scenes", "precision", "events", "fits", "pipelines", "chains"),
    *("maps", "mechanisms"),
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the parts in these arguments, or in those of the process; return the exit code."""
    parser = ArgumentParser(
        "benchmarks",
        description="Time compiled loops and other programs at equal global error. All parts take "
        "about fifteen minutes; nothing else should run on the machine meanwhile.",
    )
    meaning = f"one of {', '.join(PARTS)} (default: all)"
    parser.add_argument("parts", nargs="*", metavar="PART", help=meaning)
    options.add_output(parser, "the plot of growth")
    options.add_json(parser)
    arguments = parser.parse_args(argv)
    if unknown := {*arguments.parts} - {*PARTS}:
        parser.error(f"PART must be one of {', '.join(PARTS)}, not {min(unknown)[:50]!r}")
    try:
        return run(arguments)
    except OSError as error:  # no compiler, or a package is not installed
        print(f"benchmarks: {error}", file=sys.stderr)
        return 4


def run(arguments: Namespace) -> int:
    """Measure and print."""
    results = {}
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
    from benchmarks import (
        chains,
        double_pendulum,
        events,
        exudyn,
        fits,
        flip_maps,
        mechanisms,
        other_programs,
        pipeline,
        precision,
        squeezer,
        starts,
    )
    from benchmarks import derivation_timing as timing
    from benchmarks.mechanism_models import MECHANISMS
    from solvers.app.modules import load
    from solvers.io.figures import save
    from solvers.scenes.scene_reading import find

    peer = partial(options.required_package, extra="bench")
    module = load("double_pendulum")
    match part:
        case "pendulum":
            results = double_pendulum.figures(module, timing.lambdified_rhs(), peer("heyoka"))
            return results, double_pendulum.summary(results)
        case "starts":
            ratios = starts.figures({name: load(name) for name in starts.SYSTEMS}, peer("heyoka"))
            return ratios, starts.summary(ratios)
        case "scenes":
            costs = [other_programs.scene_costs(find(name, load)) for name in ("report", "single")]
            for one in costs:
                save(one.plot(), folder / f"other_programs_{one.scene}.png")
            return costs, [line for one in costs for line in one.summary()]
        case "precision":
            times = precision.figures(module, peer("heyoka"))
            return times, precision.summary(times)
        case "events":
            crossings = events.figures(module, peer("heyoka"))
            return crossings, events.summary(crossings)
        case "fits":
            driven = fits.torque_figures(fits.arm_with_friction())
            free = fits.figures(module, peer)
            lines = [*fits.summary(driven), "", *fits.summary(free)]
            return {"torques": driven, "free": free}, lines
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


if __name__ == "__main__":
    sys.exit(main())
