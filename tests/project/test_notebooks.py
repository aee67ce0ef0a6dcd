"""Notebooks run from top to bottom in a real kernel, and are committed with these outputs."""

import ast
import json
from pathlib import Path
from typing import Any

import nbformat
import pytest

from notebooks import NOTEBOOKS, described, executed


def cells(path: Path, kind: str) -> list[dict[str, Any]]:
    found = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return [cell for cell in found if cell["cell_type"] == kind]


def python(cell: dict[str, Any]) -> str:
    """A cell without what is said to the notebook itself."""
    return "".join(line for line in cell["source"] if not line.startswith("%"))


def logic(cell: dict[str, Any]) -> list[str]:
    """Its lines, but for imports and blank ones."""
    return [
        line
        for line in cell["source"]
        if line.strip() and not line.startswith(("from ", "import "))
    ]


def test_notebooks_are_numbered_and_make_one_claim_each() -> None:
    assert [int(path.name[:2]) for path in NOTEBOOKS] == [*range(1, len(NOTEBOOKS) + 1)]
    for path in NOTEBOOKS:
        first = "".join(cells(path, "markdown")[0]["source"])
        assert first.startswith("# ")
        assert first.count("**Claim.**") == 1


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_thin_and_ends_with_its_proof(path: Path) -> None:
    code = cells(path, "code")
    assert all(len(logic(cell)) <= 10 for cell in code)
    last = ast.parse(python(code[-1])).body
    assert isinstance(last[-1], ast.Assert)


@pytest.mark.long("a kernel of Jupyter")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_proves_its_claim(path: Path) -> None:
    notebook = executed(path)
    shown = [out for cell in notebook.cells for out in cell.get("outputs", ())]
    assert not any(out.output_type == "stream" and out.name == "stderr" for out in shown)
    assert len(shown) >= 5
    # else run tests/helpers/notebooks.py
    assert described(nbformat.read(path, as_version=4)) == described(notebook)


def test_derivations_and_pictures_are_shown_as_such() -> None:
    kinds = {
        path.stem: [kind for cell in cells(path, "code") for out in cell["outputs"]
                    for kind in out.get("data", {})]
        for path in NOTEBOOKS[:2]
    }  # fmt: skip
    own, report = kinds.values()
    assert own.count("text/html") == 4  # system, derivation, step, motion
    assert report.count("text/html") == 9
    assert "image/png" in own


@pytest.mark.long("a kernel of Jupyter")
@pytest.mark.parametrize("planted", ["assert 1 > 2", "warnings.warn('anything')"])
def test_a_claim_that_does_not_hold_or_a_warning_is_noticed(planted: str, tmp_path: Path) -> None:
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(planted)])
    nbformat.write(notebook, tmp_path / "wrong.ipynb")
    with pytest.raises(Exception, match=r"AssertionError|UserWarning"):
        executed(tmp_path / "wrong.ipynb")
