"""Energies of a system, from the positions of its masses."""

from dataclasses import dataclass
from functools import cache, cached_property
from typing import TypeAlias

import sympy as sp

from derive.formulas.switching import decisive_numbers, switching_functions
from derive.mechanics.reduction import gathered, reduced
from derive.system.symbols import TIME
from derive.system.system import System

Matrix: TypeAlias = sp.ImmutableDenseMatrix


@dataclass(frozen=True)
class Kinetics:
    """Positions, velocities, inertia and energies of `system`.

    Time is an additional coordinate whose velocity is 1: M̄ = Σ m J̄ᵀJ̄ with J̄ = ∂r/∂(q, t) contains
    the mass matrix and the terms of moving pivots.
    """

    system: System

    @cached_property
    def position_jacobians(self) -> tuple[Matrix, ...]:
        """J = ∂r/∂q of each mass, one row a component, one column a coordinate."""
        q = self.system.q
        return tuple(Matrix(mass.position).jacobian(q) for mass in self.system.masses)

    @cached_property
    def velocities(self) -> tuple[Matrix, ...]:
        """Velocity J q̇ + ∂r/∂t of each mass, a column of two or three components."""
        qdot = Matrix(self.system.qdot)
        return tuple(
            jacobian * qdot + Matrix(mass.position).diff(TIME)
            for jacobian, mass in zip(self.position_jacobians, self.system.masses, strict=True)
        )

    @cached_property
    def variables(self) -> tuple[sp.Symbol, ...]:
        """Coordinates, time if positions depend on it, and lengths with requested reactions."""
        positions = sp.Tuple(*(r for m in self.system.masses for _, r in m.motions))
        time = (TIME,) if TIME in positions.free_symbols else ()
        return (*self.system.q, *time, *self.system.reactions)

    @cached_property
    def rates(self) -> tuple[sp.Expr, ...]:
        """Rates of change of the variables: q̇, 1 for time, 0 for constant lengths."""
        n = len(self.system.q)
        others = (sp.S.One if variable == TIME else sp.S.Zero for variable in self.variables[n:])
        return (*self.system.qdot, *others)

    @cached_property
    def inertia(self) -> Matrix:
        """M̄ = Σ m J̄ᵀJ̄ over all variables, symmetric; the mass matrix is its upper left part."""
        motions = [motion for mass in self.system.masses for motion in mass.motions]

        @cache
        def change(position: sp.Expr, variable: sp.Symbol) -> sp.Expr:
            # the positions of a chain share most of their terms
            if position.is_Add:
                return sp.Add(*(change(term, variable) for term in position.args))
            return derivative(position, variable)

        tangents = [
            [tuple(change(r, v) for r in position) for v in self.variables]
            for _, position in motions
        ]
        dots: dict[object, sp.Expr] = {}

        def entry(i: int, j: int) -> sp.Expr:
            # masses below a joint share their dot products, which are reduced once
            inertias: dict[sp.Expr, sp.Expr] = {}
            for (inertia, _), tangent in zip(motions, tangents, strict=True):
                pair = (tangent[i], tangent[j])
                if pair not in dots:
                    products = (a * b for a, b in zip(*pair, strict=True))
                    dots[pair] = sp.factor_terms(reduced(sp.Add(*products)))
                inertias[dots[pair]] = inertias.get(dots[pair], sp.S.Zero) + inertia
            return sp.Add(*(total * dot for dot, total in inertias.items()))

        n = len(self.variables)
        upper = {(i, j): entry(i, j) for i in range(n) for j in range(i, n)}
        return Matrix(n, n, lambda i, j: upper[min(i, j), max(i, j)])

    @cached_property
    def mass_matrix(self) -> Matrix:
        """M(q, t), symmetric, n × n."""
        n = len(self.system.q)
        return self.inertia[:n, :n]

    @cached_property
    def kinetic_energy(self) -> sp.Expr:
        """T = ½ q̇ᵀ M q̇; with moving pivots also terms that are linear in q̇ or independent of it."""
        return self._quadratic(range(len(self.variables)))

    def _quadratic(self, variables: range) -> sp.Expr:
        """½ vᵀ M̄ v of some of the variables."""
        v, M = self.rates, self.inertia
        squares = [M[i, i] * v[i] ** 2 / 2 for i in variables]
        pairs = ((i, j) for j in variables for i in variables if i < j)
        return sp.Add(*squares, *(M[i, j] * v[i] * v[j] for i, j in pairs))

    @cached_property
    def potential_energy(self) -> sp.Expr:
        """V(q, t), one term for each function of the coordinates."""
        return gathered(self.system.potential_energy, *self.system.q)

    @cached_property
    def switching_functions(self) -> tuple[sp.Expr, ...]:
        """Functions of (q, q̇, t) at whose zeros forces have a kink or a jump."""
        return switching_functions(self._formulas, (*self.system.q, *self.system.qdot, TIME))

    @cached_property
    def decisive_numbers(self) -> tuple[sp.Expr, ...]:
        """Switching functions, and others on which roots, powers and logarithms depend."""
        return decisive_numbers(self._formulas, (*self.system.q, *self.system.qdot, TIME))

    @property
    def _formulas(self) -> tuple[sp.Expr, ...]:
        masses = self.system.masses
        positions = (r for mass in masses for _, motion in mass.motions for r in motion)
        return (*positions, self.potential_energy, *self.system.applied)

    @cached_property
    def lagrangian(self) -> sp.Expr:
        """L = T - V."""
        return self.kinetic_energy - self.potential_energy

    @cached_property
    def effective_potential(self) -> sp.Expr:
        """U(q, t) = V - T₀, with T₀ the kinetic energy at q̇ = 0."""
        others = range(len(self.system.q), len(self.variables))
        return self.potential_energy - self._quadratic(others)

    @cached_property
    def energy(self) -> sp.Expr:
        """Jacobi's integral q̇·∂L/∂q̇ - L: T + V where no position depends on time."""
        return self._quadratic(range(len(self.system.q))) + self.effective_potential

    @cached_property
    def power(self) -> sp.Expr:
        """Rate of the energy: work of the applied forces, and -∂L/∂t."""
        work = (f * v for f, v in zip(self.system.applied, self.system.qdot, strict=True))
        return sp.Add(*work) - self.lagrangian.diff(TIME)


def derivative(expression: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    """∂expression/∂symbol, at once where the symbol is not in it."""
    return expression.diff(symbol) if symbol in expression.free_symbols else sp.S.Zero
