"""Quantities common to all forms of the equations of motion, and outputs, as nodes of a graph.

Nodes are differentiated. Derivatives of solutions use the factorisation of the mass matrix:
∂(M⁻¹ b) = M⁻¹ (∂b - ∂M M⁻¹ b). Nothing is inverted or simplified.
"""

from collections.abc import Sequence
from functools import cached_property

import sympy as sp

from derive.codegen.expression_graph.differentiation import Differentiation
from derive.codegen.expression_graph.graph import Graph
from derive.codegen.expression_graph.node import Node
from derive.codegen.expression_graph.rational import angles
from derive.codegen.expression_graph.sympy_translation import Translation
from derive.codegen.forms.factorisation import (
    ConstrainedFactorisation,
    Factorisation,
    Loops,
    factorisation,
)
from derive.mechanics.derivation import Derivation
from derive.system.symbols import TIME


class EquationsOfMotion:
    """Energies, positions and states as outputs of generated functions.

    Each property has the name of a generated function in `derive.codegen.module_functions`, and
    gives the function's outputs, flat in C order.
    """

    def __init__(self, derivation: Derivation) -> None:
        self._derivation, self._system = derivation, derivation.system
        self._graph = Graph()
        self._node = Translation(self._graph, switching=derivation.switching_functions)
        self._derivative = Differentiation(self._graph)
        self._n = range(len(self._system.q))
        self._q, self._qdot, self._p = (
            self._nodes(symbols) for symbols in (self._system.q, self._system.qdot, self._system.p)
        )
        self._variables = [variable.name for variable in derivation.variables]

    def _nodes(self, expressions: Sequence[sp.Expr] | sp.Matrix) -> list[Node]:
        return [self._node(expression) for expression in expressions]

    @cached_property
    def _inertia(self) -> list[list[Node]]:
        matrix = self._derivation.inertia
        return [self._nodes(matrix.row(i)) for i in range(matrix.rows)]

    @cached_property
    def _potential(self) -> Node:
        return self._node(self._derivation.potential_energy)

    @cached_property
    def _applied(self) -> list[Node]:
        return self._nodes(self._system.applied)

    @cached_property
    def _factorisation(self) -> Loops | Factorisation:
        return factorisation(self._graph, [[self._inertia[i][j] for j in self._n] for i in self._n])

    @cached_property
    def _constraint_rates(self) -> list[Node]:
        """G q̇ + b: rates of constraints of coordinates, and constraints of velocities."""
        rates, holonomic = [], {*self._derivation.holonomic}
        for one in self._system.conditions:
            node = self._node(one.formula)
            rates.append(self._rate(node) if one.formula in holonomic else node)
        return rates

    def _rate(self, node: Node) -> Node:
        """The rate of a function at constant velocities."""
        pairs = zip(self._system.q, self._qdot, strict=True)
        terms = [(self._derivative(node, q.name) * v, 1) for q, v in pairs]
        return self._graph.sum([*terms, (self._derivative(node, TIME.name), 1)])

    @cached_property
    def _constraint_jacobian(self) -> list[list[Node]]:
        """G, one row a constraint."""
        names = [qdot.name for qdot in self._system.qdot]
        return [[self._derivative(rate, v) for v in names] for rate in self._constraint_rates]

    @cached_property
    def _constrained(self) -> ConstrainedFactorisation:
        inertia = [[self._inertia[i][j] for j in self._n] for i in self._n]
        singular = self._derivation.has_singular_mass_matrix
        return ConstrainedFactorisation.of_matrix(
            self._graph, inertia, self._constraint_jacobian, singular=singular
        )

    def _rates(self, velocities: Sequence[Node]) -> list[Node]:
        """Rates of all variables, given those of the coordinates."""
        return [*velocities, *self._nodes(self._derivation.rates[len(velocities) :])]

    @property
    def mass_matrix(self) -> list[Node]:
        """M."""
        return [self._inertia[i][j] for i in self._n for j in self._n]

    @property
    def regressor(self) -> list[Node]:
        """Y, row by row."""
        return self._nodes(self._derivation.regressor.matrix)

    @property
    def base_parameters(self) -> list[Node]:
        """π."""
        return self._nodes(self._derivation.regressor.parameters)

    @property
    def positions(self) -> list[Node]:
        """Positions r of all masses."""
        return self._nodes([r for mass in self._system.masses for r in mass.position])

    @property
    def points(self) -> list[Node]:
        """Positions of the points of links."""
        return self._nodes([r for point in self._system.points for r in point])

    @property
    def angular_momentum(self) -> list[Node]:
        """Σ m r × ṙ + R J ω about the origin."""
        return self._nodes(self._derivation.angular_momentum)

    @property
    def energy(self) -> list[Node]:
        """½ q̇ᵀ M q̇ + U of (q, q̇)."""
        return [self._node(self._derivation.energy)]

    @property
    def power(self) -> list[Node]:
        """The rate of the energy."""
        return [self._node(self._derivation.power)]

    @property
    def hamiltonian_state(self) -> list[Node]:
        """Coordinates q and momenta p = M q̇ + b."""
        return [*self._q, *self._nodes(self._derivation.momenta)]

    @cached_property
    def _dependencies(self) -> dict[Node, list[int]]:
        """The variables that an entry of M̄ depends on; in a long chain two."""
        leaves = {entry: self._derivative.leaves(entry) for row in self._inertia for entry in row}
        return {
            entry: [k for k, name in enumerate(self._variables) if name in names]
            for entry, names in leaves.items()
        }

    @property
    def _inertial_nodes(self) -> Sequence[Node]:
        """The nodes on which inertia depends."""
        return [*self._dependencies]

    @cached_property
    def angles(self) -> tuple[sp.Symbol, ...]:
        """Coordinates on which energies and forces depend only by sine and cosine.

        For a coordinate that does not occur in energies and forces, the positions decide.
        """
        formulas = [one.formula for one in self._system.conditions]
        conditions = self._nodes([*formulas, *self._derivation.integrals])
        dynamics = [*self._inertial_nodes, self._potential, *self._applied, *conditions]
        names = self._only_as_angles(dynamics)
        names |= self._only_as_angles(self.positions) - self._leaves(dynamics)
        return tuple(q for q in self._system.q if q.name in names)

    def _only_as_angles(self, nodes: Sequence[Node]) -> frozenset[str]:
        return angles(nodes, self._leaves(nodes) & {q.name for q in self._system.q})

    def _leaves(self, nodes: Sequence[Node]) -> frozenset[str]:
        return frozenset().union(*map(self._derivative.leaves, nodes))

    @property
    def rational_state(self) -> list[Node]:
        """(sin q, cos q) for every angle, other coordinates, and q̇."""
        positions: list[sp.Expr] = []
        for q in self._system.q:
            positions += [sp.sin(q), sp.cos(q)] if q in self.angles else [q]
        return [*self._nodes(positions), *self._qdot]

    @property
    def equilibrium(self) -> list[Node]:
        """Coordinates q₀ of the equilibrium."""
        return self._nodes(self._derivation.equilibrium or ())

    @property
    def linear(self) -> list[Node]:
        """M₀, then K."""
        linearisation = self._derivation.linearisation()
        return self._nodes([*linearisation.mass_matrix, *linearisation.stiffness_matrix])


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
