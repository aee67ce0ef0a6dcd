"""JavaScript: an ES module with types in comments, for browsers and Node.js."""

from collections.abc import Iterator

from derive.codegen.export.target import Target

ROW = """\
/**
 * Print a row of output, with all digits.
 * @param {{number}} t
 * @param {{ArrayLike<number>}} values
 */
export function print_row(t, values) {{
    console.log([t, ...Array.from(values)].join(","));
}}
"""

MAIN = """\
// run the simulation if this file is the program, not if another module imports it
if (globalThis.process?.argv[1]?.endsWith("{file}")) {{
    console.log("{heading}");
    globalThis.process.exitCode = simulate() ? 0 : 3;
}}
"""


class JavaScript(Target):
    """ExportedFile functions with vectors as arrays."""

    title, suffix = "JavaScript", ".mjs"
    row, main = ROW, MAIN
    command = "node {file}"
    reserved = "arguments debugger eval export instanceof super typeof interface"
    variable, fixed = "let {name} = {value};", "const {name} = {value};"
    vector = "const {name} = new Float64Array({size});"
    loop = "for (let {name} = {start}; {name} < {stop}; {name}++) {{"
    conversion = "{}"
    integer = real = "export const {name} = {value};"
    table = "export const {name} = [", "];"
    functions = {"log": "Math.log", "abs": "Math.abs"} | {
        name: f"Math.{name}"
        for name in "sqrt floor sin cos tan exp sinh cosh tanh atan atan2 pow".split()
    }

    def documentation(self) -> Iterator[str]:
        yield "/**"
        yield from (f" * {line}".rstrip() for line in self.routine.doc)
        for name, kind in self.routine.parameters.items():
            changed = "Float64Array" if name in self.routine.changed else "ArrayLike<number>"
            yield f" * @param {{{changed if kind == 'vector' else 'number'}}} {self.name(name)}"
        if self.routine.returns:
            yield f" * @returns {{{'boolean' if self.routine.returns == 'bool' else 'number'}}}"
        yield " */"

    def signature(self) -> str:
        arguments = ", ".join(map(self.name, self.routine.parameters))
        return f"export function {self.routine.name}({arguments}) {{"

    def tail(self) -> str:
        file, heading = self.exported.stem + self.suffix, ",".join(self.exported.columns)
        return MAIN.format(file=file, heading=heading) if self.exported.columns else ""


target = JavaScript
