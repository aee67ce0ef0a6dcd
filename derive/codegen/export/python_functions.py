"""Targets that are libraries of Python: functions that return what they compute."""

import ast
from collections.abc import Iterator
from typing import ClassVar

from derive.codegen.export.targets.python import Python


class PythonFunctions(Python):
    """Functions of sequences of numbers or symbols, for a library that traces or compiles them."""

    has_simulations = False
    #: Lines that import the library.
    imports: ClassVar[str]
    #: A line before every function; empty for none.
    decorator: ClassVar[str] = ""
    #: How a function returns the list `result`.
    collected: ClassVar[str] = "return result"

    def head(self) -> str:
        return self.imports

    def function(self) -> Iterator[str]:
        if self.decorator:
            yield self.decorator
        yield from super().function()

    def declarations(self) -> Iterator[str]:
        yield from super().declarations()
        if "result" in self.routine.parameters:
            yield f"result = [0.0]*{self._length()}"

    def _length(self) -> int:
        """The number of values of a function's result, each of which one statement assigns."""
        stores = (one for one in self.routine.body if isinstance(one, ast.Assign))
        return sum(ast.unparse(one.targets[0]).startswith("result[") for one in stores)

    def signature(self) -> str:
        names = (self.name(name) for name in self.routine.parameters if name != "result")
        return f"def {self.routine.name}({', '.join(names)}):"

    def closing(self, part: str) -> str:
        is_end = part == "function" and "result" in self.routine.parameters
        return f"{self.indentation}{self.collected}" if is_end else ""


def functions_of(library: str, names: str, **others: str) -> dict[str, str]:
    """The functions of a library that have the usual names, and others."""
    return {name: f"{library}.{name}" for name in names.split()} | others
