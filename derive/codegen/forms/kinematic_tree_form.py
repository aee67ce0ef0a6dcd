"""Lagrange's form of systems with a kinematic tree: sums along branches, elimination from its ends.

The equations are those of the tree's variables, φ = S q: M φ̈ = f + Gᵀ λ and G φ̈ = γ.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cached_property

import sympy as sp

from derive.codegen.expression_graph.differentiation import Differentiation
from derive.codegen.expression_graph.graph import Graph
from derive.codegen.expression_graph.node import Node
from derive.codegen.expression_graph.rational import substitution
from derive.codegen.expression_graph.sympy_translation import Translation, fraction
from derive.codegen.forms.factorisation import ConstrainedFactorisation, Rows
from derive.codegen.forms.kinematic_tree_factorisation import TreeFactorisation
from derive.codegen.forms.lagrangian_form import HALF
from derive.codegen.forms.projection_form import ProjectionForm
from derive.mechanics.derivation import Derivation

Vector = list[Node]


class TreeForm(ProjectionForm):
    """Derivatives of (q, q̇) in a number of operations that grows with that of branches."""

    def __init__(self, derivation: Derivation) -> None:
        super().__init__(derivation)
        if derivation.tree is None:
            raise ValueError(f"system {derivation.system.name!r} has no kinematic tree")
        tree, q, qdot = derivation.tree, self._system.q, self._system.qdot
        self._tree = tree
        names = [variable.name for variable in tree.variables]
        self._along = [f"along {name}" for name in names]
        self._along_rates = [f"rate of {name}" for name in names]
        columns = [tree.differences.col(i) for i in self._n]
        self._directions = {
            name: {s.name: fraction(x) for s, x in zip(state, column, strict=True) if x}
            for state, names in ((q, self._along), (qdot, self._along_rates))
            for name, column in zip(names, columns, strict=True)
        }
        self._derivative = Differentiation(self._graph, self._directions)
        rows = [tree.sums.row(i) for i in self._n]
        self._rates_of_variables = [self._weighted(row, self._qdot) for row in rows]
        known = {name: self._weighted(row, self._q) for name, row in zip(names, rows, strict=True)}
        self._tree_node = Translation(self._graph, known)

    def _weighted(self, weights: Sequence[sp.Expr], nodes: Sequence[Node]) -> Node:
        pairs = zip(nodes, weights, strict=True)
        return self._graph.sum([(node, fraction(x)) for node, x in pairs if x])

    def _to_variables(self, forces: Sequence[Node]) -> Vector:
        """Generalized forces of the variables."""
        return [self._weighted(self._tree.differences.col(i), forces) for i in self._n]

    def _to_coordinates(self, changes: Sequence[Node]) -> Vector:
        """Changes of the coordinates."""
        return [self._weighted(self._tree.differences.row(i), changes) for i in self._n]

    @cached_property
    def _tangents(self) -> dict[tuple[int, int], Vector]:
        """∂d_k/∂φ_i of each branch k."""
        return {
            (k, i): [*map(self._tree_node, self._tree.tangent(k, i))]
            for k, branch in enumerate(self._tree.branches)
            for i in branch.variables
        }

    @cached_property
    def _products(self) -> dict[tuple[int, int, int], Node]:
        return {
            (k, i, j): self._tree_node(self._tree.dot(k, i, j))
            for k, branch in enumerate(self._tree.branches)
            for i in branch.variables
            for j in branch.variables
            if i <= j
        }

    @property
    def _inertial_nodes(self) -> Sequence[Node]:
        return [*(x for E in self._tangents.values() for x in E), *self._products.values()]

    def _moved_ends(self, changes: Sequence[Node], bias: Sequence[Vector] = ()) -> list[Vector]:
        """Σ E_i x_i along the branches to each end, and the sum of `bias`."""
        ends: list[Vector] = []
        for k, branch in enumerate(self._tree.branches):
            terms = [[e * changes[i] for e in self._tangents[k, i]] for i in branch.variables]
            terms += [bias[k]] if bias else []
            terms += [ends[branch.parent]] if branch.parent is not None else []
            sums = (self._graph.sum([(x, 1) for x in own]) for own in zip(*terms, strict=True))
            ends.append([self._graph.let(x) for x in sums])
        return ends

    @cached_property
    def _bias(self) -> list[Vector]:
        """Second rates of the increments at constant rates of the variables."""
        v, biases = self._rates_of_variables, []
        for k, branch in enumerate(self._tree.branches):
            changes = [
                [self._derivative(e, self._along[j]) * v[i] * v[j] for e in self._tangents[k, i]]
                for i in branch.variables
                for j in branch.variables
            ]
            rows = zip(*changes, strict=True)
            biases.append([self._graph.sum([(x, 1) for x in row]) for row in rows])
        return biases

    def _inertial_forces(self, accelerations: Sequence[Node]) -> Vector:
        """Σ m E·a of each variable, with the masses and accelerations a beyond its branches."""
        graph, branches = self._graph, self._tree.branches
        ends = self._moved_ends(accelerations, self._bias)
        forces: list[list[list[tuple[Node, int]]]] = []
        for branch, end in zip(branches, ends, strict=True):
            inertia = self._node(branch.inertia)
            forces.append([[(inertia * a, 1)] for a in end])
        terms: list[list[tuple[Node, int]]] = [[] for _ in self._n]
        for k in reversed(range(len(branches))):
            total = [graph.let(graph.sum(own)) for own in forces[k]]
            for i in branches[k].variables:
                terms[i] += [(e * f, 1) for e, f in zip(self._tangents[k, i], total, strict=True)]
            parent = branches[k].parent
            if parent is not None:
                for own, f in zip(forces[parent], total, strict=True):
                    own.append((f, 1))
        return [graph.sum(own) for own in terms]

    def _imbalances(self, accelerations: Sequence[Node]) -> Vector:
        """M φ̈ - f of each variable."""
        inertial, applied = self._inertial_forces(accelerations), self._to_variables(self._applied)
        return [
            self._graph.sum([(a, 1), (self._derivative(self._potential, name), 1), (b, -1)])
            for a, b, name in zip(inertial, applied, self._along, strict=True)
        ]

    def _of_coordinates(self, forces: Sequence[Node]) -> Vector:
        """Generalized forces of the coordinates, from those of the variables."""
        return [self._weighted(self._tree.sums.col(i), forces) for i in self._n]

    def _required(self, accelerations: Sequence[Node]) -> Vector:
        rows = (self._tree.sums.row(i) for i in self._n)
        of_variables = [self._weighted(row, accelerations) for row in rows]
        return self._of_coordinates(self._imbalances(of_variables))

    @property
    def coriolis(self) -> Vector:
        """Inertial forces without accelerations."""
        still = [self._graph.zero for _ in self._n]
        return self._of_coordinates(self._inertial_forces(still))

    @cached_property
    def _forcing(self) -> Vector:
        still = [self._graph.zero for _ in self._n]
        return [-one for one in self._imbalances(still)]

    def _rate(self, node: Node) -> Node:
        pairs = zip(self._along, self._rates_of_variables, strict=True)
        return self._graph.sum([(self._derivative(node, name) * v, 1) for name, v in pairs])

    @cached_property
    def _constraint_jacobian(self) -> list[Vector]:
        rates = self._constraint_rates
        return [[self._derivative(rate, name) for name in self._along_rates] for rate in rates]

    @cached_property
    def _constrained(self) -> "_InCoordinates":
        inertia = [self._node(one) for one in self._tree.inertia_beyond]
        mass_matrix = TreeFactorisation(
            self._graph, self._tree, inertia, self._tangents, self._products
        )
        return _InCoordinates(
            self._graph, mass_matrix, self._constraint_jacobian, self._to_coordinates
        )

    @cached_property
    def _solution_of_variables(self) -> tuple[Vector, Vector]:
        """φ̈ and λ."""
        return self._constrained.of_variables(self._forcing, self._constraint_forcing)

    @cached_property
    def _solution(self) -> tuple[Vector, Vector]:
        accelerations, multipliers = self._solution_of_variables
        return self._to_coordinates(accelerations), multipliers

    @property
    def energy(self) -> Vector:
        """½ Σ m v·v + V."""
        ends = self._moved_ends(self._rates_of_variables)
        terms = [(self._potential, Fraction(1))]
        for branch, end in zip(self._tree.branches, ends, strict=True):
            inertia = self._node(branch.inertia)
            terms += [(inertia * v * v, HALF) for v in end]
        return [self._graph.sum(terms)]

    @cached_property
    def _at_solution(self) -> Callable[[Node], Node]:
        """The replacement of φ̈ and λ, as leaves, by their values."""
        accelerations, multipliers = self._solution_of_variables
        solution = zip(self._unknowns, [*accelerations, *multipliers], strict=True)
        return substitution(self._graph, dict(solution))

    @cached_property
    def _unknowns(self) -> list[str]:
        rates = [f"rate of {name}" for name in self._along_rates]
        return [*rates, *(f"multiplier {one.name}" for one in self._system.conditions)]

    @cached_property
    def _residuals(self) -> tuple[Vector, Vector]:
        """The residuals f + Gᵀ λ - M φ̈ and γ - G φ̈ as functions of φ̈ and λ."""
        leaves, G = [self._graph.leaf(name) for name in self._unknowns], self._constraint_jacobian
        x, multipliers = leaves[: len(self._along)], leaves[len(self._along) :]
        reactions = (
            [(row[i] * one, 1) for row, one in zip(G, multipliers, strict=True)] for i in self._n
        )
        balances = zip(self._imbalances(x), reactions, strict=True)
        conditions = (
            [(a * b, -1) for a, b in zip(row, x, strict=True)] + [(gamma, 1)]
            for row, gamma in zip(G, self._constraint_forcing, strict=True)
        )
        return (
            [self._graph.sum([(one, -1), *terms]) for one, terms in balances],
            [self._graph.sum(terms) for terms in conditions],
        )

    def _imbalance(self, i: int, variable: sp.Symbol) -> Node:
        return self._at_solution(self._derivative(self._residuals[0][i], variable.name))

    def _constraint_imbalance(self, k: int, variable: sp.Symbol) -> Node:
        return self._at_solution(self._derivative(self._residuals[1][k], variable.name))


class _InCoordinates(ConstrainedFactorisation):
    """The factorisation in variables, with solutions in coordinates."""

    def __init__(
        self,
        graph: Graph,
        inertia: TreeFactorisation,
        constraints: Rows,
        to_coordinates: Callable[[Sequence[Node]], Vector],
    ) -> None:
        super().__init__(graph, inertia, constraints)
        self._to_coordinates = to_coordinates

    def of_variables(self, forces: Sequence[Node], rates: Sequence[Node]) -> tuple[Vector, Vector]:
        """The solution as changes of the variables, and the multipliers."""
        return super().solve(forces, rates)

    def solve(self, forces: Sequence[Node], rates: Sequence[Node]) -> tuple[Vector, Vector]:
        changes, multipliers = self.of_variables(forces, rates)
        return self._to_coordinates(changes), multipliers
