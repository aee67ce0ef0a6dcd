"""Constraints of coordinates and velocities, differentiated to those of accelerations."""

from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from derive.formulas.functions import derivative
from derive.mechanics.constraints.integrability import Integrability, integrability
from derive.mechanics.energies.kinetics import Kinetics, Matrix
from derive.mechanics.energies.reduction import collected
from derive.system.symbols import TIME


@dataclass(frozen=True)
class Constraints(Kinetics):
    """Conditions φ(q, t) = 0 and A(q, t) q̇ + b(q, t) = 0, as G q̈ = γ.

    A motion satisfies M q̈ = f + Gᵀ λ with the multipliers λ, the reactions of the constraints
    (C. Lanczos, The Variational Principles of Mechanics, chapter II.5). Conditions on velocities
    restrict no displacements, only their directions, so that they must not be used to remove
    velocities from the Lagrangian.
    """

    @property
    def degrees_of_freedom(self) -> int:
        """Number of independent velocities: of coordinates, less that of constraints."""
        return len(self.system.q) - len(self.system.conditions)

    @property
    def holonomic(self) -> tuple[sp.Expr, ...]:
        """Constraints φ(q, t) of the coordinates."""
        formulas = (one.formula for one in self.system.conditions)
        return tuple(phi for phi in formulas if not phi.free_symbols & {*self.system.qdot})

    @property
    def velocity_constraints(self) -> tuple[sp.Expr, ...]:
        """Constraints A(q, t) q̇ + b(q, t) of the velocities."""
        holonomic = {*self.holonomic}
        return tuple(c.formula for c in self.system.conditions if c.formula not in holonomic)

    @cached_property
    def integrability(self) -> Integrability:
        """The decision which constraints of velocities are constraints of positions."""
        return integrability(self.system, self.holonomic, self.velocity_constraints)

    @property
    def integrals(self) -> tuple[sp.Expr, ...]:
        """Functions f(q, t) that motions keep at their values at the start, to rounding.

        Constraints of velocities that are integrable are the constraints f = constant.
        """
        return tuple(self.integrability.held.values())

    @cached_property
    def integral_values(self) -> tuple[sp.Symbol, ...]:
        """The values of the integrals, which are constants of a motion."""
        system, names = self.system, list[str]()
        state = (*system.q, *system.qdot, *system.params, TIME)
        used = {s.name for s in (*state, *system.parameter_variations, *system.variations)}
        for k in range(1, len(self.integrals) + 1):
            name = f"integral_{k}"
            while name in used:
                name += "_"
            names.append(name)
        return tuple(sp.Symbol(name, real=True) for name in names)

    @cached_property
    def constraint_rates(self) -> Matrix:
        """G q̇ + b, a column that remains 0: rates of change φ̇, and constraints of velocities."""
        return _column([self._rate(one.formula) for one in self.system.conditions])

    def _rate(self, formula: sp.Expr) -> sp.Expr:
        q, qdot = self.system.q, self.system.qdot
        if formula.free_symbols & {*qdot}:
            return formula
        terms = (derivative(formula, x) * v for x, v in zip(q, qdot, strict=True))
        return sp.Add(*terms, derivative(formula, TIME))

    @cached_property
    def constraint_jacobian(self) -> Matrix:
        """G(q, t) of one row a constraint: ∂φ/∂q, or A."""
        rates, qdot = self.constraint_rates, self.system.qdot
        return Matrix(len(rates), len(qdot), [derivative(b, v) for b in rates for v in qdot])

    @cached_property
    def constraint_drift(self) -> Matrix:
        """b(q, t), a column: ∂φ/∂t, or the part of a constraint without velocities."""
        at_rest = dict.fromkeys(self.system.qdot, sp.S.Zero)
        return self.constraint_rates.xreplace(at_rest)

    @cached_property
    def constraint_forcing(self) -> Matrix:
        """Right side γ(q, q̇, t) of G q̈ = γ, a column: -Σ ∂(G q̇ + b)/∂q q̇ - ∂(G q̇ + b)/∂t."""
        q, qdot = self.system.q, self.system.qdot
        sides = []
        for rate in self.constraint_rates:
            terms = (-derivative(rate, x) * v for x, v in zip(q, qdot, strict=True))
            sides.append(collected(sp.Add(*terms, -derivative(rate, TIME)), *q, *qdot))
        return _column(sides)


def _column(entries: list[sp.Expr]) -> Matrix:
    return Matrix(len(entries), 1, entries)
