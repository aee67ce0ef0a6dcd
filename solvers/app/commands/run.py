"""``holonomic run``: scenes answered by the smallest model that is good enough."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from solvers.app.commands.options import options
from solvers.equations.module import GeneratedModule
from solvers.io.atomic_write import write_text
from solvers.io.figures import save
from solvers.io.json_values import jsonable
from solvers.io.progress import Progress
from solvers.player.page import Page
from solvers.scenes.played import track
from solvers.scenes.plots import drawn, sureness
from solvers.scenes.run import Answer, Specialiser, answer
from solvers.scenes.scene import Scene
from solvers.scenes.summary import figures, special_code, table, told


def main(
    argv: Sequence[str], module: Callable[[str], GeneratedModule], specialiser: Specialiser
) -> int:
    """Answer scenes, draw them and print.

    Parameters
    ----------
    argv : sequence of str
        Options.
    module : callable
        Gives a generated module by its name; raises `LookupError` for an unknown one.
    specialiser : callable
        Makes code for one scene.

    Returns
    -------
    int
        Exit code 0; what goes wrong is raised.

    Raises
    ------
    ValueError
        When two scenes have the same name, or there is no model of one.
    ArithmeticError
        When a scene cannot be answered as accurately as it asks.
    """
    scenes, arguments = options(
        argv, module, name="run", scenes="what to run: a name, or a file that ends in .toml",
        usual=("report",), example="separatrix --json",
        description="Run scenes with the smallest model whose error stays below what is asked; "
        "write the motion as a table, a picture and a page that plays it.",
    )  # fmt: skip
    found = []
    twice = [name for name, n in Counter(scene.name for scene in scenes).items() if n > 1]
    if twice:
        raise ValueError(f"two scenes are called {twice[0]!r} and would write the same files")
    for scene in scenes:
        with Progress() as tell:
            answers = [answer(one, specialiser, tell) for one in (scene, *scene.beside)]
            tell("pictures")
            paths = shown(scene, answers, arguments.output)
        found.append({
            **figures(answers[0]),
            "beside": [figures(one) for one in answers[1:]],
            "files": {kind: str(path) for kind, path in paths.items()},
        })  # fmt: skip
        if not arguments.json:
            for one in answers:
                print(*told(one), "", sep="\n")
            print(f"files: {', '.join(map(str, paths.values()))}\n", flush=True)
    if arguments.json:
        one_or_all: Any = found[0] if len(found) == 1 else found
        print(json.dumps(jsonable(one_or_all), indent=2))
    return 0


def shown(scene: Scene, answers: Sequence[Answer], folder: Path) -> dict[str, Path]:
    """Write table, picture and page of a scene; return where they are."""
    paths = {
        "table": folder / f"{scene.name}.csv",
        "picture": folder / f"{scene.name}.png",
        "page": folder / f"{scene.name}.html",
    }
    save(drawn(answers), paths["picture"])
    write_text(paths["table"], table(answers[0]))
    for n, one in enumerate(answers[1:], 2):
        paths[f"table {n}"] = write_text(folder / f"{scene.name}_{n}.csv", table(one))
    if code := special_code(answers[0]):
        paths["code"] = code
    words = [*scene.note.split(), *(sureness(one, named=len(answers) > 1) for one in answers)]
    Page(scene.title, " ".join(words), list(map(track, answers))).write(paths["page"])
    return paths
