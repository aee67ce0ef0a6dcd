"""``holonomic derive``: write the generated modules, check them, or write a document."""

import sys
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Iterable, Sequence
from pathlib import Path
from shlex import quote

from derive.codegen.expression_graph.sympy_translation import UnsupportedFunctionError
from derive.codegen.module_files import FileDifference, GeneratedFiles, texts
from derive.codegen.module_summary import mobility
from derive.commands.derive_options import add_arguments
from derive.handout.derivation_document import WRITERS, write_document
from derive.mechanics.constraints.differentiated_constraints import Constraints
from derive.mechanics.derivation import Derivation
from derive.mechanics.reduced_coordinates import reduced
from derive.system.files.shipped import names
from derive.system.files.system_catalogue import UnknownSystemError, load
from derive.system.parts import SystemDefinitionError
from solvers.io.terminal import standard_streams


def is_document_requested(arguments: Namespace) -> bool:
    """Whether an option of documents is given."""
    options = (arguments.document, arguments.exercises, arguments.seed)
    return any(option is not None for option in options)


def write_requested_document(arguments: Namespace) -> int:
    """Write the document, and the key of its exercises; print their paths."""
    _check_document_options(arguments)
    derivation = Derivation(load(arguments.systems[0]))
    path, exercises, seed = arguments.document, arguments.exercises, arguments.seed or 0
    for written in write_document(derivation, path, exercises, seed):
        print(f"wrote {written}")
    return 0


def _check_document_options(arguments: Namespace) -> None:
    """Raise `SystemDefinitionError` if the options do not fit each other."""
    path = arguments.document
    if path is None:
        raise SystemDefinitionError(
            "--exercises and --seed concern a document: name its file with --document FILE"
        )
    if arguments.seed is not None and arguments.exercises != "mistakes":
        raise SystemDefinitionError("--seed chooses mistakes: add --exercises mistakes")
    if arguments.check or arguments.output is not None:
        raise SystemDefinitionError("--document writes one file: omit --check and --output")
    if len(arguments.systems) != 1:
        given = ", ".join(arguments.systems) or "none"
        raise SystemDefinitionError(f"--document takes one system, got {given}: name one")
    if path.suffix not in WRITERS:
        known = ", ".join(WRITERS)
        raise SystemDefinitionError(
            f"{path}: the suffix {path.suffix!r} names no format of documents; known are {known}"
        )


PACKAGE = '''"""Equations of motion as code, one module a system; see ``holonomic derive``."""


__all__ = [
{names}
]
'''


def main(argv: Sequence[str]) -> int:
    """Run ``python -m derive`` with command-line arguments."""
    parser = ArgumentParser("holonomic derive", formatter_class=RawDescriptionHelpFormatter)
    add_arguments(parser)
    try:
        with standard_streams():
            return run(parser.parse_args(argv))
    except BrokenPipeError:  # the reader needs no more
        return 0
    except OSError as error:
        print(f"holonomic derive: {error}", file=sys.stderr)
        return 4


def run(arguments: Namespace, others: Iterable[GeneratedFiles] = ()) -> int:
    """Run the command, also on `others`; return 0, 1 (differences), 2 (input) or 4 (files)."""
    try:
        if is_document_requested(arguments):
            return write_requested_document(arguments)
        trees = [planned(arguments.systems, arguments.output), *others]
        if not arguments.check:
            _state(arguments.systems)
        return max([_check(tree, arguments) if arguments.check else _write(tree) for tree in trees])
    except (UnknownSystemError, SystemDefinitionError, UnsupportedFunctionError) as error:
        print(f"holonomic derive: {error}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        raise
    except OSError as error:
        print(
            f"holonomic derive: cannot write {error.filename or 'the messages'}: {error.strerror}; "
            f"name a {'file' if arguments.document else 'folder'} that can be written to with "
            f"{'--document' if arguments.document else '--output'}",
            file=sys.stderr,
        )
        return 4


def _state(systems: list[str]) -> None:
    """Print degrees of freedom, and the decisions on constraints of velocities."""
    for name in systems:
        if (system := reduced(load(name))).all_conditions:
            print(f"{name}: {mobility(Derivation(system))}")
        if decision := str(Constraints(load(name)).integrability):
            print(f"{name}: constraints of velocities: {decision}")


def _write(tree: GeneratedFiles) -> int:
    written = tree.write()
    kept = len(tree.texts) - len(written)
    for path in written:
        print(f"wrote {path}")
    if kept:
        print(f"{_files(kept)} in {tree.folder} already up to date")
    for path in tree.orphans():
        print(f"nothing generates {path}; remove it with: {_removal(path)}")
    return 0


def planned(systems: list[str], output: Path | None) -> GeneratedFiles:
    """The files that the command writes to a folder."""
    files: dict[str, str] = {}
    for name in systems or names():
        system = load(name)
        if output is None and name not in names():
            raise SystemDefinitionError(
                f"{name} is not part of the package generated: give a folder for its module, "
                "with --output DIR"
            )
        files |= texts(Derivation(reduced(system)))
    if output is not None:
        return GeneratedFiles(output, files, complete=False)
    modules = "\n".join(f'    "{name}",' for name in names())
    files |= {"__init__.py": PACKAGE.format(names=modules), "py.typed": ""}
    return GeneratedFiles(_package_folder(), files, complete=not systems)


def _package_folder() -> Path:
    # beside `derive`, whether or not it can be imported
    return Path(__file__).parents[2] / "generated"


def _check(tree: GeneratedFiles, arguments: Namespace) -> int:
    differences = tree.differences()
    for difference in differences:
        print(f"{difference.path}: {difference.reason}")
        print(difference.diff, end="")
        print(f"  to update it: {_remedy(difference, arguments)}")
    if not differences:
        print(f"{_files(len(tree.texts))} in {tree.folder} up to date")
    return 1 if differences else 0


def _files(count: int) -> str:
    return "1 file" if count == 1 else f"{count} files"


def _removal(path: Path) -> str:
    return f"rm {'-r ' if path.is_dir() else ''}{quote(str(path))}"


def _remedy(difference: FileDifference, arguments: Namespace) -> str:
    if difference.reason == "orphan":
        return _removal(difference.path)
    stem = difference.path.stem
    systems = [name for name in arguments.systems or names() if Path(name).stem == stem]
    output = ["--output", quote(str(arguments.output))] if arguments.output else []
    return " ".join(["holonomic", "derive", *systems, *output])
