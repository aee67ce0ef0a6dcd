"""Notebooks are executed in a real kernel; ``python tests/helpers/notebooks.py`` stores outputs."""

import re
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
#: Digits, which may differ in rounding.
VARIABLE = re.compile(r"\d[\d.e+-]*")


def executed(path: Path) -> Any:
    """A notebook with its outputs; warnings are errors."""
    notebook = nbformat.read(path, as_version=4)
    strict = nbformat.v4.new_code_cell("import warnings\nwarnings.simplefilter('error')")
    relaxed = nbformat.v4.new_code_cell("warnings.resetwarnings()")
    notebook.cells = [strict, *notebook.cells, relaxed]
    resources = {"metadata": {"path": str(path.parent)}}
    client = NotebookClient(notebook, timeout=600, kernel_name="python3", resources=resources)
    client.execute()
    notebook.cells = notebook.cells[1:-1]
    return notebook


def described(notebook: Any) -> list[dict[str, str]]:
    """Kinds of the outputs of every cell, and the text of formulas without digits.

    Printed text differs between machines, in times and in what is fastest.
    """
    return [
        {
            kind: VARIABLE.sub("", text) if "<math" in text[:200] else ""
            for out in cell.get("outputs", ())
            for kind, text in out.get("data", {out.output_type: ""}).items()
        }
        for cell in notebook.cells
        if cell.cell_type == "code"
    ]


def main() -> None:
    """Execute all notebooks, and store their outputs."""
    for path in NOTEBOOKS:
        notebook = executed(path)
        count = 0
        for cell in notebook.cells:
            cell.metadata = {}
            if cell.cell_type == "code":
                count += 1
                cell.execution_count = count
                for out in cell.outputs:
                    if "execution_count" in out:
                        out.execution_count = count
        path.write_text(nbformat.writes(notebook, indent=1) + "\n", encoding="utf-8")
        print(path.relative_to(ROOT))


if __name__ == "__main__":
    main()
