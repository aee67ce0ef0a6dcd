"""``holonomic verify FILE``: verdicts on the equations of documents, files and systems."""

import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeAlias

from derive.reading.document import Document
from derive.verification.documents.letters.hints import Hints
from derive.verification.documents.pages.annotation import annotate, check_annotation
from derive.verification.documents.pages.verdict_table import document_lines, document_record
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts
from derive.verification.hand_derivation_files import HandDerivation, judge
from derive.verification.judging.verdict import VerdictName, table_width, verdict_rows, wrapped
from derive.verification.report.report_judgement import OrderOf
from derive.verification.source_files import judge_file
from solvers.io.terminal import text_table
from solvers.io.toml_input import InputError

#: The verdicts that are counted, and the width of the column of files.
COUNTED: tuple[VerdictName, ...] = ("verified", "equivalent", "misprint", "wrong", "unreadable")
FILE_WIDTH = 26
#: Endings of system names and of files with typed equations.
NOT_DOCUMENTS = ("", ".toml")

SourceVerdicts: TypeAlias = HandDerivation | DocumentVerdicts


def verify(
    names: Sequence[str],
    order_of: OrderOf,
    *,
    as_json: bool,
    annotation: Path | None = None,
    hints: Hints | None = None,
) -> int:
    """Print the verdicts, for several files also their numbers.

    ``order_of(A, b)`` is the order of a Runge–Kutta method, for documents that contain the report.

    Return 1 if an equation is wrong, otherwise 2 if an equation or a file is unreadable, otherwise
    3 if there are documents and no formula of theirs is judged, else 0.
    """
    files = [name for name in names if Path(name).suffix not in NOT_DOCUMENTS]
    if annotation:
        check_annotation(annotation, files)
    if hints and not files:
        raise InputError("--system, --names: give a document, such as my_paper.tex")
    results: dict[str, SourceVerdicts | None] = {}
    documents: list[tuple[DocumentVerdicts, Document]] = []
    for name in names:
        try:
            if name in files:
                judgement, document = judge_file(name, order_of, hints)
                results[name] = judgement
                documents.append((judgement, document))
            else:
                results[name] = judge(name)
        except ValueError as error:  # the other files still get verdicts
            results[name] = None
            print(f"holonomic verify: {error}", file=sys.stderr)
    if annotation and documents:
        annotate(annotation, documents)
    if as_json:
        print(json.dumps(_records(results), indent=2))  # in ASCII: valid in every encoding
    else:
        texts = ["\n".join(_lines(one, table_width())) for one in results.values() if one]
        if len(results) > 1:
            texts.append("\n".join(_marks(results)))
        if texts:
            print(*texts, sep="\n\n")
    verdicts = {verdict for one in results.values() if one for verdict in _verdicts(one)}
    if "wrong" in verdicts:
        return 1
    if "unreadable" in verdicts or None in results.values():
        return 2
    return 3 if documents and not any(one.is_judged for one, _ in documents) else 0


def _records(results: Mapping[str, SourceVerdicts | None]) -> Any:
    """The verdicts for JSON: of derivations a list, with documents a table of both."""
    derivations = [asdict(one) for one in results.values() if isinstance(one, HandDerivation)]
    documents = [document_record(d) for d in results.values() if isinstance(d, DocumentVerdicts)]
    if not documents:
        return derivations
    return {"documents": documents} | ({"derivations": derivations} if derivations else {})


def _verdicts(one: SourceVerdicts) -> list[VerdictName]:
    formulas = one.equations if isinstance(one, HandDerivation) else one.formulas
    return [formula.verdict for formula in formulas]


def _lines(one: SourceVerdicts, width: int) -> Iterator[str]:
    if isinstance(one, DocumentVerdicts):
        yield from document_lines(one, width)
        return
    head = dict.fromkeys((one.file, one.system, one.source))
    yield wrapped(": ".join(filter(None, head)), width, 0)
    if one.note:
        yield wrapped(one.note, width, 0)
    yield from verdict_rows(one.equations, width)


def _marks(results: Mapping[str, SourceVerdicts | None]) -> Iterator[str]:
    """Numbers of verdicts for each file, dashes for an unreadable one, and the totals."""
    total: Counter[VerdictName] = Counter()
    rows: list[list[object]] = []
    for name, verdicts in results.items():
        marks = Counter(_verdicts(verdicts) if verdicts else ())
        file = name if len(name) <= FILE_WIDTH else f"...{name[3 - FILE_WIDTH :]}"
        rows.append([file, *(marks[verdict] if verdicts else None for verdict in COUNTED)])
        total.update(marks)
    rows.append(["total", *(total[verdict] for verdict in COUNTED)])
    return text_table({"file": "", **dict.fromkeys(COUNTED, "d")}, rows)
