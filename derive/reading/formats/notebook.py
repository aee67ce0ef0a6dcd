"""Jupyter notebooks: the Markdown and the programs of their cells; outputs are not read."""

import json
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Cell:
    """The source of a cell, and the programming language of code."""

    is_markdown: bool
    language: str
    text: str


def cells(content: str) -> list[Cell]:
    """The cells of a notebook.

    Raises
    ------
    ValueError
        If the content is no notebook of format 4.
    """
    try:
        notebook = json.loads(content, parse_int=str, parse_float=str, parse_constant=str)
        language = _language(notebook)
        return [_cell(one, language) for one in notebook["cells"]]
    except (KeyError, TypeError, AttributeError, RecursionError, json.JSONDecodeError) as error:
        raise ValueError(f"it is no Jupyter notebook of format 4 ({_cause(error)})") from error


def _cell(cell: Any, language: str) -> Cell:
    source = cell["source"]
    text = source if isinstance(source, str) else "".join(source)
    kind = cell["cell_type"]
    return Cell(kind == "markdown", language if kind == "code" else "", _lines(text))


def _lines(text: str) -> str:
    return text.replace("\r\n", "\n")


def _language(notebook: Any) -> str:
    metadata = notebook.get("metadata", {})
    information = metadata.get("language_info") or metadata.get("kernelspec") or {}
    return str(information.get("name") or "python")


def _cause(error: Exception) -> str:
    return f"no {error}" if isinstance(error, KeyError) else str(error)[:80]
