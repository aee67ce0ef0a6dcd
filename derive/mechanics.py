"""The equations of motion as operations: here each form gets its shape.

Nothing is inverted and nothing is simplified. The Lagrangian form solves
M q̈ = f; the Hamiltonian form solves M w = p - b and has q̇ = w and
ṗ = ½ vᵀ (∂M̄/∂q) v - ∂V/∂q + Q. Derivatives are taken of nodes, and those of
the solutions reuse the factorisation, from ∂(M⁻¹ b) = M⁻¹ (∂b - ∂M M⁻¹ b).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property

import sympy as sp

from derive.derivation import Derivation
from derive.differentiation import Differentiation
from derive.factorisation import Solver, factorisation
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
    def _factorisation(self) -> Solver:
        return factorisation(self._graph, [[self._inertia[i][j] for j in self._n] for i in self._n])

    def _rates(self, velocities: Sequence[Node]) -> list[Node]:
        """Rates of all variables where those of the coordinates are `velocities`."""
        return [*velocities, *self._nodes(self._derivation.rates[len(velocities) :])]

    @property
    def mass_matrix(self) -> list[Node]:
        """M."""
        return [self._inertia[i][j] for i in self._n for j in self._n]

    @property
    def positions(self) -> list[Node]:
        """R of every mass, one after the other."""
        return self._nodes([r for mass in self._system.masses for r in mass.position])

    @property
    def energy(self) -> list[Node]:
        """½ q̇ᵀ M q̇ + U of (q, q̇)."""
        return [self._node(self._derivation.energy)]

    @property
    def power(self) -> list[Node]:
        """The rate of the energy."""
        return [self._node(self._derivation.power)]

    @cached_property
    def _moving(self) -> list[Node]:
        """P - b, the momenta of what the coordinates move; then M w is this."""
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
    def hamiltonian_state(self) -> list[Node]:
        """Q and p = M q̇ + b."""
        return [*self._q, *self._nodes(self._derivation.momenta)]

    @property
    def lagrangian_state(self) -> list[Node]:
        """Q and q̇ of M q̇ = p - b."""
        return [*self._q, *self._velocities]

    @cached_property
    def _forcing(self) -> list[Node]:
        v = self._rates(self._qdot)
        return [
            self._graph.sum(
                [
                    (self._inertial(i, v), -1),
                    (self._derivative(self._potential, q.name), -1),
                    (self._applied[i], 1),
                ]
            )
            for i, q in enumerate(self._system.q)
        ]

    def _inertial(self, i: int, v: Sequence[Node]) -> Node:
        """Σ (∂M̄_ij/∂q_k - ½ ∂M̄_jk/∂q_i) v_j v_k of the variable i."""
        names, slope = self._variables, self._derivative
        terms = [
            (slope(self._inertia[j][k], names[i]) * v[j] * v[k], -HALF)
            for j, k in self._dependent[i]
        ]
        terms += [
            (slope(entry, names[k]) * v[j] * v[k], Fraction(1))
            for j, entry in enumerate(self._inertia[i])
            for k in self._known_by[entry]
        ]
        return self._graph.sum(terms)

    @cached_property
    def _known_by(self) -> dict[Node, list[int]]:
        """Which variables an entry of M̄ depends on: of a long chain's entries two."""
        return {
            entry: [k for k, name in enumerate(self._variables)
                    if name in self._derivative.leaves(entry)]
            for row in self._inertia for entry in row
        }  # fmt: skip

    @cached_property
    def _dependent(self) -> list[list[tuple[int, int]]]:
        """Which entries of M̄ depend on each variable."""
        found: list[list[tuple[int, int]]] = [[] for _ in self._variables]
        for j, row in enumerate(self._inertia):
            for k, entry in enumerate(row):
                for variable in self._known_by[entry]:
                    found[variable].append((j, k))
        return found

    @cached_property
    def _accelerations(self) -> list[Node]:
        return self._factorisation.solve(self._forcing)

    @property
    def rhs(self) -> list[Node]:
        """Q̇ and q̈ of M q̈ = f."""
        return [*self._qdot, *self._accelerations]

    @property
    def reactions(self) -> list[Node]:
        """-(M̄ q̈ + Σ Γ v v + ∂V/∂l) of every length l that is held."""
        v = self._rates(self._qdot)
        first = len(self._variables) - len(self._system.reactions)
        return [
            self._graph.sum(
                [
                    *((self._inertia[i][j] * self._accelerations[j], -1) for j in self._n),
                    (self._inertial(i, v), -1),
                    (self._derivative(self._potential, self._variables[i]), -1),
                ]
            )
            for i in range(first, len(self._variables))
        ]

    @cached_property
    def angles(self) -> tuple[sp.Symbol, ...]:
        """Coordinates that energies and forces know through sine and cosine only.

        Or the positions, of one that energies and forces do not know.
        """
        felt = [*self._known_by, self._potential, *self._applied]
        names = self._only_as_angles(felt) | (
            self._only_as_angles(self.positions)
            - frozenset().union(*map(self._derivative.leaves, felt))
        )
        return tuple(q for q in self._system.q if q.name in names)

    def _only_as_angles(self, nodes: Sequence[Node]) -> frozenset[str]:
        known = frozenset().union(*map(self._derivative.leaves, nodes))
        return angles(nodes, known & {q.name for q in self._system.q})

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

    def _shifted(self, variable: sp.Symbol, vector: Sequence[Node]) -> list[Node]:
        """(∂M/∂variable) vector."""
        return [
            self._graph.sum(
                [(self._derivative(row[j], variable.name) * vector[j], 1) for j in self._n]
            )
            for row in self._inertia[: len(vector)]
        ]

    @property
    def jacobian(self) -> list[Node]:
        """Rows of ∂(q̇, q̈)/∂(q, q̇)."""
        columns = []
        for variable in (*self._system.q, *self._system.qdot):
            change = [self._derivative(force, variable.name) for force in self._forcing]
            shift = self._shifted(variable, self._accelerations)
            columns.append(
                self._factorisation.solve([a - b for a, b in zip(change, shift, strict=True)])
            )
        return [
            *(
                self._graph.node(int(variable is velocity))
                for velocity in self._system.qdot
                for variable in (*self._system.q, *self._system.qdot)
            ),
            *(column[i] for i in self._n for column in columns),
        ]

    @cached_property
    def _at_velocities(self) -> Translation:
        """Expressions of (q, q̇) in the Hamiltonian form, where q̇ is w."""
        names = (qdot.name for qdot in self._system.qdot)
        return Translation(self._graph, dict(zip(names, self._velocities, strict=True)))

    @property
    def rhs_hamiltonian(self) -> list[Node]:
        """Q̇ = w and ṗ = ½ vᵀ (∂M̄/∂q) v - ∂V/∂q + Q."""
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

    @property
    def rhs_variational(self) -> list[Node]:
        """`rhs_rational` of the motion, then δq̇ and δq̈ = M⁻¹ (δf - δM q̈)."""
        q, qdot = self._system.q, self._system.qdot
        changes = dict(zip((*q, *qdot), self._nodes(self._system.variations), strict=True))
        shifts = {s: self._shifted(s, self._accelerations) for s in q}
        change_of_forcing = [
            self._graph.sum([
                *((self._derivative(self._forcing[i], s.name) * change, 1)
                  for s, change in changes.items()),
                *((shift[i] * changes[s], -1) for s, shift in shifts.items()),
            ])
            for i in self._n
        ]  # fmt: skip
        tangent = [*(changes[s] for s in qdot), *self._factorisation.solve(change_of_forcing)]
        return rationalised([*self._rational_rates, *tangent], [q.name for q in self.angles])

    @property
    def equilibrium(self) -> list[Node]:
        """Q₀."""
        return self._nodes(self._derivation.rest or ())

    @property
    def linear(self) -> list[Node]:
        """M₀, then K."""
        linearisation = self._derivation.linearisation()
        return self._nodes([*linearisation.mass_matrix, *linearisation.stiffness_matrix])
