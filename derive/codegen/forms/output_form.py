"""Outputs of a system and their derivatives."""

from collections.abc import Sequence

import sympy as sp

from derive.codegen.expression_graph.node import Node
from derive.codegen.forms.equations_of_motion import EquationsOfMotion
from derive.mechanics.derivation import Derivation


class OutputForm(EquationsOfMotion):
    """The outputs of a system as functions of (q, q̇), and their derivatives."""

    def __init__(self, derivation: Derivation) -> None:
        super().__init__(derivation)
        self.outputs = self._nodes([formula for _, formula in self._system.measured])

    @property
    def outputs_jacobian(self) -> list[Node]:
        """Rows of ∂outputs/∂(q, q̇)."""
        return self._derivatives((*self._system.q, *self._system.qdot))

    @property
    def outputs_parameter_jacobian(self) -> list[Node]:
        """Rows of ∂outputs/∂params."""
        return self._derivatives(self._system.params)

    def _derivatives(self, variables: Sequence[sp.Symbol]) -> list[Node]:
        return [self._derivative(node, v.name) for node in self.outputs for v in variables]
