"""Steps onto the constraints, of motions and of their perturbations."""

from collections.abc import Mapping, Sequence
from functools import cached_property

import sympy as sp

from derive.codegen.expression_graph.node import Node
from derive.codegen.expression_graph.rational import rationalised
from derive.codegen.forms.factorisation import ConstrainedFactorisation
from derive.codegen.forms.jacobians import LagrangianJacobians


class ProjectionForm(LagrangianJacobians):
    """Changes of a state that remove residuals of constraints: the smallest by the mass matrix."""

    @cached_property
    def _position_residuals(self) -> list[Node]:
        """Residuals of the constraints of coordinates; 0 in the places of the others."""
        holonomic = {*self._derivation.holonomic}
        return [
            self._node(one.formula if one.formula in holonomic else sp.S.Zero)
            for one in self._system.conditions
        ]

    def _removing(self, residuals: Sequence[Node]) -> list[Node]:
        """The smallest x with G x = -residuals."""
        still = [self._graph.zero for _ in self._n]
        return self._constrained.solve(still, [-one for one in residuals])[0]

    @cached_property
    def _change_of_positions(self) -> list[Node]:
        """The smallest x that removes residuals of constraints of coordinates, and of integrals."""
        derivation, residuals = self._derivation, [*self._position_residuals]
        if not derivation.integrals:
            return self._removing(residuals)
        rows, conditions = [*self._constraint_jacobian], self._system.conditions
        formulas, values = derivation.velocity_constraints, self._nodes(derivation.integral_values)
        places = [k for k, one in enumerate(conditions) if one.formula in formulas]
        for (index, formula), value in zip(
            derivation.integrability.held.items(), values, strict=True
        ):
            f = self._node(formula)
            residuals[places[index]] = f - value
            rows[places[index]] = [self._derivative(f, q.name) for q in self._system.q]
        inertia = [[self._inertia[i][j] for j in self._n] for i in self._n]
        singular = derivation.has_singular_mass_matrix
        factorised = ConstrainedFactorisation.of_matrix(
            self._graph, inertia, rows, singular=singular
        )
        still = [self._graph.zero for _ in self._n]
        return factorised.solve(still, [-one for one in residuals])[0]

    def _moved(self, change: Sequence[Node]) -> dict[sp.Symbol, Node]:
        return dict(zip(self._system.q, change, strict=True))

    @cached_property
    def correction(self) -> list[Node]:
        """A step of Newton's method: changes of q, then of q̇, whose residuals change with q."""
        of_q = self._change_of_positions
        moved = self._moved(of_q)
        rates = [rate + self._change(rate, moved) for rate in self._constraint_rates]
        return [*of_q, *self._removing(rates)]

    @property
    def correction_rational(self) -> list[Node]:
        """The same as a function of the rational state; changes of angles stay as they are."""
        return rationalised(self.correction, [q.name for q in self.angles])

    @property
    def correction_variational(self) -> list[Node]:
        """The same, then the changes by which a perturbation becomes tangent to the constraints."""
        return self._with_tangent(self._changes)

    @property
    def correction_sensitivity(self) -> list[Node]:
        """The same with perturbed parameters."""
        return self._with_tangent(self._all_changes)

    def _with_tangent(self, changes: Mapping[sp.Symbol, Node]) -> list[Node]:
        of_q = self._removing([self._change(one, changes) for one in self._position_residuals])
        moved = {s: changes[s] + x for s, x in self._moved(of_q).items()}
        rates = [self._change(rate, {**changes, **moved}) for rate in self._constraint_rates]
        nodes = [*self.correction, *of_q, *self._removing(rates)]
        return rationalised(nodes, [q.name for q in self.angles])
