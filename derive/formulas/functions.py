"""The functions of formulas and of generated code, in one table."""

import sympy as sp

#: By their names in formulas, which are those in Python's ``math``, in NumPy and in C99.
FUNCTIONS = {f.__name__: f for f in (sp.sin, sp.cos, sp.tan, sp.exp, sp.log, sp.sqrt)}
