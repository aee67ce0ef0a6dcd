"""``holonomic systems``."""

from argparse import ArgumentParser, Namespace

from derive.system.files.shipped import large_names, names
from solvers.app.commands.options import add_examples, complete_with

SUMMARY = "list systems, with drawings"


def add_arguments(parser: ArgumentParser) -> None:
    """Describe the command and its arguments."""
    parser.description = "List systems with their drawings, coordinates and parameters."
    meaning = "a name, such as chain_5 (default: all systems)"
    action = parser.add_argument("systems", nargs="*", metavar="SYSTEM", help=meaning)
    complete_with(action, "systems", (*names(), *large_names()))
    add_examples(parser, "holonomic systems chain_5")


def run(arguments: Namespace) -> int:
    """Print the descriptions."""
    from derive.system.files.system_catalogue import description

    print("\n\n".join(map(description, arguments.systems or (*names(), *large_names()))))
    return 0
