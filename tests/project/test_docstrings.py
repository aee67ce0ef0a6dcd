"""Public names, and names in README and notebooks, are documented with examples that run."""

import ast
import doctest
import inspect
import json
import re
from enum import Enum
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages
from types import ModuleType
from typing import Any

import pytest
from folders import ROOT

import derive
import solvers

#: Modules that run something when they are imported.
PROGRAMS = {"derive.__main__"}


def modules() -> list[str]:
    return [
        found.name
        for package in (derive, solvers)
        for found in walk_packages(package.__path__, f"{package.__name__}.")
        if found.name not in PROGRAMS
    ]


def snippets() -> list[str]:
    return re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text("utf-8"), re.DOTALL)


def cells() -> list[str]:
    return [
        "".join(line for line in cell["source"] if not line.startswith("%"))
        for path in sorted((ROOT / "notebooks").glob("*.ipynb"))
        for cell in json.loads(path.read_text("utf-8"))["cells"]
        if cell["cell_type"] == "code"
    ]


def imported(sources: list[str]) -> dict[str, Any]:
    """Functions and classes of ours that these programs import."""
    found = {}
    for node in (node for source in sources for node in ast.walk(ast.parse(source))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(
            ("derive", "solvers")
        ):
            module = import_module(node.module or "")
            for alias in node.names:
                thing = getattr(module, alias.name, None)  # or a module
                if callable(thing):
                    found[f"{node.module}.{alias.name}"] = thing
    return found


def public() -> dict[str, Any]:
    """Functions and classes of the packages' stubs."""
    values = {
        f"{package.__name__}.{name}": getattr(package, name)
        for package in (derive, solvers)
        for name in package.__all__
    }
    return {name: value for name, value in values.items() if callable(value)}


PUBLIC = public()
#: Names that a user meets, and those of them that have an example.
SHOWN = PUBLIC | imported(snippets() + cells())
FIRST = PUBLIC | imported(snippets())


def section(thing: Any, title: str) -> str:
    """A section of a docstring."""
    text = inspect.getdoc(thing) or ""
    found = re.search(rf"^{title}\n-+\n(.*?)(?=^\w[\w ]*\n-+\n|\Z)", text, re.DOTALL | re.MULTILINE)
    return found[1] if found else ""


def parameters(thing: Any) -> list[str]:
    if isinstance(thing, type) and issubclass(thing, Enum):
        return []
    return [name for name in inspect.signature(thing).parameters if not name.startswith("_")]


@pytest.mark.parametrize("name", SHOWN)
def test_every_parameter_of_a_public_name_is_documented(name: str) -> None:
    thing = SHOWN[name]
    documented = section(thing, "Parameters") + section(thing, "Attributes")
    listed = re.findall(r"^([\w*, ]+?)(?: : .*)?$", documented, re.MULTILINE)
    names = {one.strip(" *") for row in listed for one in row.split(",")}
    assert {*parameters(thing)} <= names


@pytest.mark.parametrize("name", [n for n, thing in SHOWN.items() if not inspect.isclass(thing)])
def test_every_public_function_documents_its_result(name: str) -> None:
    returned = inspect.signature(SHOWN[name]).return_annotation
    if returned not in (None, "None"):
        assert section(SHOWN[name], "Returns") or section(SHOWN[name], "Yields")


@pytest.mark.parametrize("name", FIRST)
def test_every_public_name_has_an_example(name: str) -> None:
    assert ">>> " in section(FIRST[name], "Examples")


def examples() -> list[doctest.DocTest]:
    found: list[doctest.DocTest] = []
    for name in modules():
        module: ModuleType = import_module(name)
        found += [test for test in doctest.DocTestFinder().find(module, name) if test.examples]
    return found


@pytest.mark.long("more cases of the same kind", keep=24)
@pytest.mark.parametrize("example", examples(), ids=lambda example: example.name)
def test_examples_run(
    example: doctest.DocTest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    failures: list[str] = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    runner.run(example, out=failures.append)
    assert not failures, "".join(failures)


def test_there_are_examples() -> None:
    assert len(examples()) >= len({*FIRST.values()})
