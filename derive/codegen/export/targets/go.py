"""Go: one file of the package main, or a package of functions."""

from derive.codegen.export.target import Target

ROW = """\
// Print a row of output, with all digits.
func print_row(t float64, values []float64) {{
	line := strconv.FormatFloat(t, 'g', -1, 64)
	for _, value := range values {{
		line += "," + strconv.FormatFloat(value, 'g', -1, 64)
	}}
	fmt.Println(line)
}}
"""

MAIN = """\
func main() {{
	fmt.Println("{heading}")
	if !simulate() {{
		os.Exit(3)
	}}
}}
"""


class Go(Target):
    """Functions with vectors as slices."""

    title, suffix = "Go", ".go"
    row, main = ROW, MAIN
    command = "go run {file}"
    arithmetic = (
        "Arithmetic is that of IEEE 754; conversions such as float64(a*b) prevent fused products."
    )
    reserved = "chan defer fallthrough func interface map range select make len new append"
    indentation = "\t"
    types = {"float": "float64", "int": "int", "bool": "bool"}
    variable = fixed = "{name} := {value}"
    vector = "{name} := make([]float64, {size})"
    assignment, increment = "{name} = {value}", "{name} += {value}"
    loop = "for {name} := {start}; {name} < {stop}; {name}++ {{"
    repeat, condition, another = "for {test} {{", "if {test} {{", "}} else if {test} {{"
    breaks_after_operators, last = True, ","
    leave, answer, invocation = "break", "return {value}", "{call}"
    conversion = "float64({})"
    functions = {
        name: f"math.{name.capitalize()}"
        for name in "abs sqrt floor sin cos tan exp log sinh cosh tanh atan atan2 pow".split()
    }
    integer = real = "const {name} = {value}"
    table = "var {name} = []float64{{", "}}"

    def head(self) -> str:
        package = "main" if self.exported.columns else self.exported.name
        names = ["fmt"] if self.exported.columns else []
        names += ["math"] if self.program.library & {*self.functions} else []
        names += ["os", "strconv"] if self.exported.columns else []
        imports = "\n".join(f'\t"{name}"' for name in names)
        return f"package {package}\n\nimport (\n{imports}\n)" if names else f"package {package}"

    def product(self, text: str) -> str:
        return f"float64({text})"

    def signature(self) -> str:
        types = {**self.types, "vector": "[]float64"}
        parameters = self.routine.parameters.items()
        parts = [f"{self.name(name)} {types[kind]}" for name, kind in parameters]
        returns = self.types.get(self.routine.returns or "", "")
        return f"func {self.routine.name}({', '.join(parts)}) {returns}".rstrip() + " {"


target = Go
