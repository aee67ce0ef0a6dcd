"""MATLAB and GNU Octave: one function file, whose first function runs the simulation."""

import ast
from collections.abc import Iterator

from derive.codegen.export.exported_program import called
from derive.codegen.export.target import Target

ROW = """\
% Print a row of output, with all digits.
function print_row(t, values)
    fprintf("%.17g", t);
    fprintf(",%.17g", values);
    fprintf("\\n");
end
"""

MAIN = """\
function {stem}()
    fprintf("%s\\n", "{heading}");
    if ~simulate()
        error("steps became too small");
    end
end
"""

LIBRARY = """\
% Handles of the functions, such as {stem}().rhs.
function handles = {stem}()
{handles}
end
"""


class Matlab(Target):
    """Functions that return the vectors that they change."""

    title, suffix = "MATLAB, GNU Octave", ".m"
    row, main = ROW, MAIN
    command = "octave --eval {stem}"
    reserved = "function end otherwise parfor persistent spmd i j pi"
    comment = "% {}"
    logic = ("||", "&&", "~")
    variable = fixed = assignment = "{name} = {value};"
    increment = "{name} = {name} + {value};"
    vector = "{name} = zeros(1, {size});"
    loop = "for {name} = {start}:{stop} - 1"
    repeat, condition = "while {test}", "if {test}"
    another, otherwise, close = "elseif {test}", "else", "end"
    leave, continued, first = "break;", " ...", 1
    element, conversion = "{name}({index})", "{}"
    functions = {"pow": "({}^{})"}
    integer = real = "{name} = {value};"
    table = "{name} = [", "];"

    def constants(self) -> Iterator[str]:
        yield ""  # each function has those that it uses

    def _outputs(self) -> list[str]:
        value = ["answer"] if self.routine.returns else []
        changed = [name for name in self.routine.parameters if name in self.routine.changed]
        return [*value, *map(self.name, changed)]

    def signature(self) -> str:
        outputs, arguments = self._outputs(), ", ".join(map(self.name, self.routine.parameters))
        left = f"[{', '.join(outputs)}] = " if outputs else ""
        return f"function {left}{self.routine.name}({arguments})"

    def declarations(self) -> Iterator[str]:
        used = {n: v for n, v in self.program.constants.items() if n in self.routine.used}
        for name, value in used.items():
            if isinstance(value, list):
                yield from f"{name} = [{', '.join(map(self.literal, value))}];".splitlines()
            else:
                yield self.real.format(name=name, value=self.literal(value))

    def definition(self, name: str, value: ast.expr) -> str:
        if called(value) in self.program.routines:
            assert isinstance(value, ast.Call)
            return self.invoked(value, self.name(name))
        return super().definition(name, value)

    def invoked(self, call: ast.Call, target: str = "") -> str:
        assert isinstance(call.func, ast.Name)
        inner = self.program.routines[call.func.id]
        pairs = zip(inner.parameters, call.args, strict=True)
        changed = [self.text(one) for name, one in pairs if name in inner.changed]
        outputs = [*([target] if target else []), *changed]
        return f"[{', '.join(outputs)}] = {self.text(call)};" if outputs else f"{self.text(call)};"

    def returned(self, value: str) -> Iterator[str]:
        yield f"answer = {value};"
        yield "return"

    def file(self) -> str:
        header, _, functions = super().file().partition("\n\n")
        names = (f"    handles.{name} = @{name};" for name in self.program.routines)
        library = LIBRARY.format(stem=self.exported.stem, handles="\n".join(names))
        return f"{header}\n\n{super().tail() or library}\n{functions}"

    def tail(self) -> str:
        return ""  # the first function of the file runs the simulation


target = Matlab
