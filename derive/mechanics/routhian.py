"""Cyclic coordinates, whose momenta are constant, and Routh's function of the others.

R(q, q̇, p) = L - Σ p_k q̇_k over eliminated coordinates is a Lagrangian of the others (E. J. Routh
(1877); L. D. Landau, E. M. Lifshitz, Mechanics, § 41, and H. Goldstein, Classical Mechanics, 8.3,
who define it with the opposite sign).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from derive.formulas.functions import derivative
from derive.mechanics.energies.kinetics import Matrix
from derive.mechanics.energies.reduction import collected, reduced
from derive.mechanics.equations import HALF, Equations
from derive.system.symbols import TIME


@dataclass(frozen=True)
class Routhian:
    """Lagrange's equations of some coordinates, Hamilton's of the others.

    Attributes
    ----------
    equations : Equations
        The system.
    eliminated : tuple of int
        Indices of the coordinates whose velocities are replaced by momenta.
    """

    equations: Equations
    eliminated: tuple[int, ...]

    @cached_property
    def remaining(self) -> tuple[int, ...]:
        """Indices of the other coordinates."""
        return tuple(k for k in range(len(self.equations.system.q)) if k not in self.eliminated)

    @cached_property
    def velocities(self) -> dict[sp.Symbol, sp.Expr]:
        """Velocities of the eliminated coordinates, functions of q, their momenta and other q̇."""
        system = self.equations.system
        column = self._solved(self._momenta - self._coupling.T * self._rates)
        keys = (system.qdot[k] for k in self.eliminated)
        return {key: self._tidy(value) for key, value in zip(keys, column, strict=True)}

    @cached_property
    def function(self) -> sp.Expr:
        """R = ½ q̇ᵀ (M - N K⁻¹ Nᵀ) q̇ + (b + N K⁻¹ p)·q̇ - ½ pᵀ K⁻¹ p - U.

        K is the part of the mass matrix of the eliminated coordinates, N couples it with the
        others, and p is less its value at q̇ = 0.
        """
        d, N, v = self.equations, self._coupling, self._rates
        M = d.mass_matrix.extract([*self.remaining], [*self.remaining])
        inertia = (M - N * self._solved(N.T)).applyfunc(_factored)
        drift = d.drift.extract([*self.remaining], [0]) + N * self._solved(self._momenta)
        n = range(len(v))
        terms = [HALF * inertia[i, i] * v[i] ** 2 for i in n]
        terms += [inertia[i, j] * v[i] * v[j] for j in n for i in range(j)]
        terms += [sp.expand(self._tidy(b) * v[i], deep=False) for i, b in enumerate(drift)]
        return sp.Add(*terms) - HALF * sp.Add(*self._squares) - d.effective_potential

    @property
    def _squares(self) -> list[sp.Expr]:
        """pᵀ K⁻¹ p as a sum of squares, by eliminating the last momentum first."""
        K = self.equations.mass_matrix.extract([*self.eliminated], [*self.eliminated])
        p, squares = [*self._momenta], []
        while p:
            last, pivot, column = p.pop(), K[-1, -1], K[:-1, -1]
            squares.append(last**2 / pivot)
            p = [_factored(one - c * last / pivot) for one, c in zip(p, column, strict=True)]
            K = (K[:-1, :-1] - column * column.T / pivot).applyfunc(_factored)
        return squares[::-1]

    @cached_property
    def residuals(self) -> Matrix:
        """d/dt ∂R/∂q̇ - ∂R/∂q - Q - Gᵀ λ of the remaining coordinates, 0 along motions.

        Momenta of the eliminated coordinates, which must be cyclic, are constants.
        """
        system, R = self.equations.system, self.function
        G, multipliers = self.equations.constraint_jacobian, system.multipliers
        rows = []
        for k in self.remaining:
            momentum = R.diff(system.qdot[k])
            force = system.applied[k].xreplace(self.velocities)
            force += sum(G[i, k] * one for i, one in enumerate(multipliers))
            change = sum(
                (derivative(momentum, s) * rate for s, rate in self._motion),
                derivative(momentum, TIME),
            )
            rows.append(_terms(change - derivative(R, system.q[k]) - force))
        return Matrix(len(rows), 1, rows)

    @property
    def _motion(self) -> list[tuple[sp.Symbol, sp.Expr]]:
        system = self.equations.system
        pairs = [(system.q[k], system.qdot[k]) for k in self.remaining]
        return pairs + [(system.qdot[k], system.qddot[k]) for k in self.remaining]

    @property
    def _rates(self) -> Matrix:
        return self._column([self.equations.system.qdot[k] for k in self.remaining])

    @property
    def _momenta(self) -> Matrix:
        d = self.equations
        return self._column([d.system.p[k] - d.drift[k] for k in self.eliminated])

    @property
    def _coupling(self) -> Matrix:
        return self.equations.mass_matrix.extract([*self.remaining], [*self.eliminated])

    def _solved(self, right: Matrix) -> Matrix:
        adjugate, determinant = self._inverse
        return adjugate * right / determinant

    @cached_property
    def _inverse(self) -> tuple[Matrix, sp.Expr]:
        K = self.equations.mass_matrix.extract([*self.eliminated], [*self.eliminated])
        return K.adjugate(), sp.factor_terms(reduced(K.det()))

    @staticmethod
    def _column(entries: Sequence[sp.Expr]) -> Matrix:
        return Matrix(len(entries), 1, entries)

    def _tidy(self, value: sp.Expr) -> sp.Expr:
        """A fraction whose numerator is a sum of products of velocities and momenta."""
        system = self.equations.system
        numerator, denominator = sp.fraction(sp.together(value))
        terms = collected(numerator, *system.q, *system.qdot, *system.qddot, *system.p)
        return _factored(terms / denominator)


def _terms(value: sp.Expr) -> sp.Expr:
    """A sum with the common factors of each term outside."""
    return sp.Add(*map(sp.factor_terms, sp.Add.make_args(sp.expand(value, deep=False))))


def _factored(value: sp.Expr) -> sp.Expr:
    """A fraction without common factors, as far as these are of parameters and functions."""
    numerator, denominator = sp.fraction(sp.together(value))
    return sp.factor_terms(sp.cancel(reduced(numerator) / sp.factor_terms(reduced(denominator))))


@dataclass(frozen=True)
class CyclicCoordinates(Equations):
    """Conserved momenta of `system`, and its motion without the cyclic coordinates."""

    @cached_property
    def cyclic_coordinates(self) -> tuple[sp.Symbol, ...]:
        """Coordinates that neither L nor a constraint contains, and on which no force is applied.

        Examples
        --------
        >>> from derive import Derivation, load
        >>> Derivation(load("heavy_top")).cyclic_coordinates
        (phi, psi)
        """
        system = self.system
        contents = sp.Tuple(
            *self.mass_matrix, *self.drift, self.effective_potential, *self.constraint_rates
        ).free_symbols
        rows = zip(system.q, system.qdot, system.applied, strict=True)
        fixed = self.constraint_rates.free_symbols
        return tuple(q for q, v, Q in rows if Q == 0 and q not in contents and v not in fixed)

    @property
    def conserved_momenta(self) -> dict[sp.Symbol, sp.Expr]:
        """Momenta of the cyclic coordinates, functions of q and q̇."""
        rows = zip(self.system.q, self.system.p, self.momenta, strict=True)
        return {p: value for q, p, value in rows if q in self.cyclic_coordinates}

    @property
    def cyclic_velocities(self) -> dict[sp.Symbol, sp.Expr]:
        """Velocities of the cyclic coordinates, functions of the other q, q̇ and of momenta."""
        return self._without_cyclic.velocities

    @property
    def routhian(self) -> sp.Expr:
        """R = L - Σ p q̇ over the cyclic coordinates: a Lagrangian of the others.

        L if no coordinate is cyclic. Many textbooks define R with the opposite sign.

        Examples
        --------
        >>> from derive import Derivation, load
        >>> Derivation(load("spherical_pendulum")).routhian
        g*l*m*cos(theta) + l**2*m*theta_dot**2/2 - p_phi**2/(2*l**2*m*sin(theta)**2)
        """
        return self._without_cyclic.function

    @property
    def routh_equations(self) -> Matrix:
        """Residuals d/dt ∂R/∂q̇ - ∂R/∂q - Q - Gᵀ λ of the other coordinates, a column.

        They are zero along a motion, with constant momenta of the cyclic coordinates.
        """
        return self._without_cyclic.residuals

    @cached_property
    def _without_cyclic(self) -> Routhian:
        q = self.system.q
        return Routhian(self, tuple(q.index(one) for one in self.cyclic_coordinates))
