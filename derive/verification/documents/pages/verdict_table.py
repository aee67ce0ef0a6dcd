"""Verdicts on documents as plain text and as JSON."""

import re
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from derive.verification.documents.pages.verdicts_in_place import (
    DocumentVerdicts,
    FormulaVerdict,
    one_line,
)
from derive.verification.judging.verdict import table_row, wrapped


def document_lines(verdicts: DocumentVerdicts, width: int) -> Iterator[str]:
    """Yield the lines of a table: each formula with its line; only correct ones are abbreviated."""
    yield wrapped(": ".join(filter(None, (verdicts.file, verdicts.system))), width, 0)
    yield from (wrapped(note, width, 0) for note in verdicts.remarks)
    labels = [_label(one) for one in verdicts.formulas]
    label_width = max(map(len, labels), default=0) + 2
    for label, one in zip(labels, verdicts.formulas, strict=True):
        whole = one.verdict in ("misprint", "wrong", "unreadable")
        cells = (label, one.verdict, _line(one.latex), *_details(one))
        yield from table_row(cells, width, label_width, whole)
    yield wrapped(verdicts.summary, width, 0)


def _label(one: FormulaVerdict) -> str:
    return f"cell {one.cell}, line {one.line}" if one.cell else f"line {one.line}"


def _details(one: FormulaVerdict) -> Iterator[str]:
    details = {
        "wrong term": _line(one.wrong_term),
        "correct formula": _line(one.correction),
        "value": one.witness,
        "state": one.state,
        "note": one.note,
    }
    return (f"{title}: {text}" for title, text in details.items() if text)


def _line(latex: str) -> str:
    """LaTeX in one line, without the signs that align its relations."""
    return one_line(re.sub(r"&\s*(?=[=<>:])|(?<==)\s*&", "", latex))


def document_record(verdicts: DocumentVerdicts) -> dict[str, Any]:
    """The verdicts as ``holonomic verify --json`` prints them."""
    return {
        "file": verdicts.file,
        "system": verdicts.system,
        "notes": verdicts.notes,
        "summary": verdicts.summary,
        "convention": verdicts.convention,
        "alternatives": [asdict(one) for one in verdicts.alternatives],
        "formulas": [_record(one) for one in verdicts.formulas],
    }


def _record(one: FormulaVerdict) -> dict[str, Any]:
    """The fields of a formula; those of notebooks have a cell."""
    cell = {"cell": one.cell} if one.cell else {}
    return cell | {
        "line": one.line,
        "display": one.display,
        "latex": one.latex,
        "verdict": one.verdict,
        "wrong_term": one.wrong_term,
        "correction": one.correction,
        "witness": one.witness,
        "state": one.state,
        "basis": one.basis,
        "note": one.note,
    }
