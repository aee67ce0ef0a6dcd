"""Equations of motion in angular velocities, for systems with unit quaternions.

A unit quaternion κ moves with half the body's angular velocity h, in body axes: κ̇ = Eᵀ h and
h = E κ̇, where the rows of E and κ are orthonormal. With the quasi-velocities u, which are h for a
quaternion and q̇ for another coordinate, the accelerations follow from M u̇ = f without the norm's
multiplier (T. R. Kane, D. A. Levinson, Dynamics: Theory and Applications, chapter 4): with the
velocity v(q, u, t) of a mass, M = Σ m (∂v/∂u)ᵀ ∂v/∂u, and the velocity's change at constant u,
times -m ∂v/∂u, is a force. A rotation adds the same of ω, and -∂ω/∂u · (ω × J ω). For a free body
these are Euler's equations. Polynomials are shortened by |κ|² = 1.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from derive.formulas.budget import is_expandable
from derive.formulas.functions import derivative
from derive.mechanics.derivation import Derivation
from derive.mechanics.energies.kinetics import Matrix
from derive.mechanics.energies.reduction import reduced
from derive.mechanics.independence import is_singular
from derive.system.orientation import dot
from derive.system.rigid_body import RigidBody
from derive.system.symbols import TIME

AXES = "xyz"
Row = tuple[sp.Expr, ...]


@dataclass(frozen=True)
class QuasiVelocities:
    """M u̇ = f + Gᵀ λ and G u̇ = γ of a derivation, without the norms of its quaternions."""

    derivation: Derivation

    @cached_property
    def quaternions(self) -> tuple[tuple[sp.Symbol, ...], ...]:
        """Coordinates that are unit quaternions."""
        bodies = self.derivation.bodies
        return tuple(dict.fromkeys(body.quaternion for body in bodies if body.quaternion))

    @cached_property
    def halves(self) -> dict[tuple[sp.Symbol, ...], tuple[sp.Symbol, ...]]:
        """Symbols of half the angular velocity of each quaternion."""
        return {
            parts: tuple(sp.Symbol(f"half_{axis}_{parts[0]}", real=True) for axis in AXES)
            for parts in self.quaternions
        }

    @cached_property
    def u(self) -> tuple[sp.Symbol, ...]:
        """The quasi-velocities: velocities of other coordinates, then halves."""
        system = self.derivation.system
        inner = {part for parts in self.quaternions for part in parts}
        others = [v for q, v in zip(system.q, system.qdot, strict=True) if q not in inner]
        return (*others, *(h for triple in self.halves.values() for h in triple))

    @cached_property
    def rates(self) -> dict[sp.Symbol, sp.Expr]:
        """The rate of each coordinate, a function of q and u."""
        system = self.derivation.system
        rates = dict(zip(system.q, system.qdot, strict=True))
        for parts, triple in self.halves.items():
            for part, column in zip(parts, columns(parts), strict=True):
                rates[part] = sp.Add(*(c * h for c, h in zip(column, triple, strict=True)))
        return rates

    @cached_property
    def _velocities(self) -> list[tuple[sp.Expr, Row]]:
        """Pairs of inertia and velocity v(q, u, t), of positions and of rotations."""
        masses = self.derivation.system.masses
        pairs = [
            (inertia, tuple(map(self._rate, position)))
            for mass in masses
            for inertia, position in mass.motions
        ]
        for body in self.derivation.bodies:
            omega = self._turning(body)
            for moment, axes in body.turns:
                pairs.append((moment, tuple(dot(axis, omega) for axis in axes)))
        return pairs

    def _turning(self, body: RigidBody) -> Row:
        """The angular velocity ω(q, u, t) in body axes."""
        if body.quaternion:
            return tuple(2 * h for h in self.halves[body.quaternion])
        return tuple(self.derivation.angular_velocity(body))  # of which no quaternion is part

    def _rate(self, function: sp.Expr) -> sp.Expr:
        """The rate of change of a function of q, u and t at constant u."""
        terms = (derivative(function, q) * rate for q, rate in self.rates.items())
        return self._shortened(sp.Add(*terms, derivative(function, TIME)))

    def _shortened(self, function: sp.Expr) -> sp.Expr:
        """The shorter of a function and its remainder by |κ|² - 1, which are equal."""
        used = [parts for parts in self.quaternions if function.free_symbols & {*parts}]
        if not used:
            return function
        if not is_expandable(function):
            return function
        form = sp.expand(function)
        for first, *others in used:
            if form.is_polynomial(first, *others):
                square = 1 - sp.Add(*(part**2 for part in others))
                form = sp.expand(_with_square(form, first, square))
        return min(function, form, key=lambda each: int(each.count_ops()))

    @cached_property
    def mass_matrix(self) -> Matrix:
        """M(q, t), symmetric."""
        slopes = [(m, [[x.diff(u) for x in v] for u in self.u]) for m, v in self._velocities]

        def entry(i: int, j: int) -> sp.Expr:
            terms = (m * self._shortened(reduced(dot(rows[i], rows[j]))) for m, rows in slopes)
            return sp.Add(*terms)

        n = len(self.u)
        upper = {(i, j): entry(i, j) for i in range(n) for j in range(i, n)}
        return Matrix(n, n, lambda i, j: upper[min(i, j), max(i, j)])

    @cached_property
    def has_singular_mass_matrix(self) -> bool:
        """Whether some motions that keep the norms move no mass, as the spin of a thin rod."""
        d = self.derivation
        rows = [k for k, one in enumerate(d.system.conditions) if one.formula in d.quaternion_norms]
        G = d.constraint_jacobian.extract(rows, [*range(len(d.system.q))])
        return is_singular(d.system, d.mass_matrix + G.T * G)

    @cached_property
    def inertial_forces(self) -> tuple[sp.Expr, ...]:
        """The part of f without forces and potential: of v̇ at constant u, and of ω × J ω."""
        forces = [sp.S.Zero] * len(self.u)
        for inertia, v in self._velocities:
            changes = tuple(map(self._rate, v))
            for i, u in enumerate(self.u):
                slopes = tuple(x.diff(u) for x in v)
                forces[i] -= inertia * self._shortened(dot(slopes, changes))
        for body in self.derivation.bodies:
            if not body.turns:
                continue
            omega = Matrix(self._turning(body))
            torque = omega.cross(body.tensor * omega)
            for i, u in enumerate(self.u):
                forces[i] -= (omega.diff(u).T * torque)[0]
        return tuple(sp.factor_terms(sp.expand(force)) for force in forces)

    @cached_property
    def constraint_rates(self) -> tuple[sp.Expr, ...]:
        """Rates G u + b of the other constraints, functions of q, u and t."""
        d = self.derivation
        names = dict(zip(d.system.qdot, self.rates.values(), strict=True))
        pairs = zip(d.system.conditions, d.constraint_rates, strict=True)
        return tuple(
            self._shortened(rate.xreplace(names))
            for one, rate in pairs
            if one.formula not in d.quaternion_norms
        )

    @cached_property
    def constraint_jacobian(self) -> list[Row]:
        """G, one row a constraint."""
        return [tuple(rate.diff(u) for u in self.u) for rate in self.constraint_rates]

    @cached_property
    def constraint_forcing(self) -> list[sp.Expr]:
        """γ of G u̇ = γ."""
        return [-self._rate(rate) for rate in self.constraint_rates]


def columns(parts: Sequence[sp.Symbol]) -> tuple[Row, ...]:
    """Columns of E, one for each component of a quaternion."""
    w, x, y, z = parts
    return ((-x, -y, -z), (w, -z, y), (z, w, -x), (-y, x, w))


def _with_square(form: sp.Expr, symbol: sp.Symbol, square: sp.Expr) -> sp.Expr:
    """A sum of monomials of `symbol` with `square` in place of symbol².

    Polynomials of SymPy would take ten times as long where factors are sines.
    """
    terms = []
    for term in sp.Add.make_args(form):
        coefficient, power = term.as_coeff_exponent(symbol)
        terms.append(coefficient * square ** (power // 2) * symbol ** (power % 2))
    return sp.Add(*terms)
