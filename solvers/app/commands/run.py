"""``holonomic run``."""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterable
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
        "each motion as a table, a plot and a page that plays it."
    )
    options.add_scenes(parser, DEFAULT)
    options.add_output(parser, "tables, plots and pages")
    options.add_json(parser)
    options.add_examples(parser, "holonomic run separatrix --json")


def run(arguments: Namespace) -> int:
    """Run the scenes, write their files and print summaries."""
    from solvers.app.modules import specialiser
    from solvers.io.progress import Progress
    from solvers.scenes.output import write_files
    from solvers.scenes.run import run_scene
    from solvers.scenes.summary import figures, summary

    results = []
    for scene in options.selected_scenes(arguments, DEFAULT, _files):
        with Progress() as report:
            first, *beside = (run_scene(one, specialiser, report) for one in (scene, *scene.beside))
            report("plots")
            paths = write_files([first, *beside], arguments.output)
        files = {kind: str(path) for kind, path in paths.items()}
        results.append(figures(first) | {"beside": [*map(figures, beside)], "files": files})
        if not arguments.json:
            for result in (first, *beside):
                print(*summary(result), "", sep="\n")
            print(f"files: {', '.join(files.values())}\n", flush=True)
    if arguments.json:
        options.print_json(results if results[1:] else results[0])
    return 0


def _files(scene: "Scene") -> Iterable[str]:
    from solvers.scenes.output import file_names

    return file_names(scene.name, 1 + len(scene.beside)).values()
