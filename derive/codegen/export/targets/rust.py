"""Rust: one file without crates."""

from derive.codegen.export.target import Target

ROW = """\
// Print a row of output, with all digits.
pub fn print_row(t: f64, values: &[f64]) {{
    let numbers: Vec<String> = values.iter().map(|x| format!("{{:?}}", x)).collect();
    println!("{{:?}},{{}}", t, numbers.join(","));
}}
"""

MAIN = """\
fn main() {{
    println!("{heading}");
    std::process::exit(if simulate() {{ 0 }} else {{ 3 }});
}}
"""


class Rust(Target):
    """Functions with vectors as slices."""

    title, suffix = "Rust", ".rs"
    row, main = ROW, MAIN
    command = "rustc -O {file} && ./{stem}"
    reserved = "as crate dyn fn impl let loop match mod move mut pub ref self Self super trait use"
    types = {"float": "f64", "int": "usize", "bool": "bool"}
    variable, fixed = "let mut {name} = {value};", "let {name} = {value};"
    vector = "let mut {name} = [0.0; {size}];"
    loop = "for {name} in {start}..{stop} {{"
    repeat, condition, another = "while {test} {{", "if {test} {{", "}} else if {test} {{"
    element, conversion = "{name}[{index}]", "{} as f64"
    integer, real = "const {name}: usize = {value};", "const {name}: f64 = {value};"
    table = "const {name}: [f64; {size}] = [", "];"
    functions = {"log": "f64::ln", "pow": "f64::powf"} | {
        name: f"f64::{name}"
        for name in "abs sqrt floor sin cos tan exp sinh cosh tanh atan atan2".split()
    }

    def head(self) -> str:
        return "#![allow(unused_variables, non_snake_case, unused_parens)]"

    def signature(self) -> str:
        vectors = dict.fromkeys(self.routine.changed, "&mut [f64]")
        types = {**self.types, "vector": "&[f64]"}
        parameters = self.routine.parameters.items()
        parts = [f"{self.name(n)}: {vectors.get(n, types[kind])}" for n, kind in parameters]
        returns = self.types.get(self.routine.returns or "", "")
        arrow = f" -> {returns}" if returns else ""
        return f"pub fn {self.routine.name}({', '.join(parts)}){arrow} {{"

    def argument(self, text: str, name: str, *, changes: bool) -> str:
        if name in self.routine.parameters:
            return text
        return f"&mut {text}" if changes else f"&{text}"


target = Rust
