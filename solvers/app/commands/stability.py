"""``holonomic stability``."""

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING, Any

from solvers.app.commands import options

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SUMMARY = "longest stable steps, and where methods fail"
DEFAULT = ("report",)


def add_arguments(parser: ArgumentParser) -> None:
    """Describe the command and its arguments."""
    parser.description = (
        "For every method: the exact stability function and its intervals, and the longest stable "
        "step of a scene's small oscillations, predicted and measured. Without a scene the command "
        "also studies where methods fail, which takes about two minutes."
    )
    options.add_scenes(parser, DEFAULT)
    options.add_output(parser, "plots")
    options.add_json(parser)
    options.add_examples(parser, "holonomic stability single --json")


def run(arguments: Namespace) -> int:
    """Compute, plot and print."""
    from solvers.app.modules import load
    from solvers.io.terminal import Progress
    from solvers.studies.stability import SceneStability

    results: dict[str, Any] = {"methods": [], "failures": {}, "pictures": []}
    show = partial(_show, arguments, results["pictures"])
    for scene in options.selected_scenes(arguments, DEFAULT):
        with Progress() as report:
            stability = SceneStability.of(scene, report)
        results["methods"] += stability.rows()
        show(f"stability_{scene.name}", stability.summary(), stability.plot())
    for study in () if arguments.scenes else _failure_modes():
        with Progress() as report:
            report(f"where methods fail: {study.name}")
            failures = study.run(load)
        results["failures"][study.name] = failures
        # the prefix keeps these apart from plots of scenes
        show(f"failures_{study.name}", study.summary(failures), study.plot(failures))
    if arguments.json:
        options.print_json(results)
    return 0


def _failure_modes() -> Iterable[Any]:
    from solvers.app.modules import load
    from solvers.integration.prepare import no_compiler
    from solvers.studies.failure_modes.study import studies

    if missing := no_compiler(load("single_pendulum")):
        print(f"the study of failure modes is left out: {missing}", file=sys.stderr)
        return ()
    return studies()


def _show(
    arguments: Namespace, plots: list[str], name: str, lines: Iterable[str], figure: "Figure"
) -> None:
    from solvers.io.figures import save

    plot = arguments.output / f"{name}.png"
    save(figure, plot)
    plots.append(str(plot))
    if not arguments.json:
        print(*lines, f"plot: {plot}", "", sep="\n", flush=True)
