"""CasADi: functions of symbols, for optimal control."""

from derive.codegen.export.python_syntax import PythonFunctions, functions_of


class CasADi(PythonFunctions):
    """Functions of columns SX or MX, whose results are columns."""

    title, suffix, command = "CasADi", "_casadi.py", ""
    arithmetic = "CasADi may simplify products with constants; other operations stay as they are."
    imports = "\nimport casadi"
    collected = "return casadi.vertcat(*result)"
    functions = functions_of(
        "casadi",
        "sqrt sin cos tan exp log sinh cosh tanh atan atan2",
        pow="casadi.power",
        abs="casadi.fabs",
        select="casadi.if_else({0} > 0.0, {1}, casadi.if_else({0} <= 0.0, {2}, {0}))",
    )


target = CasADi
