"""What commands on scenes have in common: their options."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from solvers.scenes import SCENES, Scene, UnknownSceneError, scene


def options(
    argv: Sequence[str], *, name: str, description: str, scenes: str, usual: Sequence[str],
    example: str,
) -> tuple[list[Scene], argparse.Namespace]:  # fmt: skip
    """The scenes that are named, or else the usual ones; and the options, with their folder made.

    Parameters
    ----------
    argv : sequence of str
        What was typed.
    name, description, example : str
        Of the command.
    scenes : str
        What it does with scenes.
    usual : sequence of str
        Their names if none is given.
    """
    parser = argparse.ArgumentParser(
        prog=f"holonomic {name}",
        description=description,
        epilog=f"scenes: {', '.join(SCENES)}\n\nexample:\n  holonomic {name} {example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=scenes)
    parser.add_argument("--output", type=Path, default=Path("out"), metavar="DIR",
                        help="folder for the pictures (default: out)")  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print figures for programs")
    arguments = parser.parse_args(argv)
    try:
        chosen = [scene(one) for one in dict.fromkeys(arguments.scenes or usual)]
    except UnknownSceneError as error:
        parser.error(str(error))
    arguments.output.mkdir(parents=True, exist_ok=True)
    return chosen, arguments
