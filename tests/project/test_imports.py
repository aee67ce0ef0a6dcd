"""Imports: each package alone, each room only those below it, and no package of another project."""

import ast
import importlib
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import structure
from folders import ROOT
from structure import Folder, arrows_within, folders, imported_names

PACKAGES = ("derive", "generated", "solvers")
STANDARD = set(sys.stdlib_module_names)
#: Folders whose files are entries of a register.
UNBOUNDED = ("systems", "methods", "targets", "generated")

#: Packages that the modules of a package may import; solvers/app may import all of them.
ALLOWED = {
    # mpmath is SymPy's arithmetic; NumPy tries many meanings of a document's letters at once
    "derive": {
        *("derive", "sympy", "mpmath", "numpy", "lark", "tree_sitter", "solvers.io"),
        *("markdown_it", "docutils"),
    },
    "generated": {"numpy"},
    "solvers": {"solvers", "numpy", "scipy", "matplotlib"},
}


def is_within(name: str, package: str) -> bool:
    return f"{name}.".startswith(f"{package}.")


def foreign(path: Path, allowed: set[str]) -> set[str]:
    names = {n for n in imported_names(path) if n.partition(".")[0] not in STANDARD}
    return {n for n in names if not any(is_within(n, package) for package in allowed)}


def floors(package: str) -> dict[str, int]:
    """The floor of each room, from the table in the package's README."""
    text = (ROOT / package / "README.md").read_text()
    return {room: int(floor) for floor, room in re.findall(r"^\| (\d+) \| `(\w+)/` \|", text, re.M)}


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("package", PACKAGES)
def test_each_package_imports_only_the_allowed_packages(package: str) -> None:
    for path in (ROOT / package).rglob("*.py"):
        if not path.is_relative_to(ROOT / "solvers" / "app"):
            assert not foreign(path, ALLOWED[package]), path


@pytest.mark.parametrize("package", ["derive", "solvers"])
def test_every_room_has_a_floor_and_imports_only_rooms_below_it(package: str) -> None:
    floor = floors(package)
    rooms = {path.parent.name for path in (ROOT / package).glob("*/*.py")}
    assert set(floor) == rooms
    arrows = arrows_within(ROOT / package)
    assert [
        (one, other) for one in rooms for other in arrows[one] if floor[one] <= floor[other]
    ] == []


def test_rooms_have_few_arrows() -> None:
    assert len(floors("solvers")) == 10
    assert Folder.of(ROOT / "solvers").arrows <= 36


def test_no_files_or_rooms_import_each_other() -> None:
    rows = [row for package in structure.PACKAGES for row in folders(package)]
    assert {row.path: row.circles for row in rows if row.circles} == {}


def test_folders_have_few_files_and_floors() -> None:
    """But for folders whose files are entries of a register."""
    rows = [row for package in PACKAGES for row in folders(package)]
    rows = [row for row in rows if row.path.name not in UNBOUNDED]
    assert {row.path: row.files for row in rows if row.files > 15} == {}
    assert {row.path: row.floors for row in rows if row.floors > 7} == {}
    assert np.mean([row.floors for row in rows]) < 4.5


def test_no_name_of_a_class_or_file_stands_in_two_places() -> None:
    assert structure.repeated_names() == {}


def test_no_file_defines_a_name_twice() -> None:
    """Else constants of functions that were moved together have each other's values."""
    paths = [path for package in ("derive", "solvers") for path in (ROOT / package).rglob("*.py")]
    trees = {path: ast.parse(path.read_text()) for path in paths}
    assert [path for path, tree in trees.items() if structure.repeated_definitions(tree)] == []
    assert structure.repeated_definitions(ast.parse("A, B = 1, 2\nB, C = 3, 4")) == ["B"]


def test_no_file_imports_itself(tmp_path: Path) -> None:
    """Else files were joined without the import between them."""
    paths = [path for package in ("derive", "solvers") for path in (ROOT / package).rglob("*.py")]
    own = {path: ".".join(path.relative_to(ROOT).with_suffix("").parts) for path in paths}
    assert [path for path in paths if own[path] in imported_names(path)] == []
    own_file = tmp_path / "a.py"
    own_file.write_text("from solvers.io import a, b")
    assert "solvers.io.a" in imported_names(own_file)


def test_rooms_for_documents_have_few_arrows() -> None:
    row = Folder.of(ROOT / "derive" / "verification" / "documents")
    assert (row.floors, row.files) == (7, 7)
    assert row.arrows <= 35


def test_a_circle_through_three_files_is_detected(tmp_path: Path) -> None:
    for name, other in {"a": "b", "b": "c", "c": "a", "d": "a"}.items():
        (tmp_path / "solvers").mkdir(exist_ok=True)
        (tmp_path / "solvers" / f"{name}.py").write_text(f"from solvers.{other} import x\n")
    row = Folder.of(tmp_path / "solvers")
    assert (row.circles, row.floors, row.arrows) == ([["a", "b", "c"]], 2, 4)


def test_an_import_of_another_room_is_an_arrow(tmp_path: Path) -> None:
    for room, text in {"io": "from solvers.app.cli import main\n", "app": ""}.items():
        (tmp_path / "solvers" / room).mkdir(parents=True)
        (tmp_path / "solvers" / room / "cli.py").write_text(text)
    assert arrows_within(tmp_path / "solvers") == {"app": set(), "io": {"app"}}


def test_derive_imports_only_standard_library_modules_of_solvers() -> None:
    code = (
        "import sys, solvers.io.suggestion, solvers.io.atomic_write, solvers.io.toml_input,"
        "solvers.io.terminal, solvers.io.html_page;"
        "print([m for m in ('sympy', 'numpy', 'scipy', 'matplotlib') if m in sys.modules])"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert run.stdout == "[]\n"
    for path in (ROOT / "derive").rglob("*.py"):
        taken = {n.split(".")[2] for n in imported_names(path) if is_within(n, "solvers.io")}
        texts = {"suggestion", "atomic_write", "toml_input", "terminal", "lazy"}
        texts.add("html_page")
        assert taken <= texts, path


def test_generated_modules_use_only_math_from_the_standard_library_at_run_time() -> None:
    for path in (ROOT / "generated").glob("*.py"):
        top = ast.parse(path.read_text()).body
        names = {n.module for n in top if isinstance(n, ast.ImportFrom)}
        assert names <= {"__future__", "math", "typing"}


def test_a_foreign_import_is_detected(tmp_path: Path) -> None:
    path = tmp_path / "file.py"
    path.write_text(
        "import os\nfrom sympy.core import Add\nimport derive.codegen.expression_graph.graph"
    )
    assert foreign(path, ALLOWED["solvers"]) == {
        "sympy.core.Add",
        "derive.codegen.expression_graph.graph",
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


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="not a clone")
def test_the_top_level_holds_the_agreed_files_and_folders() -> None:
    command = ["git", "-C", str(ROOT), "ls-files"]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    names = {line.partition("/")[0] for line in run.stdout.splitlines()}
    visible = {name for name in names if not name.startswith(".")}
    folders = {"derive", "generated", "notebooks", "solvers", "tests"}
    files = {"CHANGELOG.md", "CITATION.cff", "LICENSE", "Makefile", "README.md", "holonomic.py"}
    assert visible == folders | files | {"pyproject.toml"}
