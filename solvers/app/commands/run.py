"""``holonomic run``."""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from solvers.app.commands import options

if TYPE_CHECKING:
    from solvers.scenes.scene import Scene

SUMMARY = "run scenes with the smallest sufficient model"
DEFAULT = ("report",)


def add_arguments(parser: ArgumentParser) -> None:
    """Describe the command and its arguments."""
    parser.description = (
        "Run scenes with the smallest model whose error stays below the requested accuracy; write "
        "each motion as a table and a page that plays it."
    )
    options.add_scenes(parser, DEFAULT)
    options.add_output(parser, "tables, pages and plots")
    meaning = "also plot motions of scenes that specify no pictures"
    parser.add_argument("--plot", action="store_true", help=meaning)
    meaning = "also write the motion as FILE.gif, .mp4, .svg, .pdf or .png, for slides"
    parser.add_argument("--export", type=Path, metavar="FILE", help=meaning)
    meaning = "seconds of the motion in a second of FILE.gif or .mp4 (default: 1)"
    parser.add_argument("--speed", type=float, metavar="X", default=1.0, help=meaning)
    meaning = "also write a page that integrates the scene while it is open: drag masses, change "
    meaning += "parameters, methods and step sizes"
    parser.add_argument("--live", action="store_true", help=meaning)
    options.add_json(parser)
    options.add_examples(parser, "holonomic run separatrix --json")


def run(arguments: Namespace) -> int:
    """Run the scenes, write their files and print summaries."""
    from derive.formulas.typeset.typesetting import Formula
    from solvers.app.modules import specialiser
    from solvers.equations.module import equations_of_motion
    from solvers.io.terminal import Progress
    from solvers.scenes.scene_output import figures, summary, together, write_files
    from solvers.scenes.scene_run import run_scene

    names = partial(_files, plot=arguments.plot, live=arguments.live)
    scenes, results = options.selected_scenes(arguments, DEFAULT, names), []
    if export := arguments.export:
        from solvers.player.film import check_export, write_motions

        if scenes[1:]:
            raise ValueError(
                f"--export {export} is one file, but {len(scenes)} scenes run: run one"
            )
        longest = max(one.duration for one in (scenes[0], *scenes[0].beside))
        check_export(export, longest, arguments.speed)
    for scene in scenes:
        with Progress() as report:
            first, *beside = (run_scene(one, specialiser, report) for one in (scene, *scene.beside))
            report("files")
            equations = "\n".join(Formula(text).html for text in equations_of_motion(scene.module))
            paths = write_files([first, *beside], arguments.output, equations, plot=arguments.plot)
            if export:
                report("export")
                paths["export"] = write_motions(together([first, *beside]), export, arguments.speed)
        if arguments.live:
            from solvers.app.live_page import LivePage

            paths["live page"] = arguments.output / f"{scene.name}_live.html"
            LivePage(first).write(paths["live page"])
        files = {kind: str(path) for kind, path in paths.items()}
        results.append(figures(first) | {"beside": [*map(figures, beside)], "files": files})
        if not arguments.json:
            for result in (first, *beside):
                print(*summary(result), "", sep="\n")
            print(f"files: {', '.join(files.values())}\n", flush=True)
    if arguments.json:
        options.print_json(results if results[1:] else results[0])
    return 0


def _files(scene: "Scene", *, plot: bool, live: bool) -> Iterable[str]:
    from solvers.scenes.scene_output import file_names

    names = file_names(scene, 1 + len(scene.beside), plot=plot).values()
    return [*names, *([f"{scene.name}_live.html"] if live else [])]
