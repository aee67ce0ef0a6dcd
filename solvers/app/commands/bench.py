"""``holonomic bench``."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterable
from pathlib import Path
from types import ModuleType
from typing import Any

from solvers.app.commands import options

SUMMARY = "time compiled loops and other programs"


def add_arguments(parser: ArgumentParser) -> None:
    """Describe the command and its arguments."""
    parser.description = (
        "Time compiled loops and other programs at equal global error. All parts take about ten "
        "minutes; nothing else should run on the machine meanwhile."
    )
    meaning = f"one of {', '.join(PARTS)} (default: all)"
    action = parser.add_argument("parts", nargs="*", metavar="PART", help=meaning)
    options.complete_with(action, "parts", tuple(PARTS))
    options.add_output(parser, "the plot of growth")
    options.add_json(parser)
    options.add_examples(parser, "holonomic bench --json > figures.json", "holonomic bench chains")


def run(arguments: Namespace) -> int:
    """Measure and print."""
    results = {}
    if unknown := {*arguments.parts} - {*PARTS}:
        raise ValueError(f"PART must be one of {', '.join(PARTS)}, not {min(unknown)[:50]!r}")
    for part in [part for part in PARTS if part in (arguments.parts or PARTS)]:
        results[part], lines = PARTS[part](arguments.output)
        if not arguments.json:
            print(*lines, sep="\n", flush=True)
    if arguments.json:
        options.print_json(results)
    return 0


def _peer(name: str) -> ModuleType:
    from solvers.app.packages import required_package

    return required_package(name, "bench")


def _pendulum(_: Path) -> tuple[Any, Iterable[str]]:
    from solvers.app.derivation_timing import lambdified_rhs
    from solvers.app.modules import load
    from solvers.studies.benchmarks import double_pendulum

    module = load("double_pendulum")
    found = double_pendulum.figures(module, lambdified_rhs(), _peer("heyoka"))
    return found, double_pendulum.summary(found)


def _pipelines(_: Path) -> tuple[Any, Iterable[str]]:
    from solvers.app.derivation_timing import chain, mechanics
    from solvers.app.modules import load
    from solvers.studies.benchmarks import pipeline

    found = pipeline.pipelines(load("double_pendulum"), _peer, chain, mechanics)
    return found, [*pipeline.summary(found), ""]


def _chains(folder: Path) -> tuple[Any, Iterable[str]]:
    from solvers.app.derivation_timing import chain, lagranges_method
    from solvers.app.modules import load
    from solvers.io.figures import save
    from solvers.studies.benchmarks import chains, growth

    found = chains.figures(chain, lagranges_method, load, _peer("heyoka"))
    plot = folder / "growth.png"
    save(growth.plot(found["growth"]), plot)
    return found, [*chains.summary(found), f"plot: {plot}"]


def _maps(_: Path) -> tuple[Any, Iterable[str]]:
    from solvers.app.modules import load
    from solvers.studies.benchmarks import flip_maps

    found = flip_maps.figures(load("double_pendulum"), _peer("heyoka"), _peer("numba"))
    return found, flip_maps.summary(found)


PARTS: dict[str, Callable[[Path], tuple[Any, Iterable[str]]]] = {
    "pendulum": _pendulum,
    "pipelines": _pipelines,
    "chains": _chains,
    "maps": _maps,
}
