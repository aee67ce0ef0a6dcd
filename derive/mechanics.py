"""The equations of motion as operations: here each form gets its shape.

Nothing is inverted and nothing is simplified. The Lagrangian form solves
M q̈ = f; the Hamiltonian form solves M w = p and has q̇ = w and
ṗ = ½ wᵀ (∂M/∂q) w - ∂V/∂q. Their Jacobians reuse the same factorisation,
from ∂(M⁻¹ b) = M⁻¹ (∂b - ∂M M⁻¹ b).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property

import sympy as sp

from derive.derivation import Derivation
from derive.factorisation import Factorisation
from derive.graph import Graph, Node
from derive.rational import angles, rationalised
from derive.translation import Translation

HALF = Fraction(1, 2)


class Mechanics:
    """The outputs of every generated function, as nodes of one graph.

    Each method returns its outputs flat, in C order of the shape that
    `derive.functions` gives them.
    """

    def __init__(self, derivation: Derivation) -> None:
        self._derivation, self._system = derivation, derivation.system
        self._graph = Graph()
        self._node = Translation(self._graph)
        self._n = range(len(self._system.q))
        self._qdot, self._p = self._nodes(self._system.qdot), self._nodes(self._system.p)

    def _nodes(self, expressions: Sequence[sp.Expr] | sp.Matrix) -> list[Node]:
        return [self._node(expression) for expression in expressions]

    def _rows(self, matrix: sp.Matrix) -> list[list[Node]]:
        return [self._nodes(matrix.row(i)) for i in range(matrix.rows)]

    @cached_property
    def _factorisation(self) -> Factorisation:
        return Factorisation(self._graph, self._rows(self._derivation.mass_matrix))

    def _product(self, matrix: sp.Matrix, vector: Sequence[Node]) -> list[Node]:
        return [
            self._graph.sum([(a * b, 1) for a, b in zip(row, vector, strict=True)])
            for row in self._rows(matrix)
        ]

    def _bilinear(self, matrix: sp.Matrix, v: Sequence[Node], w: Sequence[Node]) -> Node:
        # a symmetric matrix, both halves together: v_i w_j + v_j w_i are one term if v is w
        rows = self._rows(matrix)
        return self._graph.sum([(rows[i][j] * v[i] * w[j], 1) for i in self._n for j in self._n])

    def _mass_gradient(self, q: sp.Symbol) -> sp.Matrix:
        return self._derivation.mass_matrix.diff(q)

    @property
    def mass_matrix(self) -> list[Node]:
        """M."""
        return self._nodes(self._derivation.mass_matrix)

    @property
    def positions(self) -> list[Node]:
        """R of every mass, one after the other."""
        return self._nodes([r for mass in self._system.masses for r in mass.position])

    @property
    def energy(self) -> list[Node]:
        """T + V of (q, q̇)."""
        return [self._node(self._derivation.energy)]

    @property
    def energy_hamiltonian(self) -> list[Node]:
        """H = ½ pᵀ w + V with M w = p."""
        w = self._factorisation.solve(self._p)
        kinetic = [(p * w, HALF) for p, w in zip(self._p, w, strict=True)]
        return [self._graph.sum([*kinetic, (self._node(self._derivation.potential_energy), 1)])]

    @property
    def hamiltonian_state(self) -> list[Node]:
        """Q and p = M q̇."""
        return [*self._nodes(self._system.q), *self._nodes(self._derivation.momenta)]

    @property
    def lagrangian_state(self) -> list[Node]:
        """Q and q̇ of M q̇ = p."""
        return [*self._nodes(self._system.q), *self._factorisation.solve(self._p)]

    @cached_property
    def _accelerations(self) -> list[Node]:
        return self._factorisation.solve(self._nodes(self._derivation.forcing))

    @property
    def rhs(self) -> list[Node]:
        """Q̇ and q̈ of M q̈ = f."""
        return [*self._qdot, *self._accelerations]

    @cached_property
    def angles(self) -> tuple[sp.Symbol, ...]:
        """Coordinates that the equations of motion know through sine and cosine only."""
        names = angles(self._accelerations, [q.name for q in self._system.q])
        return tuple(q for q in self._system.q if q.name in names)

    @property
    def _rational_rates(self) -> list[Node]:
        rates: list[Node] = []
        for q, qdot in zip(self._system.q, self._qdot, strict=True):
            sine, cosine = self._node(sp.sin(q)), self._node(sp.cos(q))
            rates += [cosine * qdot, -sine * qdot] if q in self.angles else [qdot]
        return [*rates, *self._accelerations]

    @property
    def rhs_rational(self) -> list[Node]:
        """(cos q, -sin q) q̇ for every angle, q̇ for other coordinates, and q̈."""
        return rationalised(self._rational_rates, [q.name for q in self.angles])

    @property
    def rational_state(self) -> list[Node]:
        """(sin q, cos q) for every angle, other coordinates, and q̇."""
        places: list[sp.Expr] = []
        for q in self._system.q:
            places += [sp.sin(q), sp.cos(q)] if q in self.angles else [q]
        return [*self._nodes(places), *self._qdot]

    @property
    def jacobian(self) -> list[Node]:
        """Rows of ∂(q̇, q̈)/∂(q, q̇)."""
        q, qdot, forcing = self._system.q, self._system.qdot, self._derivation.forcing
        columns = []
        for variable in (*q, *qdot):
            change = self._nodes(forcing.diff(variable))
            shift = self._product(self._mass_gradient(variable), self._accelerations)
            columns.append(
                self._factorisation.solve([a - b for a, b in zip(change, shift, strict=True)])
            )
        return [
            *(
                self._graph.node(int(variable is velocity))
                for velocity in qdot
                for variable in (*q, *qdot)
            ),
            *(column[i] for i in self._n for column in columns),
        ]

    @property
    def rhs_hamiltonian(self) -> list[Node]:
        """Q̇ = w and ṗ = ½ wᵀ (∂M/∂q) w - ∂V/∂q."""
        w = self._factorisation.solve(self._p)
        potential = self._derivation.potential_energy
        return [
            *w,
            *(
                self._graph.sum(
                    [
                        (self._bilinear(self._mass_gradient(q), w, w), HALF),
                        (self._node(potential.diff(q)), -1),
                    ]
                )
                for q in self._system.q
            ),
        ]

    @property
    def jacobian_hamiltonian(self) -> list[Node]:
        """Rows of ∂(q̇, ṗ)/∂(q, p): both halves come from ∂w, since ∂ṗ/∂p = -(∂q̇/∂q)ᵀ."""
        q = self._system.q
        w = self._factorisation.solve(self._p)
        potential = self._derivation.potential_energy
        by_p = [
            self._factorisation.solve([self._graph.node(int(i == k)) for i in self._n])
            for k in self._n
        ]
        gradients = [self._mass_gradient(qk) for qk in q]
        by_q = [
            self._factorisation.solve([-node for node in self._product(gradient, w)])
            for gradient in gradients
        ]
        upper = [[column[i] for column in (*by_q, *by_p)] for i in self._n]
        lower = [
            [
                self._graph.sum(
                    [
                        (self._bilinear(gradients[i].diff(q[k]), w, w), HALF),
                        (self._bilinear(gradients[i], w, by_q[k]), 1),
                        (self._node(potential.diff(q[i], q[k])), -1),
                    ]
                )
                for k in self._n
            ]
            + [-by_q[i][k] for k in self._n]
            for i in self._n
        ]
        return [node for row in (*upper, *lower) for node in row]

    @property
    def rhs_variational(self) -> list[Node]:
        """`rhs_rational` of the motion, then δq̇ and δq̈ = M⁻¹ (δf - δM q̈)."""
        q, qdot, forcing = self._system.q, self._system.qdot, self._derivation.forcing
        changes = dict(zip((*q, *qdot), self._nodes(self._system.variations), strict=True))
        shifts = {s: self._product(self._mass_gradient(s), self._accelerations) for s in q}
        change_of_forcing = [
            self._graph.sum([
                *((self._node(forcing[i].diff(s)) * change, 1) for s, change in changes.items()),
                *((shift[i] * changes[s], -1) for s, shift in shifts.items()),
            ])
            for i in self._n
        ]  # fmt: skip
        tangent = [*(changes[s] for s in qdot), *self._factorisation.solve(change_of_forcing)]
        return rationalised([*self._rational_rates, *tangent], [q.name for q in self.angles])

    @property
    def equilibrium(self) -> list[Node]:
        """Q₀."""
        return self._nodes(self._derivation.linearisation().equilibrium)

    @property
    def linear(self) -> list[Node]:
        """M₀, then K."""
        linearisation = self._derivation.linearisation()
        return self._nodes([*linearisation.mass_matrix, *linearisation.stiffness_matrix])
