"""Documents as Jupyter notebooks, in version 4.5 of their format."""

import json
from collections.abc import Iterator, Sequence
from typing import Any

from derive.handout.document_model import (
    Block,
    Code,
    HandoutDocument,
    HandoutTable,
    NumberedEquation,
    Paragraph,
)
from derive.handout.formats.tex import aligned, with_formulas

METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}


def notebook(document: HandoutDocument) -> str:
    """The text of an ``.ipynb`` file: one cell a section, and one for each function in Python."""
    cells: list[dict[str, Any]] = []
    texts = [f"# {_escaped(document.title)}"]
    for number, section in enumerate(document.sections, 1):
        texts.append(f"## {number}. {_escaped(section.title)}")
        for block in section.blocks:
            if isinstance(block, Code) and block.is_executable:
                cells += [_markdown(texts), _code(block.text)]
                texts = []
            else:
                texts.append(_block(block))
        if texts:
            cells.append(_markdown(texts))
        texts = []
    for number, cell in enumerate(cells, 1):
        cell["id"] = f"cell-{number}"
    contents = {"cells": cells, "metadata": METADATA, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(contents, indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def _markdown(texts: Sequence[str]) -> dict[str, Any]:
    return {"cell_type": "markdown", "metadata": {}, "source": _lines("\n\n".join(texts))}


def _code(text: str) -> dict[str, Any]:
    source = {"cell_type": "code", "metadata": {}, "source": _lines(text)}
    return {**source, "execution_count": None, "outputs": []}


def _lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)


def _block(block: Block) -> str:
    match block:
        case Paragraph(text):
            return _text(text)
        case NumberedEquation(number=number):
            return f"$$\n{aligned(block)} \\tag{{{number}}}\n$$"
        case HandoutTable(head, rows):
            return "\n".join(_rows([head, ["---"] * len(head), *rows]))
        case Code(language, text):
            return f"{language}:\n\n```{language.lower()}\n{text}\n```"


def _rows(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    for row in rows:
        yield f"| {' | '.join(map(_text, row))} |"


def _text(text: str) -> str:
    return with_formulas(text, _escaped)


def _escaped(text: str) -> str:
    """`text` with the characters that have a meaning in Markdown escaped."""
    return "".join(rf"\{c}" if c in r"\*_#$[]<>|~" else c for c in text)
