"""Verdicts in Markdown: a document, or a notebook, with notes below its formulas."""

import json
import re
from collections.abc import Sequence
from pathlib import Path

from derive.reading.document import Display, Document
from derive.reading.plain_formulas import PLAIN
from derive.verification.documents.pages.verdicts_in_place import (
    REFUTED,
    DocumentVerdicts,
    FormulaVerdict,
    one_line,
)

#: The margin of a line in a list or a quotation, and a mark of a list in it.
MARGIN = re.compile(r"[ \t>]*(?:(?:[-*+]|\d{1,9}[.)])[ \t]+)?")
MARK = re.compile(r"[^ \t>]")
#: Characters with a meaning in Markdown.
SPECIAL = re.compile(r"([\\`*_{}\[\]<>#|$])")


def markdown_notes(verdicts: DocumentVerdicts, document: Document) -> str:
    """The document with its verdicts below displays and behind wrong formulas in the text."""
    return _noted(verdicts, document, 0, len(document.text)) + f"\n\n{_summary(verdicts)}\n"


def notebook_notes(verdicts: DocumentVerdicts, document: Document) -> str:
    """The notebook with verdicts in its cells, and below cells with programs."""
    content = json.loads(Path(document.file).read_text(encoding="utf-8-sig"))
    programs = {one.number for one in document.programs}
    ends = (*(start - 1 for start in document.cells[1:]), len(document.text))
    cells = []
    for number, (cell, start, end) in enumerate(
        zip(content["cells"], document.cells, ends, strict=True), 1
    ):
        cells.append(cell)
        if cell["cell_type"] == "markdown":
            cell["source"] = _noted(verdicts, document, start, end)
        elif number in programs:
            own = [one for one in verdicts.formulas if one.cell == number]
            if own:
                cells.append(
                    _cell("\n".join(f"- {_entry(one, '`')}" for one in own), content, number)
                )
    cells.append(_cell(_summary(verdicts), content, len(cells)))
    return json.dumps(content | {"cells": cells}, ensure_ascii=False, indent=1) + "\n"


def _cell(source: str, notebook: dict[str, object], number: int) -> dict[str, object]:
    cell: dict[str, object] = {"cell_type": "markdown", "metadata": {}, "source": source}
    has_names = (notebook.get("nbformat"), notebook.get("nbformat_minor", 0)) >= (4, 5)
    return cell | ({"id": f"verdicts-{number}"} if has_names else {})


def _noted(verdicts: DocumentVerdicts, document: Document, start: int, end: int) -> str:
    """A part of the text with its notes."""
    pieces = []
    for display in document.displays:
        if not start <= display.extent[0] < end:
            continue
        own = [one for one in verdicts.formulas if one.is_in(display)]
        if note := _note(document, display, own):
            pieces += [document.text[start : display.extent[1]], note]
            start = display.extent[1]
    return "".join([*pieces, document.text[start:end]])


def _note(document: Document, display: Display, own: Sequence[FormulaVerdict]) -> str:
    """What follows a formula: a quotation at the end of a line, brackets within it."""
    text, (first, last) = document.text, display.extent
    start, end = text.rfind("\n", 0, first) + 1, text.find("\n", last)
    if display.delimiter == PLAIN and not display.is_inline:  # in code, where nothing is Markdown
        refuted = "; ".join(_details(one) for one in own if one.verdict in REFUTED)
        return f"   ({refuted})" if refuted else ""
    if display.is_inline or text[last : end if end >= 0 else None].strip():
        quote = "`" if display.delimiter == PLAIN else "$"
        refuted = "; ".join(_words(one, quote) for one in own if one.verdict in REFUTED)
        return f" ({refuted})" if refuted else ""
    margin = MARGIN.match(text, start)
    before = MARK.sub(" ", margin.group()) if margin else ""
    lines = "".join(f"\n{before}> - {_entry(one, '$')}" for one in own)
    is_last = not text[last:].strip() or text.startswith("\n\n", last)
    return f"\n{before.rstrip()}{lines}" + "\n" * (not is_last) if own else ""


def _entry(one: FormulaVerdict, quote: str) -> str:
    return f"line {one.line}: {_words(one, quote)}"


def _words(one: FormulaVerdict, quote: str) -> str:
    """The verdict with its correction, which stands in quotes, and details."""
    name = f"**{one.verdict}**" if one.verdict in REFUTED else one.verdict
    correction = f"should be {quote}{one_line(one.correction)}{quote}" if one.correction else ""
    return ", ".join(filter(None, (name, correction, _escaped(one.witness), _escaped(one.note))))


def _details(one: FormulaVerdict) -> str:
    """The verdict in plain text."""
    correction = f"should be {one_line(one.correction)}" if one.correction else ""
    return ", ".join(filter(None, (one.verdict, correction, one.witness, one.note)))


def _summary(verdicts: DocumentVerdicts) -> str:
    system = [f"System: {verdicts.system}."] if verdicts.system else []
    lines = [*system, *verdicts.remarks, verdicts.summary]
    return "\n\n".join(["**Verdicts**", *map(_escaped, lines)])


def _escaped(text: str) -> str:
    return SPECIAL.sub(r"\\\1", text)
