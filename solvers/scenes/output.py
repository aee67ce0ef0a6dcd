"""Files of a scene: tables, plots and a page that plays the motion."""

from collections.abc import Sequence
from pathlib import Path

from solvers.io.atomic_write import write_text
from solvers.player.geometry import tracks
from solvers.player.player_page import Page
from solvers.scenes.scene import Scene
from solvers.scenes.scene_run import SceneResult
from solvers.scenes.scene_summary import table, together


def file_names(scene: Scene, runs: int, *, plot: bool) -> dict[str, str]:
    """Names of the files of a scene with a number of runs, by their contents.

    There is a plot on request, and where the scene specifies its ``pictures``.
    """
    endings = {"table": ".csv", "page": ".html"}
    if plot or scene.pictures:
        endings["picture"] = ".png"
    endings |= {f"table {n}": f"_{n}.csv" for n in range(2, runs + 1)}
    return {contents: f"{scene.name}{ending}" for contents, ending in endings.items()}


def write_files(
    results: Sequence[SceneResult], folder: Path, equations: str = "", *, plot: bool = False
) -> dict[str, Path]:
    """Write tables, a page and plots of a scene and the scenes beside it; return their paths.

    Parameters
    ----------
    results : sequence of SceneResult
        The scene's own, then those of the scenes beside it.
    folder : pathlib.Path
        The folder of the files.
    equations : str, optional
        The equations of motion, HTML, which the page shows.
    plot : bool, optional
        Whether a scene without ``pictures`` is plotted, too; these load Matplotlib.
    """
    scene = results[0].scene
    names = file_names(scene, len(results), plot=plot)
    paths = {contents: folder / name for contents, name in names.items()}
    motions = together(results)
    if "picture" in paths:
        from solvers.io.figures import save
        from solvers.player.motion_plots import figure

        save(figure(motions), paths["picture"])
    write_text(paths["table"], table(results[0]))
    for n, result in enumerate(results[1:], 2):
        write_text(paths[f"table {n}"], table(result))
    if module := results[0].specialised_module:
        paths["code"] = Path(module.__file__ or "")
    page = Page(scene.title, motions[0].note, tracks(motions), equations)
    page.write(paths["page"])
    return paths
