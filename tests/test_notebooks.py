"""Notebooks run from top to bottom, and are committed without outputs."""

import ast
import json
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parent.parent / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_proves_its_claim_in_its_last_cell(path: Path) -> None:
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    programs = ["".join(c["source"]) for c in cells if c["cell_type"] == "code"]
    scope: dict[str, object] = {}
    for program in programs:
        exec(compile(program, path.name, "exec"), scope)
    assert any(isinstance(node, ast.Assert) for node in ast.walk(ast.parse(programs[-1])))
    assert all(len(program.splitlines()) <= 10 for program in programs)
    assert not any(c.get("outputs") or c.get("execution_count") for c in cells)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_what_a_notebook_shows_has_latex(path: Path) -> None:
    # the last expression of a cell is what a reader sees
    shown, scope = 0, {}
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] == "code":
            *body, last = ast.parse("".join(cell["source"])).body
            exec(compile(ast.Module(body, []), path.name, "exec"), scope)
            if isinstance(last, ast.Expr) and not isinstance(last.value, ast.Call):
                value = eval(compile(ast.Expression(last.value), path.name, "eval"), scope)
                shown += hasattr(value, "_repr_latex_")
            else:
                exec(compile(ast.Module([last], []), path.name, "exec"), scope)
    assert shown >= 5
