"""Numba: functions that are compiled when they are first called."""

from derive.codegen.export.python_syntax import PythonFunctions


class Numba(PythonFunctions):
    """Functions of arrays, whose results are arrays."""

    title, suffix, command = "Numba", "_numba.py", ""
    imports = """
import math

import numba
import numpy as np"""
    decorator, collected = "@numba.njit", "return np.array(result)"
    functions = {
        name: f"math.{name}"
        for name in "sqrt floor sin cos tan exp log sinh cosh tanh atan atan2 pow".split()
    }


target = Numba
