"""Lagrange's form, M q̈ = f, its rational form and its variational equations."""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cached_property

import sympy as sp

from derive.codegen.expression_graph.node import Node
from derive.codegen.expression_graph.rational import rationalised, substitution
from derive.codegen.expression_graph.sympy_translation import Translation
from derive.codegen.forms.equations_of_motion import EquationsOfMotion
from derive.system.symbols import TIME, prescribed_symbols

HALF = Fraction(1, 2)


class LagrangianForm(EquationsOfMotion):
    """Derivatives of (q, q̇), of (sin q, cos q, q̇), and of linear perturbations of these."""

    @cached_property
    def _forcing(self) -> list[Node]:
        v, forces = self._rates(self._qdot), []
        for i, q in enumerate(self._system.q):
            inertial, gradient = self._inertial(i, v), self._derivative(self._potential, q.name)
            forces.append(self._graph.sum([(inertial, -1), (gradient, -1), (self._applied[i], 1)]))
        return forces

    def _inertial(self, i: int, v: Sequence[Node]) -> Node:
        """Σ (∂M̄_ij/∂q_k - ½ ∂M̄_jk/∂q_i) v_j v_k of the variable i."""
        names, derivative = self._variables, self._derivative
        terms = [
            (derivative(self._inertia[j][k], names[i]) * v[j] * v[k], -HALF)
            for j, k in self._dependent[i]
        ]
        terms += [
            (derivative(entry, names[k]) * v[j] * v[k], Fraction(1))
            for j, entry in enumerate(self._inertia[i])
            for k in self._dependencies[entry]
        ]
        return self._graph.sum(terms)

    @property
    def inverse_dynamics(self) -> list[Node]:
        """M q̈ - f where inputs are 0, but for those of prescribed motions."""
        prescribed = prescribed_symbols(self._system.inputs)
        names = [u.name for u in self._system.u if u not in prescribed]
        without_inputs = substitution(self._graph, dict.fromkeys(names, self._graph.zero))
        return [without_inputs(one) for one in self._required(self._nodes(self._system.qddot))]

    def _required(self, accelerations: Sequence[Node]) -> list[Node]:
        """M q̈ - f."""
        products = ([(self._inertia[i][j] * accelerations[j], 1) for j in self._n] for i in self._n)
        pairs = zip(products, self._forcing, strict=True)
        return [self._graph.sum([*terms, (f, -1)]) for terms, f in pairs]

    @property
    def coriolis(self) -> list[Node]:
        """Σ Γ_ijk v_j v_k, with v the rates of coordinates, time and prescribed motions."""
        v = self._rates(self._qdot)
        return [self._inertial(i, v) for i in self._n]

    @property
    def gravity(self) -> list[Node]:
        """∂V/∂q."""
        return [self._derivative(self._potential, q.name) for q in self._system.q]

    @cached_property
    def _dependent(self) -> list[list[tuple[int, int]]]:
        """The entries of M̄ that depend on each variable."""
        entries: list[list[tuple[int, int]]] = [[] for _ in self._variables]
        for j, row in enumerate(self._inertia):
            for k, entry in enumerate(row):
                for variable in self._dependencies[entry]:
                    entries[variable].append((j, k))
        return entries

    @cached_property
    def _constraint_forcing(self) -> list[Node]:
        """γ of G q̈ = γ."""
        return [-self._rate(rate) for rate in self._constraint_rates]

    @cached_property
    def _solution(self) -> tuple[list[Node], list[Node]]:
        return self._constrained.solve(self._forcing, self._constraint_forcing)

    @property
    def _accelerations(self) -> list[Node]:
        return self._solution[0]

    @property
    def _multipliers(self) -> list[Node]:
        """λ of M q̈ = f + Gᵀ λ."""
        return self._solution[1]

    @property
    def multipliers(self) -> list[Node]:
        """The same, and those of eliminated constraints."""
        symbols = (*self._system.qddot, *self._system.multipliers)
        values = zip(symbols, [*self._accelerations, *self._multipliers], strict=True)
        known = {symbol.name: value for symbol, value in values}
        known |= {one.name: self._graph.zero for one in self._derivation.redundant}
        node = Translation(self._graph, known, self._derivation.switching_functions)
        known |= {one.constraint.name: node(one.reaction) for one in self._system.eliminated}
        return [known[one.name] for one in self._system.all_conditions]

    @property
    def constraints(self) -> list[Node]:
        """Constraints φ of the coordinates, then G q̇ + b of all."""
        return [*self._nodes(self._derivation.holonomic), *self._constraint_rates]

    @property
    def constraints_jacobian(self) -> list[Node]:
        """Rows of derivatives of `constraints` with respect to (q, q̇)."""
        names = [s.name for s in (*self._system.q, *self._system.qdot)]
        return [self._derivative(one, name) for one in self.constraints for name in names]

    @property
    def integrals(self) -> list[Node]:
        """Functions of coordinates and time that constraints of velocities keep constant."""
        return self._nodes(self._derivation.integrals)

    @property
    def integrals_rational(self) -> list[Node]:
        """The same as functions of the rational state."""
        return rationalised(self.integrals, [q.name for q in self.angles])

    @property
    def redundant_constraints(self) -> list[Node]:
        """Constraints that follow from the others."""
        return self._nodes([one.formula for one in self._derivation.redundant])

    @property
    def power(self) -> list[Node]:
        """The rate of the energy, with the power -λ·b of constraints that move."""
        if not any(self._derivation.constraint_drift):
            return super().power
        drift = self._nodes(self._derivation.constraint_drift)
        moved = ((reaction * b, -1) for reaction, b in zip(self._multipliers, drift, strict=True))
        return [self._graph.sum([(self._node(self._derivation.power), 1), *moved])]

    @property
    def rhs(self) -> list[Node]:
        """The rates q̇ and q̈ of M q̈ = f."""
        return [*self._qdot, *self._accelerations]

    @property
    def switches(self) -> list[Node]:
        """Switching functions, then their rates of change along the motion."""
        values = self._nodes(self._derivation.switching_functions)
        return [*values, *(self._change(value, self._state_rates) for value in values)]

    @property
    def _state_rates(self) -> dict[sp.Symbol, Node]:
        """The rates of change of the state and of time."""
        rates = [*self._qdot, *self._accelerations, self._graph.one]
        return dict(zip((*self._system.q, *self._system.qdot, TIME), rates, strict=True))

    def _change(self, value: Node, changes: Mapping[sp.Symbol, Node]) -> Node:
        """The change of a function of the state by small changes of its components."""
        terms = ((self._derivative(value, s.name) * change, 1) for s, change in changes.items())
        return self._graph.sum(terms)

    @property
    def switches_rational(self) -> list[Node]:
        """Switching functions of the rational state, then their rates of change."""
        return rationalised(self.switches, [q.name for q in self.angles])

    @property
    def reactions(self) -> list[Node]:
        """-(M̄ q̈ + Σ Γ v v + ∂V/∂l) of every constant length l."""
        v, forces = self._rates(self._qdot), []
        for i in range(len(v) - len(self._system.reactions), len(v)):
            terms = [(self._inertia[i][j] * self._accelerations[j], -1) for j in self._n]
            terms.append((self._inertial(i, v), -1))
            terms.append((self._derivative(self._potential, self._variables[i]), -1))
            forces.append(self._graph.sum(terms))
        return forces

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
    def energy_rational(self) -> list[Node]:
        """The energy as a function of the rational state."""
        return rationalised(self.energy, [q.name for q in self.angles])
