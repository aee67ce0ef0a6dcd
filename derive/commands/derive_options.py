"""Arguments of ``holonomic derive``; describing them loads no SymPy."""

from argparse import Action, ArgumentParser
from pathlib import Path

from derive.system.files.shipped import large_names, names

EXAMPLES = """\
examples:
  holonomic derive                                  all systems, into the package `generated`
  holonomic derive double_pendulum --output build   one system, as build/double_pendulum.py, .h
  holonomic derive my_system.toml --output build    your own system
  holonomic derive --check                          exit 1 if a file is not up to date
  holonomic derive double_pendulum --document double_pendulum.tex    its derivation, to hand out
"""


def add_arguments(parser: ArgumentParser) -> Action:
    """Describe the command and its arguments; return the argument SYSTEM."""
    parser.description = "Derive systems from their positions; write Python modules and C headers."
    large = f"only with --output: {', '.join(large_names())}"
    parser.epilog = f"systems: {', '.join(names())}\n{large}\n\n{EXAMPLES}"
    systems = "a name, or a TOML file (default: all systems)"
    action = parser.add_argument("systems", nargs="*", metavar="SYSTEM", help=systems)
    check = "write nothing; list differences and exit with 1 if there are any"
    parser.add_argument("--check", action="store_true", help=check)
    output = "folder to write to (default: the package `generated`)"
    parser.add_argument("--output", type=Path, metavar="DIR", help=output)
    document = "write the derivation of one system as .html, .tex or .ipynb instead"
    parser.add_argument("--document", type=Path, metavar="FILE", help=document)
    exercises = (
        "in the document, leave formulas blank, or plant a mistake in each; the key is a second "
        "file, FILE_key"
    )
    parser.add_argument("--exercises", choices=("blank", "mistakes"), help=exercises)
    seed = "number from which the mistakes follow (default: 0)"
    parser.add_argument("--seed", type=int, metavar="N", help=seed)
    return action
