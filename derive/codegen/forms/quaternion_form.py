"""Lagrange's form of systems with unit quaternions, by way of angular velocities."""

from collections.abc import Mapping, Sequence
from functools import cached_property

import sympy as sp

from derive.codegen.expression_graph.node import Node
from derive.codegen.expression_graph.sympy_translation import Translation
from derive.codegen.forms.factorisation import ConstrainedFactorisation
from derive.codegen.forms.lagrangian_form import HALF
from derive.codegen.forms.projection_form import ProjectionForm
from derive.mechanics.derivation import Derivation
from derive.mechanics.quasi_velocities import QuasiVelocities, columns
from derive.system.symbols import TIME


class QuaternionForm(ProjectionForm):
    """Accelerations κ̈ = Eᵀ ḣ - |h|² κ from half the angular velocity h of each quaternion κ.

    The norms need no elimination: these equations are much shorter than those with multipliers.
    """

    def __init__(self, derivation: Derivation) -> None:
        super().__init__(derivation)
        self._quasi = QuasiVelocities(derivation)
        names = [q.name for q in self._system.q]
        self._indices = [[names.index(part.name) for part in parts] for parts in
                         self._quasi.quaternions]  # fmt: skip
        inner = {k for indices in self._indices for k in indices}
        self._others = [k for k in self._n if k not in inner]

    def _to_halves(self, column: Sequence[Node], indices: Sequence[int]) -> list[Node]:
        """E c of the components c of a column that belong to a quaternion."""
        rows = zip(*columns([self._system.q[k] for k in indices]), strict=True)
        return [
            self._graph.sum(
                [(self._node(e) * column[k], 1) for e, k in zip(row, indices, strict=True)]
            )
            for row in rows
        ]

    def _from_halves(self, triple: Sequence[Node], indices: Sequence[int]) -> list[Node]:
        """Eᵀ h."""
        return [
            self._graph.sum([(self._node(e) * h, 1) for e, h in zip(column, triple, strict=True)])
            for column in columns([self._system.q[k] for k in indices])
        ]

    def _reduced(self, column: Sequence[Node]) -> list[Node]:
        """Components for the quasi-velocities of a column with one component a coordinate."""
        halves = (h for indices in self._indices for h in self._to_halves(column, indices))
        return [*(column[k] for k in self._others), *halves]

    @cached_property
    def _halves(self) -> list[list[Node]]:
        """Half the angular velocity of each quaternion."""
        let = self._graph.let
        return [[let(h) for h in self._to_halves(self._qdot, indices)] for indices in self._indices]

    @cached_property
    def _quasi_node(self) -> Translation:
        symbols = (s for triple in self._quasi.halves.values() for s in triple)
        nodes = (h for triple in self._halves for h in triple)
        known = {s.name: h for s, h in zip(symbols, nodes, strict=True)}
        return Translation(self._graph, known, self._derivation.switching_functions)

    @cached_property
    def _quasi_system(self) -> ConstrainedFactorisation:
        quasi, node = self._quasi, self._quasi_node
        inertia = [[*map(node, quasi.mass_matrix.row(i))] for i in range(len(quasi.u))]
        constraints = [[*map(node, row)] for row in quasi.constraint_jacobian]
        singular = quasi.has_singular_mass_matrix
        return ConstrainedFactorisation.of_matrix(
            self._graph, inertia, constraints, singular=singular
        )

    @cached_property
    def _accelerations(self) -> list[Node]:
        quasi, node, graph = self._quasi, self._quasi_node, self._graph
        given = [
            graph.sum([(self._applied[i], 1), (self._derivative(self._potential, q.name), -1)])
            for i, q in enumerate(self._system.q)
        ]
        inertial = map(node, quasi.inertial_forces)
        forces = [
            graph.sum([(a, 1), (b, 1)]) for a, b in zip(inertial, self._reduced(given), strict=True)
        ]
        changes, _ = self._quasi_system.solve(forces, [*map(node, quasi.constraint_forcing)])
        result = self._coordinates(changes)
        for indices, triple in zip(self._indices, self._halves, strict=True):
            square = graph.let(graph.sum([(h * h, 1) for h in triple]))
            for k in indices:
                result[k] = graph.sum([(result[k], 1), (square * self._q[k], -1)])
        return [graph.let(node) for node in result]

    @property
    def energy(self) -> list[Node]:
        """½ uᵀ M u + V; with positions that depend on time Jacobi's integral as a function of q̇."""
        if TIME in self._derivation.variables:
            return super().energy
        u = [
            *(self._qdot[k] for k in self._others),
            *(h for triple in self._halves for h in triple),
        ]
        rows = (self._quasi.mass_matrix.row(i) for i in range(len(u)))
        terms = [
            (self._quasi_node(entry) * u[i] * u[j], HALF)
            for i, row in enumerate(rows)
            for j, entry in enumerate(row)
        ]
        return [self._graph.sum([*terms, (self._potential, 1)])]

    def _removing(self, residuals: Sequence[Node]) -> list[Node]:
        """Changes along each κ that remove residuals of norms, and the smallest for the others."""
        graph, changes = self._graph, [self._graph.zero for _ in self._n]
        formulas = [one.formula for one in self._system.conditions]
        of, rows = dict(zip(formulas, residuals, strict=True)), self._constraint_jacobian
        for norm, indices in zip(self._derivation.quaternion_norms, self._indices, strict=True):
            row = rows[formulas.index(norm)]
            factor = graph.let(of[norm] / graph.sum([(row[k] * self._q[k], 1) for k in indices]))
            for k in indices:
                changes[k] = -factor * self._q[k]
        missing = [
            graph.sum([(of[one], -1), *((a * x, -1) for a, x in zip(row, changes, strict=True))])
            for one, row in zip(formulas, rows, strict=True)
            if one not in self._derivation.quaternion_norms
        ]
        if not missing:
            return changes
        still = [graph.zero for _ in self._quasi.u]
        moved, _ = self._quasi_system.solve(still, missing)
        pairs = zip(changes, self._coordinates(moved), strict=True)
        return [graph.sum([(a, 1), (b, 1)]) for a, b in pairs]

    def _coordinates(self, column: Sequence[Node]) -> list[Node]:
        """Rates of the coordinates, from quasi-velocities."""
        result, first = dict(zip(self._others, column, strict=False)), len(self._others)
        for n, indices in enumerate(self._indices):
            triple = column[first + 3 * n : first + 3 * n + 3]
            result |= dict(zip(indices, self._from_halves(triple, indices), strict=True))
        return [result[k] for k in self._n]

    def _derivatives(self, variables: Sequence[sp.Symbol]) -> list[Node]:
        rates = [*self._qdot, *self._accelerations]
        return [self._derivative(rate, v.name) for rate in rates for v in variables]

    def _tangent(self, changes: Mapping[sp.Symbol, Node]) -> dict[sp.Symbol, Node]:
        q, qdot = self._system.q, self._system.qdot
        accelerations = [self._change(value, changes) for value in self._accelerations]
        return dict(zip((*q, *qdot), [*(changes[s] for s in qdot), *accelerations], strict=True))
