"""Jupyter notebooks: the Markdown and the programs of their cells; outputs are not read."""

import json
from dataclasses import dataclass
from typing import Any

from derive.reading.formats.markdown import decoded as decoded
from derive.reading.formats.markdown import excerpts as excerpts
from derive.reading.formats.markdown import prose as prose

KIND, SUFFIXES = "notebook", (".ipynb",)


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
        raise ValueError("it is no Jupyter notebook of format 4") from error


def _cell(cell: Any, language: str) -> Cell:
    source = cell["source"]
    text = source if isinstance(source, str) else "".join(source)
    kind = cell["cell_type"]
    return Cell(kind == "markdown", language if kind == "code" else "", _lines(text))


def _lines(text: str) -> str:
    return text.replace("\r\n", "\n")


def _language(notebook: Any) -> str:
    metadata = notebook.get("metadata", {})
    kernel, information = metadata.get("kernelspec", {}), metadata.get("language_info", {})
    return str(kernel.get("language") or information.get("name") or "python").lower()
