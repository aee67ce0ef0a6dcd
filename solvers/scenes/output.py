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


def file_names(scene: str, runs: int) -> dict[str, str]:
    """Names of the files of a scene with a number of runs, by their contents."""
    endings = {"table": ".csv", "picture": ".png", "page": ".html"}
    endings |= {f"table {n}": f"_{n}.csv" for n in range(2, runs + 1)}
    return {contents: f"{scene}{ending}" for contents, ending in endings.items()}


def write_files(
    results: Sequence[SceneResult], folder: Path, equations: str = ""
) -> dict[str, Path]:
    """Write tables, a plot and a page of a scene and the scenes beside it; return their paths.

    The page shows the `equations` of motion, HTML.
    """
    scene = results[0].scene
    names = file_names(scene.name, len(results))
    paths = {contents: folder / name for contents, name in names.items()}
    save(figure(results), paths["picture"])
    write_text(paths["table"], table(results[0]))
    for n, result in enumerate(results[1:], 2):
        write_text(paths[f"table {n}"], table(result))
    if module := results[0].specialised_module:
        paths["code"] = Path(module.__file__ or "")
    page = Page(scene.title, full_note(results), tracks(results), equations)
    page.write(paths["page"])
    return paths
