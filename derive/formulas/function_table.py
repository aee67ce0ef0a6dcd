"""The functions of formulas, in one table."""

import sympy as sp

#: By their names in formulas.
FUNCTIONS = {
    f.__name__: f
    for f in (
        *(sp.sin, sp.cos, sp.tan, sp.exp, sp.log, sp.sqrt),
        *(sp.sinh, sp.cosh, sp.tanh, sp.atan, sp.atan2, sp.sign),
    )
} | {"abs": sp.Abs, "min": sp.Min, "max": sp.Max, "Piecewise": sp.Piecewise}

#: Functions of generated code, beside those of formulas that it calls by the same names.
GENERATED = ("pow", "select")
