"""Lagrange's form, M q̈ = f, its rational form and its variational equations."""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cached_property

import sympy as sp

from derive.codegen.expression_graph.node import Node
from derive.codegen.expression_graph.rational import rationalised, substitution
from derive.codegen.expression_graph.sympy_translation import Translation
from derive.codegen.forms.equations_of_motion import EquationsOfMotion
from derive.system.prescribed import prescribed_symbols
from derive.system.symbols import TIME

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
    def switches_variational(self) -> list[Node]:
        """Switching functions, their rates of change, and the perturbations of both."""
        return self._perturbed_switches(self._changes)

    @property
    def switches_sensitivity(self) -> list[Node]:
        """The same with perturbed parameters."""
        return self._perturbed_switches(self._all_changes)

    def _perturbed_switches(self, changes: Mapping[sp.Symbol, Node]) -> list[Node]:
        values, rates, tangent = self.switches, self._state_rates, self._tangent(changes)
        functions = values[: len(values) // 2]
        perturbed = [self._change(value, changes) for value in functions]
        for value in functions:
            slopes = {s: self._derivative(value, s.name) for s in rates}
            terms = [(self._change(slope, changes) * rates[s], 1) for s, slope in slopes.items()]
            perturbed.append(self._graph.sum([*terms, (self._change(value, tangent), 1)]))
        return rationalised([*values, *perturbed], [q.name for q in self.angles])

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

    @property
    def jacobian(self) -> list[Node]:
        """Rows of ∂(q̇, q̈)/∂(q, q̇)."""
        return self._derivatives((*self._system.q, *self._system.qdot))

    @property
    def input_jacobian(self) -> list[Node]:
        """Rows of ∂(q̇, q̈)/∂u."""
        return self._derivatives(self._system.u)

    @property
    def parameter_jacobian(self) -> list[Node]:
        """Rows of ∂(q̇, q̈)/∂(parameters, without inputs)."""
        return self._derivatives([part.symbol for part in self._system.parameters])

    def _derivatives(self, variables: Sequence[sp.Symbol]) -> list[Node]:
        """Rows of ∂(q̇, q̈)/∂variables: M ∂q̈ = ∂f - ∂M q̈."""
        columns = [
            self._constrained.solve(
                [self._imbalance(i, variable) for i in self._n],
                [self._constraint_imbalance(k, variable) for k in self._constraints],
            )[0]
            for variable in variables
        ]
        upper = (
            self._graph.node(int(variable is velocity))
            for velocity in self._system.qdot
            for variable in variables
        )
        return [*upper, *(column[i] for i in self._n for column in columns)]

    def _imbalance(self, i: int, variable: sp.Symbol) -> Node:
        """(∂f - ∂M q̈ + ∂Gᵀ λ)_i by a variable.

        A common factor F of f_i, M_ij and G_ji stays as it is, since (f - M q̈ + Gᵀ λ)_i ∂F is 0.
        """
        factor = self._row_factors[i]
        by_force, *others = (
            self._derivative(entry / factor, variable.name) for entry in self._row(i)
        )
        products = [*((x, -1) for x in self._accelerations), *((x, 1) for x in self._multipliers)]
        pairs = zip(others, products, strict=True)
        return factor * self._graph.sum([(by_force, 1), *((a * x, sign) for a, (x, sign) in pairs)])

    def _row(self, i: int) -> list[Node]:
        """The entries f_i, M_ij and G_ji of equation i."""
        columns = (row[i] for row in self._constraint_jacobian)
        return [self._forcing[i], *(self._inertia[i][j] for j in self._n), *columns]

    @property
    def _constraints(self) -> range:
        return range(len(self._system.conditions))

    def _constraint_imbalance(self, k: int, variable: sp.Symbol) -> Node:
        """(∂γ - ∂G q̈)_k by a variable."""
        pairs = zip(self._constraint_jacobian[k], self._accelerations, strict=True)
        terms = [(self._derivative(entry, variable.name) * x, -1) for entry, x in pairs]
        change = self._derivative(self._constraint_forcing[k], variable.name)
        return self._graph.sum([(change, 1), *terms])

    @cached_property
    def _row_factors(self) -> list[Node]:
        """The common factor of f_i, row i of M and column i of G."""
        return [self._graph.common_factor(self._row(i)) for i in self._n]

    @property
    def rhs_variational(self) -> list[Node]:
        """`rhs_rational` of the motion, then δq̇ and δq̈ = M⁻¹ (δf - δM q̈)."""
        return self._with_perturbation(self._changes)

    @property
    def rhs_sensitivity(self) -> list[Node]:
        """The same with perturbed parameters."""
        return self._with_perturbation(self._all_changes)

    def _with_perturbation(self, changes: Mapping[sp.Symbol, Node]) -> list[Node]:
        tangent = self._tangent(changes).values()
        return rationalised([*self._rational_rates, *tangent], [q.name for q in self.angles])

    @property
    def _changes(self) -> dict[sp.Symbol, Node]:
        """The perturbation of each component of the state."""
        state = (*self._system.q, *self._system.qdot)
        return dict(zip(state, self._nodes(self._system.variations), strict=True))

    @property
    def _all_changes(self) -> dict[sp.Symbol, Node]:
        """The same, and of each parameter."""
        changes = self._nodes(self._system.parameter_variations)
        return self._changes | dict(zip(self._system.params, changes, strict=True))

    def _tangent(self, changes: Mapping[sp.Symbol, Node]) -> dict[sp.Symbol, Node]:
        """The rates of change of the perturbation, δq̇ and δq̈."""
        q, qdot = self._system.q, self._system.qdot
        imbalances, conditions = (
            [self._graph.sum([(of(i, s) * x, 1) for s, x in changes.items()]) for i in rows]
            for of, rows in (
                (self._imbalance, self._n),
                (self._constraint_imbalance, self._constraints),
            )
        )
        solution, _ = self._constrained.solve(imbalances, conditions)
        tangent = [*(changes[s] for s in qdot), *solution]
        return dict(zip((*q, *qdot), tangent, strict=True))
