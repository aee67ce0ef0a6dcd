"""Files of a scene: tables, a plot and a page that plays the motion."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from solvers.io.atomic_write import write_text
from solvers.io.figures import save
from solvers.player.page import Page
from solvers.scenes.played import track
from solvers.scenes.plots import drawn, sureness
from solvers.scenes.run import Answer
from solvers.scenes.summary import special_code, table


def write_files(answers: Sequence[Answer], folder: Path) -> dict[str, Path]:
    """Write tables, a plot and a page of a scene and the scenes beside it; return their paths."""
    scene = answers[0].scene
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
