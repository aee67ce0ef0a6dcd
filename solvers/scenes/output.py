"""Files of a scene: tables, plots and a page that plays the motion."""

from collections.abc import Sequence
from pathlib import Path

from solvers.io.atomic_write import write_text
from solvers.io.figures import save
from solvers.player.page import Page
from solvers.scenes.geometry import tracks
from solvers.scenes.plots import figure, full_note
from solvers.scenes.run import SceneResult
from solvers.scenes.summary import table


def write_files(results: Sequence[SceneResult], folder: Path) -> dict[str, Path]:
    """Write tables, a plot and a page of a scene and the scenes beside it; return their paths."""
    scene = results[0].scene
    endings = {"table": "csv", "picture": "png", "page": "html"}
    paths = {name: folder / f"{scene.name}.{ending}" for name, ending in endings.items()}
    save(figure(results), paths["picture"])
    write_text(paths["table"], table(results[0]))
    for n, result in enumerate(results[1:], 2):
        paths[f"table {n}"] = write_text(folder / f"{scene.name}_{n}.csv", table(result))
    module = results[0].specialised_module
    if module and module.__file__:  # it has no file where none can be written
        paths["code"] = Path(module.__file__)
    Page(scene.title, full_note(results), tracks(results)).write(paths["page"])
    return paths
