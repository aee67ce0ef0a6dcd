"""``holonomic derive``."""

from argparse import ArgumentParser, Namespace

from derive.commands import derive_options as derive_arguments
from derive.system.files.shipped import large_names, names
from solvers.app.commands.options import complete_with

SUMMARY = "write generated modules, or check them"


def add_arguments(parser: ArgumentParser) -> None:
    """Describe the command and its arguments."""
    action = derive_arguments.add_arguments(parser)
    complete_with(action, "systems", (*names(), *large_names()))


def run(arguments: Namespace) -> int:
    """Write or check the files; with the whole package, also the tables of READMEs beside it."""
    from derive.commands.regenerate import run

    if arguments.systems or arguments.output or arguments.document:
        return run(arguments)
    from solvers.app.readme_tables import readmes

    return run(arguments, readmes())
