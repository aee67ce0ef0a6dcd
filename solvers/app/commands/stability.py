"""``holonomic stability``."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from solvers.app.commands import options

if TYPE_CHECKING:
    from solvers.scenes.scene import Scene

SUMMARY = "longest stable steps, and where methods fail"
DEFAULT = ("report",)


def add_arguments(parser: ArgumentParser) -> None:
    """Describe the command and its arguments."""
    parser.description = (
        "For every method: the exact stability function and its intervals, and the longest stable "
        "step of a scene's small oscillations, predicted and measured. Without a scene the command "
        "also studies where methods fail, which takes about two minutes."
    )
    options.add_scenes(parser, "a name, or a file that ends in .toml", DEFAULT)
    options.add_output(parser, "plots")
    options.add_json(parser)
    options.add_examples(parser, "holonomic stability single --json", scenes=True)


def run(arguments: Namespace) -> int:
    """Compute, plot and print."""
    results: dict[str, Any] = {"methods": [], "failures": {}, "pictures": []}
    for scene in options.selected_scenes(arguments, DEFAULT):
        rows, text, plot = _critical_steps(scene, arguments.output)
        results["methods"] += rows
        _print(arguments, results, text, plot)
    if not arguments.scenes:
        for name, result, lines, plot in _failure_modes(arguments.output):
            results["failures"][name] = result
            _print(arguments, results, lines, plot)
    if arguments.json:
        options.print_json(results)
    return 0


def _print(arguments: Namespace, results: dict[str, Any], lines: Iterable[str], plot: Path) -> None:
    results["pictures"].append(str(plot))
    if not arguments.json:
        print(*lines, f"plot: {plot}", "", sep="\n", flush=True)


def _critical_steps(scene: Scene, folder: Path) -> tuple[list[Any], Iterator[str], Path]:
    from solvers.io.figures import save
    from solvers.io.progress import Progress
    from solvers.studies.stability.scene_stability import SceneStability

    with Progress() as report:
        study = SceneStability.of(scene, report)
    plot = folder / f"stability_{scene.name}.png"
    save(study.plot(), plot)
    return study.rows(), study.summary(), plot


def _failure_modes(folder: Path) -> Iterator[tuple[str, Any, Iterable[str], Path]]:
    from solvers.app.modules import load
    from solvers.integration.prepare import no_compiler
    from solvers.io.figures import save
    from solvers.io.progress import Progress
    from solvers.studies.failure_modes.study import studies

    if missing := no_compiler(load("single_pendulum")):
        print(f"the study of failure modes is left out: {missing}", file=sys.stderr)
        return
    for study in studies():
        with Progress() as report:
            report(f"where methods fail: {study.name}")
            results = study.run(load)
        plot = folder / f"failures_{study.name}.png"  # scenes have names, too
        save(study.plot(results), plot)
        yield study.name, results, study.summary(results), plot
