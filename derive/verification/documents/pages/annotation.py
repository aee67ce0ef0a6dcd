"""Files that show the formulas of documents with their verdicts: a page, or LaTeX."""

from collections.abc import Sequence
from pathlib import Path

from derive.reading.document import Document
from derive.verification.documents.pages.latex_notes import latex_notes
from derive.verification.documents.pages.verdict_page import page
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts
from solvers.io.atomic_write import write_text
from solvers.io.toml_input import InputError


def check_annotation(path: Path, files: Sequence[str]) -> None:
    """Refuse a file that cannot show these documents, before any of them is judged.

    Raises
    ------
    InputError
        If there is no document, if the name ends otherwise than in .html or .tex, if it is that of
        a document, or if it ends in .tex and there are several documents.
    """
    if not files:
        raise InputError(f"--annotate {path}: give a document, such as my_paper.tex")
    if path.suffix not in (".html", ".tex"):
        raise InputError(f"--annotate {path}: its name must end in .html or .tex")
    if path.suffix == ".tex" and len(files) > 1:
        raise InputError(f"--annotate {path}: LaTeX shows one document; for several, write .html")
    if any(path.resolve() == Path(file).resolve() for file in files):
        raise InputError(f"--annotate {path}: this is the document itself; choose another name")


def annotate(path: Path, documents: Sequence[tuple[DocumentVerdicts, Document]]) -> None:
    """Write a page with the verdicts on documents, or LaTeX with those on one document."""
    write_text(path, page(documents) if path.suffix == ".html" else latex_notes(*documents[0]))
