"""The command ``holonomic``: parser, exit codes and warnings."""

import os
import re
import sys
import warnings
from argparse import ArgumentParser, Namespace, _SubParsersAction
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from errno import EACCES
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from solvers.app.commands.options import Formatter, required_package
from solvers.io.build_cache import NoPlaceError, temporary_folder
from solvers.io.suggestion import did_you_mean
from solvers.io.terminal import standard_streams

if TYPE_CHECKING:
    from _typeshed import SupportsWrite

#: The variable that names the folder.
VARIABLE = "MPLCONFIGDIR"


def provide_matplotlib_folder() -> None:
    """Set `VARIABLE` to a temporary folder where Matplotlib would print warnings, or fail.

    Raises
    ------
    NoPlaceError
        When there is no folder that can be written to.
    """
    reasons = [] if os.environ.get(VARIABLE) else [*map(_obstacle, _own_folders())]
    if any(reasons):
        hint = f"set {VARIABLE} to a folder that can be written to"
        try:
            os.environ[VARIABLE] = str(temporary_folder())
        except NoPlaceError as error:
            causes = "; ".join([*filter(None, dict.fromkeys(reasons)), str(error)])
            raise NoPlaceError(f"Matplotlib needs a folder ({causes}): {hint}") from error


def _own_folders() -> list[Path]:
    """The folders that Matplotlib uses by default."""
    home = Path(os.path.expanduser("~"))
    if sys.platform == "darwin":
        return [home / ".matplotlib"]
    roots = {"XDG_CONFIG_HOME": ".config", "XDG_CACHE_HOME": ".cache"}
    return [
        Path(os.environ.get(name) or home / folder) / "matplotlib" for name, folder in roots.items()
    ]


def _obstacle(folder: Path) -> str:
    """The reason why a folder cannot be written to; empty if it can."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK):
            raise PermissionError(EACCES, os.strerror(EACCES))
    except OSError as error:
        return f"{folder}: {error.strerror}"
    return ""


#: Modules of `solvers.app.commands`, in the order of the help text.
COMMANDS = "systems derive verify export demo run fit sweep chart stability".split()

#: Invalid input, numerical failure, and files or environment.
EXIT_CODES = {ValueError: 2, ArithmeticError: 3, MemoryError: 3, OSError: 4}


class Parser(ArgumentParser):
    """A parser that suggests the closest choice for an unknown one."""

    #: Returns a list below the help text, built only where help is printed.
    listing: Callable[[], str] | None = None

    def format_help(self) -> str:
        """The help text, and the list below it."""
        text = super().format_help()
        return f"{text}\n{self.listing()}\n" if self.listing else text

    def print_help(self, file: "SupportsWrite[str] | None" = None) -> None:
        """Print the help text; `OSError` where that fails, which the base class ignores."""
        print(self.format_help(), end="", file=file)

    def error(self, message: str) -> NoReturn:
        """Print the message and a suggestion; exit with code 2."""
        if choice := re.search(r"invalid choice: '(.*)' \(choose from (.*)\)$", message):
            message += did_you_mean(choice[1], re.findall(r"[\w-]+", choice[2]))
        if option := re.match(r"unrecognized arguments: (--[\w-]+)", message):
            message += did_you_mean(option[1], self._options())
        super().error(message)

    def _options(self) -> list[str]:
        """The options of this parser and of its commands."""
        commands = (one.choices for one in self._actions if isinstance(one, _SubParsersAction))
        parsers = [self, *(parser for one in commands for parser in one.values())]
        return [name for one in parsers for name in one._option_string_actions]


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command with these arguments, or those of the process; return its exit code.

    0 done, 1 a check failed, 130 interrupted; `EXIT_CODES` for errors.
    """
    name = "holonomic"
    try:
        with standard_streams():
            given = sys.argv[1:] if argv is None else [*argv]
            if given[:1] == ["help"]:  # as git and pip have it
                given = [*given[1:], "--help"]
            arguments = command_parser().parse_args(given)
            name = f"holonomic {arguments.command or ''}".rstrip()
            with _warnings_as_lines(name):
                if "draws" in arguments:
                    provide_matplotlib_folder()
                return int(arguments.run(arguments))
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:  # the reader needs no more
        return 0
    except tuple(EXIT_CODES) as error:
        print(f"{name}: {error}", file=sys.stderr)
        return next(code for kind, code in EXIT_CODES.items() if isinstance(error, kind))


def command_parser() -> ArgumentParser:
    """The parser of all commands."""
    parser = Parser(
        "holonomic",
        description="Derive, verify, generate and integrate equations of motion.",
        epilog="holonomic COMMAND --help shows the options of a command and an example; "
        "notebooks/docs/howto.md has tasks of a few lines each.",
    )
    parser.add_argument("--version", action="store_true", help="print the version and exit")
    parser.add_argument(
        "--print-completion", choices=("bash", "zsh"), help="print a shell completion script"
    )
    parser.set_defaults(run=lambda arguments: _without_command(parser, arguments))
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", dest="command")
    for name in COMMANDS:
        command = import_module(f"solvers.app.commands.{name}")
        subparser = commands.add_parser(name, help=command.SUMMARY, formatter_class=Formatter)
        command.add_arguments(subparser)
        subparser.set_defaults(run=command.run)
    return parser


def _without_command(parser: ArgumentParser, arguments: Namespace) -> int:
    if arguments.version:
        from importlib.metadata import version

        print(f"holonomic {version('holonomic')}")
    elif arguments.print_completion:
        shtab = required_package("shtab", "completion")
        print(shtab.complete(parser, arguments.print_completion))
    else:
        parser.print_help()
    return 0


@contextmanager
def _warnings_as_lines(name: str) -> Iterator[None]:
    """Print warnings as lines on standard error, each once: a command integrates many times."""
    printed: set[str] = set()

    def show(message: Warning | str, *_: object, **__: object) -> None:
        line = f"{name}: {message}"
        if line not in printed:
            printed.add(line)
            print(line, file=sys.stderr)

    with warnings.catch_warnings():
        warnings.filterwarnings("default", message="integrating in Python")
        warnings.showwarning = show
        yield
