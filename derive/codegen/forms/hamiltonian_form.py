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

    @property
    def jacobian_hamiltonian(self) -> list[Node]:
        """Rows of ∂(q̇, ṗ)/∂(q, p), from the derivatives of w.

        Without applied forces ∂ṗ/∂p is -(∂q̇/∂q)ᵀ.
        """
        by_q = [self._velocity_change(q) for q in self._system.q]
        by_p = [
            self._factorisation.solve([self._graph.node(int(i == k)) for i in self._n])
            for k in self._n
        ]
        upper = [[column[i] for column in (*by_q, *by_p)] for i in self._n]
        lower = []
        for i in self._n:
            pairs = zip(self._system.q, by_q, strict=True)
            row = [self._force_change(i, q, change) for q, change in pairs]
            row += [
                self._graph.sum([(-by_q[i][k], 1), *self._friction(i, by_p[k])]) for k in self._n
            ]
            lower.append(row)
        return [node for row in (*upper, *lower) for node in row]

    def _shifted(self, variable: sp.Symbol, vector: Sequence[Node]) -> list[Node]:
        """(∂M/∂variable) vector."""
        name, n = variable.name, len(vector)
        return [
            self._graph.sum([(self._derivative(row[j], name) * vector[j], 1) for j in range(n)])
            for row in self._inertia[:n]
        ]

    def _velocity_change(self, variable: sp.Symbol) -> list[Node]:
        """∂w/∂variable: M ∂w = -(∂M w + ∂b)."""
        shift, drift = self._shifted(variable, self._velocities), self._derivation.drift
        pairs = zip(shift, self._nodes(drift), strict=True)
        right = [-(a + self._derivative(b, variable.name)) for a, b in pairs]
        return self._factorisation.solve(right)

    def _force_change(self, i: int, variable: sp.Symbol, change: Sequence[Node]) -> Node:
        """∂ṗ_i/∂variable, a coordinate or constant by which w has the derivative `change`."""
        q, w, derivative = self._system.q[i], self._velocities, self._derivative
        v, gradient = self._rates(w), self._gradient(q, self._inertia)
        second = self._bilinear(self._gradient(variable, gradient), v, v, HALF)
        terms = [*second, *self._bilinear(gradient[: len(w)], change, v, Fraction(1))]
        potential = derivative(derivative(self._potential, q.name), variable.name)
        force = self._at_velocities(self._system.applied[i].diff(variable))
        return self._graph.sum([*terms, (potential, -1), (force, 1), *self._friction(i, change)])

    def _friction(self, i: int, change: Sequence[Node]) -> Terms:
        """The terms of ∂Q_i/∂q̇ times a change of the velocities."""
        force = self._system.applied[i]
        drag = (self._at_velocities(force.diff(rate)) for rate in self._system.qdot)
        return tuple((a * b, Fraction(1)) for a, b in zip(drag, change, strict=True))
