"""``holonomic chart``: work-precision diagrams of scenes."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from solvers.chart import drawn, peers
from solvers.chart.findings import misled, turnings, wrong_from
from solvers.chart.frontier import frontier
from solvers.chart.measurement import curves
from solvers.chart.reference import Reference, reference
from solvers.chart.told import told
from solvers.jsonable import jsonable
from solvers.pictures import save
from solvers.scenes import SCENES, UnknownSceneError, scene

#: Scenes that are charted if none is named.
USUAL = ("report", "long", "single")


def main(
    argv: Sequence[str],
    module: Callable[[str], ModuleType],
    package: Callable[[str], ModuleType | None],
) -> int:  # fmt: skip
    """Measure, draw and print.

    Parameters
    ----------
    argv : sequence of str
        Options.
    module : callable
        Gives a generated module by its name.
    package : callable
        Gives another program's package by its name, or None if it is not installed.
    """
    parser = argparse.ArgumentParser(
        prog="holonomic chart",
        description="Chart speed against accuracy for every method, form and backend, beside "
        f"other programs that are installed. Without a scene: {', '.join(USUAL)}, in about two "
        "minutes; leave the machine alone meanwhile.",
        epilog=f"scenes: {', '.join(SCENES)}\n\nexample:\n  holonomic chart report --json",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="what to chart")
    parser.add_argument("--output", type=Path, default=Path("out"), metavar="DIR",
                        help="folder for the pictures (default: out)")  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print figures for programs")
    arguments = parser.parse_args(argv)
    try:
        chosen = [scene(name) for name in dict.fromkeys(arguments.scenes or USUAL)]
    except UnknownSceneError as error:
        parser.error(str(error))
    arguments.output.mkdir(parents=True, exist_ok=True)
    found: dict[str, Any] = {
        "curves": [], "frontier": [], "turnings": {}, "misled": {}, "pictures": [],
    }  # fmt: skip
    truths: dict[str, Reference] = {}
    for one in chosen:
        equations = module(one.system)
        truth = truths[one.name] = reference(one, equations)
        measured = [
            *curves(one, equations, truth), *peers.curves(one, equations, truth, package)
        ]  # fmt: skip
        pictures = {
            "work_precision": drawn.work_precision(f"Cost of accuracy: {one.title}", measured),
            "steps": drawn.steps(f"Shorter steps: {one.title}", measured),
            "energy": drawn.energy(
                f"Energy and trajectory: {one.title}", measured, wrong_from(one, truth)
            ),
        }
        paths = [arguments.output / f"{name}_{one.name}.png" for name in pictures]
        for path, figure in zip(paths, pictures.values(), strict=True):
            save(figure, path)
        found["curves"] += measured
        found["frontier"] += [*frontier(measured), *frontier(measured, "work_rhs")]
        found["turnings"][one.name] = turnings(measured)
        found["misled"][one.name] = misled(measured, one, equations, truth)
        found["pictures"] += map(str, paths)
        if not arguments.json:
            lines = [
                *told(one, equations, truth, measured),
                f"pictures: {', '.join(map(str, paths))}",
            ]
            print(*lines, "", sep="\n", flush=True)
    found["reference"] = {
        "method": Reference.METHOD,
        "global_error": max(truth.global_error for truth in truths.values()),
        "scenes": truths,
    }
    if arguments.json:
        print(json.dumps(jsonable(found), indent=2))
    return 0
