"""Names of a package that are imported when they are first used."""

import ast
import re
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any


def attach(
    package: str, stub: Path
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """``__getattr__``, ``__dir__`` and ``__all__`` of a package, read from its stub file.

    The stub (``__init__.pyi``) is what editors and type checkers read, so that the names of a
    package and their homes are written once.
    """
    modules = homes(stub)

    def lookup(name: str) -> Any:
        if name not in modules:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(modules[name]), name)

    return lookup, lambda: sorted(modules), sorted(modules)


def groups(package: str) -> dict[str, list[str]]:
    """The public names of a package in groups with titles, as its docstring lists them."""
    paragraphs = (import_module(package).__doc__ or "").split("\n\n")
    parts = [one.partition(": `") for one in paragraphs]
    return {title: re.findall(r"`(\w+)`", f"`{rest}") for title, _, rest in parts if rest}


def homes(stub: Path) -> dict[str, str]:
    """The module of every name that a stub file imports."""
    tree = ast.parse(stub.read_text(encoding="utf-8"))
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    return {alias.name: str(node.module) for node in imports for alias in node.names}
