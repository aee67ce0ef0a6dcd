"""The files of a document, in the format that the suffix of the name states."""

from collections.abc import Callable
from pathlib import Path

from derive.handout.document_model import HandoutDocument
from derive.handout.exercises import Exercise, with_exercises
from derive.handout.formats.notebook import notebook
from derive.handout.formats.page import page
from derive.handout.formats.tex import tex
from derive.handout.sections import document
from derive.mechanics.derivation import Derivation
from solvers.io.atomic_write import write_texts

WRITERS: dict[str, Callable[[HandoutDocument], str]] = {
    ".html": page,
    ".tex": tex,
    ".ipynb": notebook,
}


def write_document(
    derivation: Derivation, path: Path, exercises: Exercise | None = None, seed: int = 0
) -> list[Path]:
    """Write the document of a derivation; with exercises, also the key beside it.

    Parameters
    ----------
    derivation : Derivation
        The derivation of any system.
    path : Path
        The file, of a suffix in `WRITERS`; its folder exists.
    exercises : {"blank", "mistakes"}, optional
        Leave formulas blank, or plant one mistake in each; the key is a second file, ``_key``.
    seed : int, default 0
        The mistakes follow from it.

    Returns
    -------
    list of Path
        The files; all are complete before the first is moved into place.

    Raises
    ------
    OSError
        When a file cannot be written.
    UnsupportedFunctionError
        When an expression has no counterpart in generated code.
    """
    write, whole = WRITERS[path.suffix], document(derivation)
    documents = {path.name: whole}
    if exercises:
        pair = with_exercises(whole, exercises, seed)
        documents = dict(zip((path.name, f"{path.stem}_key{path.suffix}"), pair, strict=True))
    write_texts(path.parent, {name: write(one) for name, one in documents.items()})
    return [path.with_name(name) for name in documents]
