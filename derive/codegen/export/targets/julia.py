"""Julia: one file of the base language."""

from derive.codegen.export.target import Target

ROW = """\
# Print a row of output, with all digits.
function print_row(t, values)
    println(join([t; values], ","))
end
"""

MAIN = """\
if abspath(PROGRAM_FILE) == @__FILE__
    println("{heading}")
    exit(simulate() ? 0 : 3)
end
"""


class Julia(Target):
    """Functions that change their vectors."""

    title, suffix = "Julia", ".jl"
    row, main = ROW, MAIN
    command = "julia {file}"
    reserved = "abstract baremodule begin function let local macro module mutable primitive quote"
    comment = "# {}"
    variable = fixed = assignment = "{name} = {value}"
    increment = "{name} += {value}"
    vector = "{name} = zeros({size})"
    loop = "for {name} in {start}:{stop} - 1"
    repeat, condition = "while {test}", "if {test}"
    another, otherwise, close = "elseif {test}", "else", "end"
    leave, answer, invocation = "break", "return {value}", "{call}"
    breaks_after_operators, first = True, 1
    conversion = "Float64({})"
    functions = {"atan2": "atan", "pow": "^({}, {})"}
    integer = real = "const {name} = {value}"
    table = "const {name} = [", "]"

    def signature(self) -> str:
        types = {"float": "Float64", "int": "Int", "vector": "AbstractVector{Float64}"}
        parameters = self.routine.parameters.items()
        parts = [f"{self.name(name)}::{types[kind]}" for name, kind in parameters]
        return f"function {self.routine.name}({', '.join(parts)})"


target = Julia
