"""From positions to motion, one textbook step after the other.

Every step is a plain SymPy value: print it, compare it, or let a notebook set
it as LaTeX. The mass matrix comes from the Jacobians of the positions,
M = Σ m JᵀJ, and everything after it from M and the potential alone
(L. D. Landau, E. M. Lifshitz, Mechanics, § 5 and § 40).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import sympy as sp

from derive.linearisation import Linearisation, linearised
from derive.reduction import collected, reduced
from derive.system import System, SystemDefinitionError, formula

Matrix: TypeAlias = sp.ImmutableDenseMatrix

#: A pivot smaller than this part of its diagonal entry, at 50 digits, is zero.
TINY = sp.Float("1e-30")


@dataclass(frozen=True)
class Derivation:
    """The mechanics of `system`, derived when asked for.

    Parameters
    ----------
    system : System
        Positions, masses and potential.

    Raises
    ------
    SystemDefinitionError
        When a coordinate moves no mass, or moves the masses only as others do.

    Notes
    -----
    Velocities, accelerations and momenta are symbols of their own
    (``system.qdot``, ``system.qddot``, ``system.p``), not functions of time.
    """

    system: System

    def __post_init__(self) -> None:
        self._check_independence()

    @cached_property
    def position_jacobians(self) -> tuple[Matrix, ...]:
        """J = ∂r/∂q of each mass, one row a component, one column a coordinate."""
        q = self.system.q
        return tuple(Matrix(mass.position).jacobian(q) for mass in self.system.masses)

    @cached_property
    def velocities(self) -> tuple[Matrix, ...]:
        """Velocity J q̇ of each mass, a column of two or three components."""
        qdot = Matrix(self.system.qdot)
        return tuple(jacobian * qdot for jacobian in self.position_jacobians)

    @cached_property
    def mass_matrix(self) -> Matrix:
        """M(q) = Σ m JᵀJ, symmetric, n × n."""
        n = len(self.system.q)
        columns = [[tuple(J[:, i]) for i in range(n)] for J in self.position_jacobians]
        dots: dict[object, sp.Expr] = {}

        def entry(i: int, j: int) -> sp.Expr:
            # masses below one joint share their dot products: reduce each product once
            masses: dict[sp.Expr, sp.Expr] = {}
            for mass, column in zip(self.system.masses, columns, strict=True):
                pair = (column[i], column[j])
                if pair not in dots:
                    products = (a * b for a, b in zip(*pair, strict=True))
                    dots[pair] = sp.factor_terms(reduced(sp.Add(*products)))
                masses[dots[pair]] = masses.get(dots[pair], sp.S.Zero) + mass.mass
            return sp.Add(*(total * dot for dot, total in masses.items()))

        upper = {(i, j): entry(i, j) for i in range(n) for j in range(i, n)}
        return Matrix(n, n, lambda i, j: upper[min(i, j), max(i, j)])

    @cached_property
    def kinetic_energy(self) -> sp.Expr:
        """T = ½ q̇ᵀ M q̇."""
        M, qdot = self.mass_matrix, self.system.qdot
        n = len(qdot)
        return sp.Add(
            *(M[i, i] * qdot[i] ** 2 / 2 for i in range(n)),
            *(M[i, j] * qdot[i] * qdot[j] for i in range(n) for j in range(i + 1, n)),
        )

    @cached_property
    def potential_energy(self) -> sp.Expr:
        """V(q), one term for each function of the coordinates."""
        return collected(self.system.potential, *self.system.q)

    @cached_property
    def lagrangian(self) -> sp.Expr:
        """L = T - V."""
        return self.kinetic_energy - self.potential_energy

    @cached_property
    def energy(self) -> sp.Expr:
        """E = T + V as a function of q and q̇."""
        return self.kinetic_energy + self.potential_energy

    @cached_property
    def momenta(self) -> Matrix:
        """P = ∂L/∂q̇ = M q̇, a column."""
        return self.mass_matrix * Matrix(self.system.qdot)

    @cached_property
    def forcing(self) -> Matrix:
        """f(q, q̇) of M q̈ = f, a column: what is left of the Euler–Lagrange equations.

        f_i = -Σ_jk (∂M_ij/∂q_k - ½ ∂M_jk/∂q_i) q̇_j q̇_k - ∂V/∂q_i, in which the
        brackets are Christoffel symbols of the first kind.
        """
        q, qdot, M = self.system.q, self.system.qdot, self.mass_matrix
        gradient = [M.diff(qk) for qk in q]
        n = range(len(q))
        return Matrix(
            [
                collected(
                    -sp.Add(
                        *(
                            (gradient[k][i, j] - gradient[i][j, k] / 2) * qdot[j] * qdot[k]
                            for j in n
                            for k in n
                        )
                    )
                    - self.potential_energy.diff(q[i]),
                    *q,
                    *qdot,
                )
                for i in n
            ]
        )

    @cached_property
    def euler_lagrange(self) -> Matrix:
        """Residuals d/dt ∂L/∂q̇ - ∂L/∂q, a column; the motion makes them zero."""
        return self.mass_matrix * Matrix(self.system.qddot) - self.forcing

    def _check_independence(self) -> None:
        """Eliminate the mass matrix at a generic place: a pivot of zero names its coordinate."""
        system = self.system
        symbols = (*system.params, *system.q)
        place = {s: sp.Rational(7 * k + 3, 5 * k + 4) for k, s in enumerate(symbols)}
        rows = [list(row) for row in self.mass_matrix.evalf(50, subs=place).tolist()]
        for k, q in enumerate(system.q):
            if not rows[k][k] > self.mass_matrix[k, k].evalf(50, subs=place) * TINY:
                why = (
                    "moves no mass"
                    if self.mass_matrix[k, k] == 0
                    else (f"moves the masses only as {', '.join(s.name for s in system.q[:k])} can")
                )
                raise SystemDefinitionError(
                    f"coordinate {q.name!r} of system {system.name!r} {why}: leave it out, or let "
                    "a position depend on it"
                )
            for i in range(k + 1, len(rows)):
                ratio = rows[i][k] / rows[k][k]
                rows[i] = [a - ratio * b for a, b in zip(rows[i], rows[k], strict=True)]

    @cached_property
    def _adjugate_and_determinant(self) -> tuple[Matrix, sp.Expr]:
        # for reading only: the adjugate grows as n!, generated code solves M w = p instead
        return self.mass_matrix.adjugate(), sp.factor_terms(reduced(self.mass_matrix.det()))

    def _divided_by_mass(self, column: Matrix) -> Matrix:
        adjugate, determinant = self._adjugate_and_determinant
        state = self.system.q + self.system.qdot + self.system.p
        return (adjugate * column).applyfunc(
            lambda entry: sp.factor_terms(collected(entry, *state)) / determinant
        )

    @cached_property
    def accelerations(self) -> Matrix:
        """q̈ = M⁻¹ f, a column."""
        return self._divided_by_mass(self.forcing)

    @cached_property
    def hamiltonian(self) -> sp.Expr:
        """H(q, p) = ½ pᵀ M⁻¹ p + V: the energy, since the positions do not depend on time."""
        adjugate, determinant = self._adjugate_and_determinant
        p = Matrix(self.system.p)
        numerator = collected((p.T * adjugate * p)[0, 0], *self.system.q, *self.system.p)
        return sp.factor_terms(numerator) / (2 * determinant) + self.potential_energy

    @cached_property
    def hamilton_equations(self) -> tuple[Matrix, Matrix]:
        """(q̇, ṗ) = (∂H/∂p, -∂H/∂q), two columns."""
        velocities = self._divided_by_mass(Matrix(self.system.p))
        return velocities, Matrix([-self.hamiltonian.diff(q) for q in self.system.q])

    def linearisation(self, equilibrium: Sequence[sp.Expr] | None = None) -> Linearisation:
        """Small motions about an equilibrium.

        Parameters
        ----------
        equilibrium : sequence of sympy.Expr, optional
            Coordinates at rest; by default the system's own equilibrium, or zeros.

        Raises
        ------
        SystemDefinitionError
            When a force is left at that place, or their number is wrong.
        """
        if equilibrium is None:
            equilibrium = self.system.equilibrium
        place = (0,) * len(self.system.q) if equilibrium is None else equilibrium
        return linearised(
            self.system, self.mass_matrix, self.potential_energy, tuple(map(formula, place))
        )
