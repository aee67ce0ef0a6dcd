"""What commands on scenes have in common: their options."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path

from solvers.equations.module import GeneratedModule
from solvers.io.toml_input import InputError
from solvers.scenes.scene import Scene
from solvers.scenes.shipped import find, names


def options(
    argv: Sequence[str], module: Callable[[str], GeneratedModule], *, name: str, description: str,
    scenes: str, usual: Sequence[str], example: str, record: str = "",
) -> tuple[list[Scene], argparse.Namespace]:  # fmt: skip
    """The scenes that are named, or else the usual ones; and the options, with their folder made.

    Parameters
    ----------
    argv : sequence of str
        What was typed.
    module : callable
        Gives a generated module by its name; raises `LookupError` for an unknown one.
    name, description, example : str
        Of the command.
    scenes : str
        What it does with scenes.
    usual : sequence of str
        Their names if none is given.
    record : str
        What ``--record`` does, if the command has it.

    Returns
    -------
    scenes : list of Scene
        In the order in which they are named, each once.
    arguments : argparse.Namespace
        ``scenes``, ``output`` and ``json``; and ``record``, if the command has it.

    Raises
    ------
    SystemExit
        When an option or a scene makes no sense, with what is allowed on standard error.
    OSError
        When a scene cannot be read, or the folder cannot be made.
    """
    parser = argparse.ArgumentParser(
        prog=f"holonomic {name}",
        description=description,
        epilog=f"scenes: {', '.join(names())}\n\nexample:\n  holonomic {name} {example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=scenes)
    parser.add_argument("--output", type=Path, default=Path("out"), metavar="DIR",
                        help="folder for the pictures (default: out)")  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print figures for programs")
    if record:
        parser.add_argument("--record", action="store_true", help=record)
    arguments = parser.parse_args(argv)
    try:
        chosen = [find(one, module) for one in dict.fromkeys(arguments.scenes or usual)]
    except InputError as error:
        parser.error(str(error))
    arguments.output.mkdir(parents=True, exist_ok=True)
    return chosen, arguments
