"""Hamilton's form: M w = p - b, q̇ = w and ṗ = ½ vᵀ (∂M̄/∂q) v - ∂V/∂q + Q."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property

import sympy as sp

from derive.codegen.equations_of_motion import EquationsOfMotion
from derive.codegen.node import Node
from derive.codegen.translation import Translation

HALF = Fraction(1, 2)


class HamiltonianForm(EquationsOfMotion):
    """Rates and energy of (q, p)."""

    @cached_property
    def _moving(self) -> list[Node]:
        """Momenta p - b of what the coordinates move; then M w is this."""
        drift = self._nodes(self._derivation.drift)
        return [p - b for p, b in zip(self._p, drift, strict=True)]

    @cached_property
    def _velocities(self) -> list[Node]:
        """Velocities w of the Hamiltonian form."""
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
        """Expressions of (q, q̇) in the Hamiltonian form, where q̇ is w."""
        names = (qdot.name for qdot in self._system.qdot)
        return Translation(self._graph, dict(zip(names, self._velocities, strict=True)))

    @property
    def rhs_hamiltonian(self) -> list[Node]:
        """Rates q̇ = w and ṗ = ½ vᵀ (∂M̄/∂q) v - ∂V/∂q + Q."""
        v, rates = self._rates(self._velocities), []
        for q, applied in zip(self._system.q, self._system.applied, strict=True):
            potential = self._derivative(self._potential, q.name)
            forces = [(potential, -1), (self._at_velocities(applied), 1)]
            rates.append(
                self._graph.sum(
                    [*self._bilinear(self._gradient(q, self._inertia), v, v, HALF), *forces]
                )
            )
        return [*self._velocities, *rates]

    def _gradient(self, q: sp.Symbol, matrix: list[list[Node]]) -> list[list[Node]]:
        """∂matrix/∂q."""
        return [[self._derivative(entry, q.name) for entry in row] for row in matrix]

    @staticmethod
    def _bilinear(
        matrix: Sequence[Sequence[Node]], v: Sequence[Node], w: Sequence[Node], number: Fraction
    ) -> list[tuple[Node, Fraction]]:
        """The terms of number times vᵀ matrix w."""
        return [
            (entry * v[j] * w[k], number)
            for j, row in enumerate(matrix)
            for k, entry in enumerate(row)
        ]

    @property
    def jacobian_hamiltonian(self) -> list[Node]:
        """Rows of ∂(q̇, ṗ)/∂(q, p): both halves come from ∂w and what moves though w is kept.

        Without applied forces ∂ṗ/∂p is -(∂q̇/∂q)ᵀ.
        """
        q, w, graph = self._system.q, self._velocities, self._graph
        v, drift = self._rates(w), self._nodes(self._derivation.drift)
        solve, slope = self._factorisation.solve, self._derivative
        by_p = [solve([graph.node(int(i == k)) for i in self._n]) for k in self._n]
        by_q = []
        for qk in q:
            shift = self._shifted(qk, w)
            by_q.append(
                solve([-(a + slope(b, qk.name)) for a, b in zip(shift, drift, strict=True)])
            )
        lower = []
        for i in self._n:
            gradient, force = self._gradient(q[i], self._inertia), self._system.applied[i]
            drag = [self._at_velocities(force.diff(rate)) for rate in self._system.qdot]
            row = [
                graph.sum([
                    *self._bilinear(self._gradient(qk, gradient), v, v, HALF),
                    *self._bilinear(gradient[: len(w)], change, v, Fraction(1)),
                    (slope(slope(self._potential, q[i].name), qk.name), -1),
                    (self._at_velocities(force.diff(qk)), 1),
                    *((a * b, 1) for a, b in zip(drag, change, strict=True)),
                ])
                for qk, change in zip(q, by_q, strict=True)
            ]  # fmt: skip
            row += [
                graph.sum(
                    [(-by_q[i][k], 1), *((a * b, 1) for a, b in zip(drag, by_p[k], strict=True))]
                )
                for k in self._n
            ]
            lower.append(row)
        upper = [[column[i] for column in (*by_q, *by_p)] for i in self._n]
        return [node for row in (*upper, *lower) for node in row]
