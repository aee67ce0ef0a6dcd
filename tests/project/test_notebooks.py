"""Notebooks run from top to bottom in a real kernel, and are committed without outputs."""

import ast
import json
from pathlib import Path
from typing import Any

import nbformat
import pytest
from folders import ROOT
from nbclient import NotebookClient

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))


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


def executed(path: Path) -> list[Any]:
    """The outputs of a notebook in which warnings are errors."""
    notebook = nbformat.read(path, as_version=4)
    strict = "import warnings\nwarnings.simplefilter('error')"
    notebook.cells.insert(0, nbformat.v4.new_code_cell(strict))
    notebook.cells.append(nbformat.v4.new_code_cell("warnings.resetwarnings()"))
    client = NotebookClient(
        notebook,
        timeout=600,
        kernel_name="python3",
        resources={"metadata": {"path": str(path.parent)}},
    )
    client.execute()
    return [out for cell in notebook.cells for out in cell.get("outputs", [])]


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
    assert not any(cell["outputs"] or cell["execution_count"] for cell in code)
    last = ast.parse(python(code[-1])).body
    assert isinstance(last[-1], ast.Assert)


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_proves_its_claim(path: Path) -> None:
    shown = executed(path)
    assert not any(out.output_type == "stream" and out.name == "stderr" for out in shown)
    assert len(shown) >= 5


@pytest.mark.long("a kernel of Jupyter")
def test_derivations_and_pictures_are_shown_as_such() -> None:
    kinds = {
        path.stem: [kind for out in executed(path) for kind in out.get("data", {})]
        for path in NOTEBOOKS
        if path.stem in ("01_derivation", "06_your_own_system")
    }
    assert kinds["01_derivation"].count("text/html") == 9
    assert kinds["06_your_own_system"].count("text/html") == 3
    assert "image/png" in kinds["06_your_own_system"]


@pytest.mark.long("a kernel of Jupyter")
@pytest.mark.parametrize("planted", ["assert 1 > 2", "warnings.warn('anything')"])
def test_a_claim_that_does_not_hold_or_a_warning_is_noticed(planted: str, tmp_path: Path) -> None:
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(planted)])
    nbformat.write(notebook, tmp_path / "wrong.ipynb")
    with pytest.raises(Exception, match=r"AssertionError|UserWarning"):
        executed(tmp_path / "wrong.ipynb")
