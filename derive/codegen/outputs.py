"""Generated functions of measured quantities and their derivatives."""

from collections.abc import Sequence
from dataclasses import replace

import sympy as sp

from derive.codegen.writing import texts
from derive.mechanics.derivation import Derivation

FUNCTIONS = ("outputs", "outputs_jacobian", "outputs_parameter_jacobian")


def output_texts(derivation: Derivation, outputs: Sequence[sp.Expr]) -> dict[str, str]:
    """The generated files of functions of measured quantities alone."""
    named = {f"output_{k}": formula for k, formula in enumerate(outputs)}
    return texts(Derivation(replace(derivation.system, outputs=named)), FUNCTIONS)
