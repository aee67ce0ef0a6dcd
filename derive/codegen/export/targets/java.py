"""Java: one class of static methods."""

from derive.codegen.export.target import Target

ROW = """\
// Print a row of output, with all digits.
public static void print_row(double t, double[] values) {{
    StringBuilder line = new StringBuilder(Double.toString(t));
    for (double value : values) {{
        line.append(",").append(value);
    }}
    System.out.println(line);
}}
"""

MAIN = """\
public static void main(String[] arguments) {{
    System.out.println("{heading}");
    System.exit(simulate() ? 0 : 3);
}}
"""


class Java(Target):
    """Static methods of a class whose name is that of the file."""

    title, suffix = "Java", ".java"
    row, main = ROW, MAIN
    command = "java {file}"
    arithmetic = "Arithmetic is that of IEEE 754 from Java 17 on; nothing is fused or reordered."
    reserved = (
        "abstract boolean byte catch extends final finally implements import instanceof interface "
        "native protected strictfp super synchronized throw throws transient"
    )
    types = {"float": "double", "int": "int", "bool": "boolean"}
    fixed = "final {type} {name} = {value};"
    vector = "double[] {name} = new double[{size}];"
    functions = {
        name: f"Math.{name}"
        for name in "abs sqrt floor sin cos tan exp log sinh cosh tanh atan atan2 pow".split()
    }
    integer = "static final int {name} = {value};"
    real = "static final double {name} = {value};"
    table = "static final double[] {name} = {{", "}};"

    def file(self) -> str:
        header, _, rest = super().file().partition("\n\n@\n\n")
        body = "\n".join(f"    {line}".rstrip() for line in rest.splitlines())
        return f"{header}\n\npublic final class {self.exported.stem} {{\n{body}\n}}\n"

    def head(self) -> str:
        return "@"  # where the class begins

    def signature(self) -> str:
        types = {**self.types, "vector": "double[]"}
        parameters = self.routine.parameters.items()
        parts = [f"{types[kind]} {self.name(name)}" for name, kind in parameters]
        returns = self.types.get(self.routine.returns or "", "void")
        return f"public static {returns} {self.routine.name}({', '.join(parts)}) {{"


target = Java
