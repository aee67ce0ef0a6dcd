"""``holonomic chart``."""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from solvers.app.commands import options

if TYPE_CHECKING:
    from solvers.scenes.scene import Scene
    from solvers.studies.work_precision.cost_curve import Combination
    from solvers.studies.work_precision.scene_curves import SceneCurves

SUMMARY = "chart speed against accuracy"
DEFAULT = ("report", "long", "single")


def add_arguments(parser: ArgumentParser) -> None:
    """Describe the command and its arguments."""
    parser.description = (
        "Chart speed against accuracy for every method, form and backend. The default scenes take "
        "about two minutes; nothing else should run on the machine meanwhile."
    )
    options.add_scenes(parser, DEFAULT)
    options.add_output(parser, "plots")
    options.add_json(parser)
    record = "chart compiled loops only and record the cheapest methods, which scenes then use"
    parser.add_argument("--record", action="store_true", help=record)
    options.add_examples(parser, "holonomic chart report --json")


def run(arguments: Namespace) -> int:
    """Measure, plot and print."""
    from solvers.integration.accuracy.method_choice import RECORD
    from solvers.io.atomic_write import write_text
    from solvers.io.figures import save
    from solvers.studies.work_precision.scene_curves import record

    results, plots = [], []
    try:
        for scene in options.selected_scenes(arguments, DEFAULT):
            result = _measured(scene, compiled_only=arguments.record)
            results.append(result)
            paths = []
            for name, figure in result.plots().items():
                paths.append(str(arguments.output / f"{name}.png"))
                save(figure, Path(paths[-1]))
            plots += paths
            if not arguments.json:
                print(*result.summary(), f"plots: {', '.join(paths)}", "", sep="\n", flush=True)
    finally:  # a scene that fails loses no other
        if arguments.json and results:
            options.print_json(_as_json(results, plots))
    if arguments.record:
        write_text(RECORD, record(results))
    return 0


def _measured(scene: "Scene", *, compiled_only: bool) -> "SceneCurves":
    from solvers.io.terminal import Progress
    from solvers.studies.work_precision.measured_curves import combinations, curves
    from solvers.studies.work_precision.reference import Reference
    from solvers.studies.work_precision.scene_curves import SceneCurves

    with Progress() as report:
        report(f"{scene.name}: reference")
        reference = Reference.of(scene)
        selected = list(combinations(scene.module))
        if compiled_only:
            selected = [combination for combination in selected if combination[2] == "compiled"]

        def reported() -> "Iterator[Combination]":
            for n, combination in enumerate(selected, 1):
                report(f"{scene.name}: {', '.join(combination)} ({n} of {len(selected)})")
                yield combination

        return SceneCurves.of(scene, reference, curves(scene, reference, reported()))


def _as_json(results: "Sequence[SceneCurves]", plots: Sequence[str]) -> dict[str, Any]:
    from solvers.studies.work_precision.measured_curves import unit_of_energy
    from solvers.studies.work_precision.reference import Reference

    return {
        "energy_error_units": {r.scene.name: unit_of_energy(r.scene).name for r in results},
        "curves": [curve for r in results for curve in r.curves],
        "frontier": [best for r in results for best in (*r.frontier, *r.frontier_rhs)],
        "rounding_limits": {r.scene.name: r.rounding_limits for r in results},
        "misleading_energy": {r.scene.name: r.misleading_energy for r in results},
        "pictures": plots,
        "reference": {
            "method": Reference.METHOD,
            "global_error": max(r.reference.global_error for r in results),
            "scenes": {r.scene.name: r.reference for r in results},
        },
    }
