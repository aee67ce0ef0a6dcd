"""Python without dependencies: one module, which is also a program."""

import ast
from collections.abc import Collection, Iterator, Sequence

from derive.codegen.export.target import Target

ROW = '''\
def print_row(t: float, values: Vector) -> None:
    """Print a row of output, with all digits."""
    print(t, *values, sep=",")
'''

MAIN = """\
if __name__ == "__main__":
    print("{heading}")
    sys.exit(0 if simulate() else 3)
"""


class Python(Target):
    """Functions with vectors as lists."""

    title, suffix = "Python", ".py"
    row, main = ROW, MAIN
    command = "python {file}"
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

    def head(self) -> str:
        called = sorted(self.program.library - {"abs", "float", "range", "print"})
        imports = "import sys\n" if self.exported.columns else ""
        imports += f"from math import {', '.join(called)}\n" if called else ""
        return f"{imports}\nVector = list[float]"

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


target = Python
