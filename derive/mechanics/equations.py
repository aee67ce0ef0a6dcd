"""Lagrange's and Hamilton's equations of a system, from its energies."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from derive.formulas.functions import derivative
from derive.mechanics.constraints.differentiated_constraints import Constraints
from derive.mechanics.energies.kinetics import Matrix
from derive.mechanics.energies.reduction import collected, reduced
from derive.system.parts import SystemDefinitionError

HALF = sp.Rational(1, 2)


@dataclass(frozen=True)
class Equations(Constraints):
    """Momenta, forces, reactions and equations of motion of `system`."""

    @cached_property
    def momenta(self) -> Matrix:
        """Momenta p = ∂L/∂q̇ = M q̇ + b, a column."""
        return _product(self.mass_matrix, self.system.qdot) + self.drift

    @cached_property
    def drift(self) -> Matrix:
        """Momenta b at q̇ = 0, a column: Σ m Jᵀ ∂r/∂t, 0 if positions do not depend on time."""
        n = len(self.system.q)
        if len(self.variables) == n:
            return Matrix.zeros(n, 1)
        return _product(self.inertia[:n, n:], self.rates[n:])

    @cached_property
    def forcing(self) -> Matrix:
        """Right side f(q, q̇, t) of M q̈ = f, a column.

        f_i = -Σ_jk Γ_ijk v_j v_k - ∂V/∂q_i + Q_i, with v the rates of all variables and
        Γ_ijk Christoffel's symbols of the first kind of M̄.
        """
        state, forces = self.system.q + self.system.qdot, []
        for i, (q, applied) in enumerate(zip(self.system.q, self.system.applied, strict=True)):
            force = applied - self._inertial(i) - self.potential_energy.diff(q)
            forces.append(collected(force, *state))
        return Matrix(forces)

    @cached_property
    def coriolis_matrix(self) -> Matrix:
        """C(q, q̇) of M q̈ + C q̇ = Q - ∂V/∂q, of those with this product the usual one.

        C_ij = Σ_k Γ_ijk v_k, with v the rates of all variables.
        """
        n, v = len(self.system.q), [*enumerate(self.rates)]
        return Matrix(n, n, lambda i, j: sp.Add(*(self._christoffel(i, j, k) * r for k, r in v)))

    def _inertial(self, i: int) -> sp.Expr:
        """Σ Γ_ijk v_j v_k for the variable i."""
        v, n = self.rates, range(len(self.variables))
        pairs = ((j, k, 1 if j == k else 2) for j in n for k in n[j:])
        terms = (self._christoffel(i, j, k) * v[j] * v[k] * count for j, k, count in pairs)
        return sp.Add(*terms)

    def _christoffel(self, i: int, j: int, k: int) -> sp.Expr:
        """½ (∂M̄_ij/∂q_k + ∂M̄_ik/∂q_j - ∂M̄_jk/∂q_i)."""
        q, M = self.variables, self.inertia
        return HALF * (
            derivative(M[i, j], q[k]) + derivative(M[i, k], q[j]) - derivative(M[j, k], q[i])
        )

    @cached_property
    def euler_lagrange(self) -> Matrix:
        """Residuals d/dt ∂L/∂q̇ - ∂L/∂q - Q - Gᵀ λ, a column, which are zero along a motion."""
        reactions = _product(self.constraint_jacobian.T, self.system.multipliers)
        return _product(self.mass_matrix, self.system.qddot) - self.forcing - reactions

    @cached_property
    def reactions(self) -> Matrix:
        """Forces that hold the given lengths constant, a column: a rod's tension is positive.

        The multiplier of the constraint that a length l is constant is the force that is
        required if l is free: -(d/dt ∂L/∂l̇ - ∂L/∂l) at l̇ = l̈ = 0, a function of q, q̇ and q̈.
        """
        first, qddot = len(self.variables) - len(self.system.reactions), Matrix(self.system.qddot)
        forces = []
        for i, length in enumerate(self.variables[first:], first):
            inertial = -(self.inertia[i, : len(qddot)] * qddot)[0] - self._inertial(i)
            forces.append(inertial - self.potential_energy.diff(length))
        return Matrix(forces)

    @cached_property
    def _adjugate_and_determinant(self) -> tuple[Matrix, sp.Expr]:
        # not for generated code, which solves M w = p: the adjugate grows as n!
        return self.mass_matrix.adjugate(), sp.factor_terms(reduced(self.mass_matrix.det()))

    def _divided_by_mass(self, column: Matrix) -> Matrix:
        adjugate, determinant = self._adjugate_and_determinant
        state = self.system.q + self.system.qdot + self.system.p
        return (adjugate * column).applyfunc(
            lambda entry: sp.factor_terms(collected(entry, *state)) / determinant
        )

    @cached_property
    def accelerations(self) -> Matrix:
        """q̈ = M⁻¹ f, a column; with constraints that of M q̈ = f + Gᵀ λ and G q̈ = γ."""
        if not self.system.conditions:
            return self._divided_by_mass(self.forcing)
        return self._constrained_solution[: len(self.system.q), :]

    @cached_property
    def multipliers(self) -> Matrix:
        """Multipliers λ of the constraints, a column: functions of q, q̇ and t."""
        return self._constrained_solution[len(self.system.q) :, :]

    @cached_property
    def _constrained_solution(self) -> Matrix:
        M, G = self.mass_matrix, self.constraint_jacobian
        matrix = sp.BlockMatrix([[M, -G.T], [G, sp.zeros(G.rows)]]).as_explicit()
        column = sp.Matrix([*self.forcing, *self.constraint_forcing])
        determinant = sp.factor_terms(reduced(matrix.det()))
        numerator = matrix.adjugate() * column
        return Matrix(numerator.applyfunc(lambda entry: sp.factor_terms(entry) / determinant))

    def check_canonical(self) -> None:
        """Refuse Hamilton's form of a system with constraints."""
        names = ", ".join(one.name for one in self.system.conditions)
        if self.integrability.nonholonomic:
            raise SystemDefinitionError(
                f"system {self.system.name!r} has no Hamiltonian form: constraints of velocities "
                f"are not integrable ({names}); momenta of the remaining velocities are conjugate "
                "to no coordinates, and the motion preserves no volume of phase space in general; "
                "use Lagrange's form, which has the multipliers"
            )
        if names:
            raise SystemDefinitionError(
                f"system {self.system.name!r} has no Hamiltonian form: its coordinates and their "
                f"momenta are not independent ({names}); give coordinates that satisfy the "
                "constraints, or use Lagrange's form, which has the multipliers"
            )

    @cached_property
    def hamiltonian(self) -> sp.Expr:
        """H(q, p, t) = ½ (p - b)ᵀ M⁻¹ (p - b) + U, the energy as a function of the momenta.

        A `SystemDefinitionError` states the reason why a system with constraints has none.
        """
        self.check_canonical()
        adjugate, determinant = self._adjugate_and_determinant
        p = Matrix(self.system.p) - self.drift
        numerator = collected((p.T * adjugate * p)[0, 0], *self.system.q, *self.system.p)
        return sp.factor_terms(numerator) / (2 * determinant) + self.effective_potential

    @cached_property
    def hamilton_equations(self) -> tuple[Matrix, Matrix]:
        """(q̇, ṗ) = (∂H/∂p, -∂H/∂q + Q), two columns; canonical without applied forces."""
        self.check_canonical()
        velocities = self._divided_by_mass(Matrix(self.system.p) - self.drift)
        known = dict(zip(self.system.qdot, velocities, strict=True))
        pairs = zip(self.system.q, self.system.applied, strict=True)
        rates = [force.subs(known) - self.hamiltonian.diff(q) for q, force in pairs]
        return velocities, Matrix(rates)


def _product(matrix: Matrix, column: Sequence[sp.Expr]) -> Matrix:
    """The product of both; SymPy's own examines at length whether all entries are finite."""
    rows = (zip(matrix.row(i), column, strict=True) for i in range(matrix.rows))
    return Matrix([sp.Add(*(a * x for a, x in row)) for row in rows])
