"""Hamilton's form: M w = p - b, q̇ = w and ṗ = ½ vᵀ (∂M̄/∂q) v - ∂V/∂q + Q."""

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property

import sympy as sp

from derive.codegen.expression_graph.node import Node, Terms
from derive.codegen.expression_graph.sympy_translation import Translation
from derive.codegen.forms.equations_of_motion import EquationsOfMotion
from derive.codegen.forms.factorisation import Rows

HALF = Fraction(1, 2)


class HamiltonianForm(EquationsOfMotion):
    """Derivatives and energy of (q, p)."""

    @cached_property
    def _moving(self) -> list[Node]:
        """Momenta p - b = M w."""
        drift = self._nodes(self._derivation.drift)
        return [p - b for p, b in zip(self._p, drift, strict=True)]

    @cached_property
    def _velocities(self) -> list[Node]:
        """Velocities w = M⁻¹ (p - b)."""
        return self._factorisation.solve(self._moving)

    @property
    def energy_hamiltonian(self) -> list[Node]:
        """H = ½ (p - b)ᵀ w + U."""
        kinetic = [(p * w, HALF) for p, w in zip(self._moving, self._velocities, strict=True)]
        return [self._graph.sum([*kinetic, (self._node(self._derivation.effective_potential), 1)])]

    @property
    def lagrangian_state(self) -> list[Node]:
        """Coordinates q, and q̇ of M q̇ = p - b."""
        return [*self._q, *self._velocities]

    @cached_property
    def _at_velocities(self) -> Translation:
        """Translation of expressions of (q, q̇), with w in place of q̇."""
        names = (qdot.name for qdot in self._system.qdot)
        velocities = dict(zip(names, self._velocities, strict=True))
        return Translation(self._graph, velocities, self._derivation.switching_functions)

    @property
    def rhs_hamiltonian(self) -> list[Node]:
        """The rates q̇ = w and ṗ = ½ vᵀ (∂M̄/∂q) v - ∂V/∂q + Q."""
        v, rates = self._rates(self._velocities), []
        for q, applied in zip(self._system.q, self._system.applied, strict=True):
            potential = self._derivative(self._potential, q.name)
            forces = [(potential, -1), (self._at_velocities(applied), 1)]
            inertial = self._bilinear(self._gradient(q, self._inertia), v, v, HALF)
            rates.append(self._graph.sum([*inertial, *forces]))
        return [*self._velocities, *rates]

    def _gradient(self, variable: sp.Symbol, matrix: Rows) -> list[list[Node]]:
        """∂matrix/∂variable."""
        return [[self._derivative(entry, variable.name) for entry in row] for row in matrix]

    @staticmethod
    def _bilinear(matrix: Rows, v: Sequence[Node], w: Sequence[Node], number: Fraction) -> Terms:
        """The terms of number times vᵀ matrix w."""
        entries = ((j, k, entry) for j, row in enumerate(matrix) for k, entry in enumerate(row))
        return tuple((entry * v[j] * w[k], number) for j, k, entry in entries)
