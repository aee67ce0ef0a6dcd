"""Targets in Python: the syntax, and libraries of functions that return what they compute."""

import ast
from collections.abc import Collection, Iterator, Sequence
from typing import ClassVar

from derive.codegen.export.target import Target


class PythonSyntax(Target):
    """The syntax of Python, with vectors as lists."""

    comment, truth, logic = "# {}", ("False", "True"), ("or", "and", "not ")
    variable = fixed = assignment = "{name} = {value}"
    increment = "{name} += {value}"
    vector = "{name} = [0.0]*({size})"
    loop = "for {name} in range({start}, {stop}):"
    repeat, condition, another, otherwise = "while {test}:", "if {test}:", "elif {test}:", "else:"
    leave, answer, invocation = "break", "return {value}", "{call}"
    close = ""  # such lines are left out
    conversion, functions = "float({})", {}
    integer = real = "{name} = {value}"
    table = "{name} = [", "]"

    def documentation(self) -> Iterator[str]:
        return iter(())  # it follows the first line

    def declarations(self) -> Iterator[str]:
        first, *others = self.routine.doc
        yield f'"""{first}' if others else f'"""{first}"""'
        yield from (line for line in others)
        if others:
            yield '"""'

    def line(self, pad: str, text: str) -> str:
        lines = super().line(pad, text).splitlines()
        if len(lines) == 1:
            return lines[0]
        head, sign, value = text.partition(" = ")
        if not sign:
            head, sign, value = text.partition("return ")
        inner = super().line(f"{pad}    ", value)
        return f"{pad}{head}{sign}(\n{inner}\n{pad})"

    def block(
        self, statements: Sequence[ast.stmt], depth: int, defined: Collection[str]
    ) -> Iterator[str]:
        return (line for line in super().block(statements, depth, defined) if line.strip())

    def signature(self) -> str:
        types = {"float": "float", "int": "int", "vector": "Vector"}
        parts = [f"{self.name(n)}: {types[kind]}" for n, kind in self.routine.parameters.items()]
        return f"def {self.routine.name}({', '.join(parts)}) -> {self.routine.returns}:"


class PythonFunctions(PythonSyntax):
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
