"""``holonomic chart``: work-precision diagrams of scenes."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from types import ModuleType
from typing import Any

from solvers.app.commands.options import options
from solvers.equations.module import GeneratedModule
from solvers.io.atomic_write import write_text
from solvers.io.figures import save
from solvers.io.json_values import jsonable
from solvers.io.progress import Progress
from solvers.scenes.models.method_choice import RECORD
from solvers.studies.work_precision import peers, plots
from solvers.studies.work_precision.findings import Charted, wrong_from
from solvers.studies.work_precision.measurement import Combination, combinations, curves
from solvers.studies.work_precision.record import recorded
from solvers.studies.work_precision.reference import Reference, reference
from solvers.studies.work_precision.summary import told

#: Scenes that are charted if none is named.
USUAL = ("report", "long", "single")


def main(
    argv: Sequence[str],
    module: Callable[[str], GeneratedModule],
    package: Callable[[str], ModuleType | None],
) -> int:  # fmt: skip
    """Measure, draw and print.

    Parameters
    ----------
    argv : sequence of str
        Options.
    module : callable
        Gives a generated module by its name; raises `LookupError` for an unknown one.
    package : callable
        Gives another program's package by its name, or None if it is not installed.

    Returns
    -------
    int
        Exit code 0; what goes wrong is raised.
    """
    scenes, arguments = options(
        argv, module, name="chart", scenes="what to chart", usual=USUAL, example="report --json",
        description="Chart speed against accuracy for every method, form and backend, beside "
        f"other programs that are installed. Without a scene: {', '.join(USUAL)}, in about two "
        "minutes; leave the machine alone meanwhile.",
        record="chart compiled loops only and keep what was cheapest: scenes are run that way",
    )  # fmt: skip
    found: list[Charted] = []
    pictures: list[str] = []
    for scene in scenes:
        with Progress() as tell:
            tell(f"{scene.name}: reference")
            truth = reference(scene)
            wanted = list(combinations(scene.module))
            if arguments.record:
                wanted = [one for one in wanted if one[2] == "compiled"]
            measured = curves(scene, truth, _telling(scene.name, wanted, tell))
            if not arguments.record:
                tell(f"{scene.name}: other programs")
                measured += peers.curves(scene, truth, package)
            charted = Charted.of(scene, truth, measured)
        figures = {
            f"work_precision_{scene.name}": plots.work_precision(
                f"Cost of accuracy: {scene.title}", charted.curves
            ),
            f"steps_{scene.name}": plots.steps(f"Shorter steps: {scene.title}", charted.curves),
            f"energy_{scene.name}": plots.energy(
                f"Energy and trajectory: {scene.title}", charted.curves, wrong_from(scene, truth)
            ),
        }
        paths = {name: arguments.output / f"{name}.png" for name in figures}
        for name, figure in figures.items():
            save(figure, paths[name])
        found.append(charted)
        pictures += map(str, paths.values())
        if not arguments.json:
            where = f"pictures: {', '.join(map(str, paths.values()))}"
            print(*told(charted), where, "", sep="\n", flush=True)
    if arguments.record:
        write_text(RECORD, recorded(found))
    if arguments.json:
        print(json.dumps(jsonable(_figures(found, pictures)), indent=2))
    return 0


def _telling(scene: str, wanted: Sequence[Combination], tell: Progress) -> Iterator[Combination]:
    """Combinations, each told as it comes."""
    for n, combination in enumerate(wanted, 1):
        tell(f"{scene}: {', '.join(combination)} ({n} of {len(wanted)})")
        yield combination


def _figures(found: Sequence[Charted], pictures: Sequence[str]) -> dict[str, Any]:
    """All that was found, for programs."""
    return {
        "curves": [curve for charted in found for curve in charted.curves],
        "frontier": [
            best for charted in found for best in (*charted.frontier, *charted.frontier_rhs)
        ],
        "turnings": {charted.scene.name: charted.turnings for charted in found},
        "misled": {charted.scene.name: charted.misled for charted in found},
        "pictures": pictures,
        "reference": {
            "method": Reference.METHOD,
            "global_error": max(charted.reference.global_error for charted in found),
            "scenes": {charted.scene.name: charted.reference for charted in found},
        },
    }
