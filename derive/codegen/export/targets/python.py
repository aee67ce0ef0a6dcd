"""Python without dependencies: one module, which is also a program."""

from derive.codegen.export.python_syntax import PythonSyntax

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


class Python(PythonSyntax):
    """A module with type annotations."""

    title, suffix = "Python", ".py"
    row, main = ROW, MAIN
    command = "python {file}"

    def head(self) -> str:
        called = sorted(self.program.library - {"abs", "float", "range", "print"})
        imports = "import sys\n" if self.exported.columns else ""
        imports += f"from math import {', '.join(called)}\n" if called else ""
        return f"{imports}\nVector = list[float]"


target = Python
