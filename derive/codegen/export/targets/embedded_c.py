"""C for microcontrollers: single precision, without library, heap or recursion."""

from collections.abc import Iterator

from derive.codegen.export.exported_program import operations
from derive.codegen.export.targets.c99 import C99


class EmbeddedC(C99):
    """A header of functions that a control loop calls, each with a bounded number of operations."""

    title, suffix, library_suffix = "C99 for microcontrollers", ".h", ".h"
    command, is_program, is_single, has_fixed_steps = "", False, True, True
    arithmetic = (
        "Numbers are of single precision. There is no heap, recursion or variable of the file;\n"
        "loops are bounded."
    )
    types = C99.types | {"float": "float"}
    number, conversion = "{}f", "(float){}"
    vector = "float {name}[{size}] = {{0.0f}};"
    real = "static const float {name} = {value};"
    table = ("static const float {name}[{size}] = {{", "}};")
    functions = {"abs": "fabsf"} | {
        name: f"{name}f"
        for name in "sqrt floor sin cos tan exp log sinh cosh tanh atan atan2 pow".split()
    }

    def head(self) -> str:
        calls = self.program.library & {*self.functions}
        return self.guard() + ("#include <math.h>\n" if calls else "")

    def documentation(self) -> Iterator[str]:
        count = operations(self.program, self.routine.name)
        return self.remarks([*self.routine.doc, "", f"{count} operations and calls at most."])

    def signature(self) -> str:
        return super().signature().replace("double *", "float *")


target = EmbeddedC
