"""``holonomic derive SYSTEM --document FILE``: the derivation as a document."""

from argparse import Namespace

from derive.handout.derivation_document import WRITERS, write_document
from derive.mechanics.derivation import Derivation
from derive.system.files.system_catalogue import load
from derive.system.parts import SystemDefinitionError


def is_requested(arguments: Namespace) -> bool:
    """Whether an option of documents is given."""
    options = (arguments.document, arguments.exercises, arguments.seed)
    return any(option is not None for option in options)


def run(arguments: Namespace) -> int:
    """Write the document, and the key of its exercises; print their paths."""
    _check(arguments)
    derivation = Derivation(load(arguments.systems[0]))
    path, exercises, seed = arguments.document, arguments.exercises, arguments.seed or 0
    for written in write_document(derivation, path, exercises, seed):
        print(f"wrote {written}")
    return 0


def _check(arguments: Namespace) -> None:
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
