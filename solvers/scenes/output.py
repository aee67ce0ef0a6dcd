"""Files of a scene: tables, a plot and a page that plays the motion."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from solvers.io.atomic_write import write_text
from solvers.io.figures import save
from solvers.player.page import Page
from solvers.scenes.geometry import track
from solvers.scenes.plots import accuracy_note, figure
from solvers.scenes.run import SceneResult
from solvers.scenes.summary import special_code, table


def write_files(results: Sequence[SceneResult], folder: Path) -> dict[str, Path]:
    """Write tables, a plot and a page of a scene and the scenes beside it; return their paths."""
    scene = results[0].scene
    paths = {
        "table": folder / f"{scene.name}.csv",
        "picture": folder / f"{scene.name}.png",
        "page": folder / f"{scene.name}.html",
    }
    save(figure(results), paths["picture"])
    write_text(paths["table"], table(results[0]))
    for n, one in enumerate(results[1:], 2):
        paths[f"table {n}"] = write_text(folder / f"{scene.name}_{n}.csv", table(one))
    if code := special_code(results[0]):
        paths["code"] = code
    words = [*scene.note.split(), *(accuracy_note(one, named=len(results) > 1) for one in results)]
    Page(scene.title, " ".join(words), list(map(track, results))).write(paths["page"])
    return paths
