"""Files that show documents with verdicts on their formulas: a page, or a copy with notes."""

from collections.abc import Sequence
from pathlib import Path

from derive.reading.document import Document
from derive.reading.document_formats import kinds
from derive.verification.documents.pages.latex_notes import latex_notes
from derive.verification.documents.pages.markdown_notes import markdown_notes, notebook_notes
from derive.verification.documents.pages.verdict_page import page
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts
from solvers.io.atomic_write import write_text
from solvers.io.toml_input import InputError

#: Kinds of documents, and functions that write copies with notes.
COPIES = {"latex": latex_notes, "markdown": markdown_notes, "notebook": notebook_notes}


def check_annotation(path: Path, files: Sequence[str]) -> None:
    """Refuse a file that cannot show these documents, before any of them is judged.

    Raises
    ------
    InputError
        If there is no document, if the name ends otherwise than in .html, .tex or as the document
        does, if it is that of a document, or if there are several documents in another file than a
        page.
    """
    if not files:
        raise InputError(f"--annotate {path}: give a document, such as my_paper.tex")
    kind, own = (kinds().get(one.suffix.lower()) for one in (path, Path(files[0])))
    if kind not in ("html", "latex") and (kind not in COPIES or kind != own):
        raise InputError(
            f"--annotate {path}: its name must end in .html or .tex, or be that of a copy of a "
            "document in Markdown or of a notebook"
        )
    if kind != "html" and len(files) > 1:
        raise InputError(f"--annotate {path}: it shows one document; for several, write .html")
    if any(path.resolve() == Path(file).resolve() for file in files):
        raise InputError(f"--annotate {path}: this is the document itself; choose another name")


def annotate(path: Path, documents: Sequence[tuple[DocumentVerdicts, Document]]) -> None:
    """Write a page with the verdicts on documents, or a copy of one document with notes."""
    kind = kinds()[path.suffix.lower()]
    write_text(path, page(documents) if kind == "html" else COPIES[kind](*documents[0]))
