"""Jacobians of Lagrange's and of Hamilton's form, and motions with a linear perturbation."""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cached_property

import sympy as sp

from derive.codegen.expression_graph.node import Node, Terms
from derive.codegen.expression_graph.rational import rationalised
from derive.codegen.forms.hamiltonian_form import HamiltonianForm
from derive.codegen.forms.lagrangian_form import HALF, LagrangianForm


class LagrangianJacobians(LagrangianForm):
    """Derivatives of Lagrange's form by state, inputs and parameters, and perturbed motions."""

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


class HamiltonianJacobian(HamiltonianForm):
    """Derivatives of Hamilton's form by its state."""

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
