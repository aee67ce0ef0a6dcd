"""The one import rule, and that the packages are this project's own."""

import ast
import importlib
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGES = ("derive", "generated", "solvers")
STANDARD = set(sys.stdlib_module_names)

ALLOWED = {
    "derive": {"derive", "sympy"},
    "generated": {"numpy"},
    "solvers": {"solvers", "numpy", "scipy", "matplotlib"},
}


def imported(source: str) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add((node.module or "").partition(".")[0])
    return found - STANDARD


@pytest.mark.parametrize("package", PACKAGES)
def test_each_package_imports_only_what_the_design_allows(package: str) -> None:
    for path in (ROOT / package).rglob("*.py"):
        if path != ROOT / "solvers" / "cli.py":
            foreign = imported(path.read_text()) - ALLOWED[package]
            assert not foreign, f"{path} imports {foreign}"


def test_generated_modules_use_only_math_from_the_standard_library_at_run_time() -> None:
    for path in (ROOT / "generated").glob("*.py"):
        top = ast.parse(path.read_text()).body
        names = {n.module for n in top if isinstance(n, ast.ImportFrom)}
        assert names <= {"__future__", "math", "typing"}


def test_a_foreign_import_is_noticed() -> None:
    assert imported("import os\nfrom sympy.core import Add\nimport derive.graph") == {
        "sympy",
        "derive",
    }


@pytest.mark.parametrize("package", PACKAGES)
def test_packages_come_from_this_repository(package: str) -> None:
    found = importlib.import_module(package).__file__
    assert found is not None
    assert Path(found).parent == ROOT / package


def test_importing_a_generated_module_loads_neither_sympy_nor_numpy() -> None:
    code = (
        "import sys, generated.double_pendulum as dp; dp.rhs(0, (1, 2, 3, 4), dp.DEFAULTS);"
        "print([m for m in ('sympy', 'numpy', 'scipy') if m in sys.modules])"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert run.stdout == "[]\n"
