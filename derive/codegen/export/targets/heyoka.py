"""heyoka.py: expressions for integration by Taylor series."""

from derive.codegen.export.python_syntax import PythonFunctions, functions_of


class Heyoka(PythonFunctions):
    """Functions of expressions, whose results are lists of expressions."""

    title, suffix, command = "heyoka.py", "_heyoka.py", ""
    arithmetic = "heyoka simplifies expressions, so that last bits differ from other targets."
    imports = "\nimport heyoka as hy"
    functions = functions_of(
        "hy",
        "sqrt sin cos tan exp log sinh cosh tanh atan atan2 select",
        pow="({0}**{1})",
        abs="hy.sqrt({0}*{0})",
        select="hy.select(hy.gt({0}, 0.0), {1}, hy.select(hy.lte({0}, 0.0), {2}, {0}))",
    )


target = Heyoka
