"""Hamilton's form: M w = p - b, q̇ = w and ṗ = ½ vᵀ (∂M̄/∂q) v - ∂V/∂q + Q."""

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property

import sympy as sp

from derive.codegen.equations_of_motion import EquationsOfMotion
from derive.codegen.factorisation import Rows
from derive.codegen.node import Node, Terms
from derive.codegen.translation import Translation

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
        return Translation(self._graph, dict(zip(names, self._velocities, strict=True)))

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

    def _gradient(self, q: sp.Symbol, matrix: Rows) -> list[list[Node]]:
        """∂matrix/∂q."""
        return [[self._derivative(entry, q.name) for entry in row] for row in matrix]

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
        by_q, by_p = self._velocity_derivatives
        upper = [[column[i] for column in (*by_q, *by_p)] for i in self._n]
        return [node for row in (*upper, *map(self._force_derivatives, self._n)) for node in row]

    @cached_property
    def _velocity_derivatives(self) -> tuple[list[list[Node]], list[list[Node]]]:
        """Columns of ∂w/∂q and of ∂w/∂p."""
        w, solve, derivative = self._velocities, self._factorisation.solve, self._derivative
        drift, by_q = self._nodes(self._derivation.drift), []
        by_p = [solve([self._graph.node(int(i == k)) for i in self._n]) for k in self._n]
        for q in self._system.q:
            shift = self._shifted(q, w)
            right = [-(a + derivative(b, q.name)) for a, b in zip(shift, drift, strict=True)]
            by_q.append(solve(right))
        return by_q, by_p

    def _force_derivatives(self, i: int) -> list[Node]:
        """The row ∂ṗ_i/∂(q, p)."""
        q, graph, derivative = self._system.q, self._graph, self._derivative
        w, (by_q, by_p) = self._velocities, self._velocity_derivatives
        v = self._rates(w)
        gradient, force = self._gradient(q[i], self._inertia), self._system.applied[i]
        drag = [self._at_velocities(force.diff(rate)) for rate in self._system.qdot]
        row = []
        for qk, change in zip(q, by_q, strict=True):
            second = self._bilinear(self._gradient(qk, gradient), v, v, HALF)
            terms = [*second, *self._bilinear(gradient[: len(w)], change, v, Fraction(1))]
            potential = derivative(derivative(self._potential, q[i].name), qk.name)
            forces = [(potential, -1), (self._at_velocities(force.diff(qk)), 1)]
            friction = [(a * b, 1) for a, b in zip(drag, change, strict=True)]
            row.append(graph.sum([*terms, *forces, *friction]))
        for k in self._n:
            friction = [(a * b, 1) for a, b in zip(drag, by_p[k], strict=True)]
            row.append(graph.sum([(-by_q[i][k], 1), *friction]))
        return row
