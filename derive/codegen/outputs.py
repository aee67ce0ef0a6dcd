"""Generated functions of measured quantities and their derivatives."""

from collections.abc import Sequence

import sympy as sp

from derive.codegen.equations_of_motion import EquationsOfMotion
from derive.codegen.functions import Contents, Function
from derive.codegen.lowering import Lowering
from derive.codegen.node import Node
from derive.codegen.rational import with_fewest_calls
from derive.codegen.writing import files
from derive.mechanics.derivation import Derivation

#: Name, axes beside that of the outputs, summary and returned value of each function.
FUNCTIONS = (
    ("outputs", (), "Measured quantities.", "One number for each."),
    ("outputs_jacobian", ("state",), "Derivatives of `outputs` by the state.", "Row by row."),
    ("outputs_parameter_jacobian", ("parameters",),
        "Derivatives of `outputs` by the parameters.", "Row by row."),
)  # fmt: skip


class OutputForm(EquationsOfMotion):
    """Measured quantities as functions of (q, q̇), and their derivatives."""

    def __init__(self, derivation: Derivation, outputs: Sequence[sp.Expr]) -> None:
        super().__init__(derivation)
        self.outputs = self._nodes(outputs)

    def derivatives(self, variables: Sequence[sp.Symbol]) -> list[Node]:
        """Rows of derivatives."""
        return [self._derivative(node, v.name) for node in self.outputs for v in variables]


def output_texts(derivation: Derivation, outputs: Sequence[sp.Expr]) -> dict[str, str]:
    """The generated files of functions of measured quantities."""
    system = derivation.system
    variables = {"state": (*system.q, *system.qdot), "parameters": system.params}
    state, parameters = tuple(s.name for s in variables["state"]), {s.name for s in system.params}
    functions = []
    for name, axes, summary, returns in FUNCTIONS:
        form = OutputForm(derivation, outputs)
        columns = [variables[axis] for axis in axes]
        nodes = form.derivatives(*columns) if columns else form.outputs
        shape = (len(outputs), *map(len, columns))
        nodes = with_fewest_calls(nodes, [q.name for q in system.q])
        lowering = Lowering(nodes, parameters)
        takes_signs = bool(derivation.switching_functions)
        text = (summary, returns)
        functions.append(
            Function(system, name, *text, "lagrangian", state, shape, lowering, takes_signs)
        )
    return files(Contents(derivation, {"lagrangian": state}, tuple(functions)))
