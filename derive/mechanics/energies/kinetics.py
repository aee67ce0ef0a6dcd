"""Energies of a system, from the positions of its masses."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import permutations
from typing import TypeAlias

import sympy as sp

from derive.formulas.budget import is_expandable
from derive.formulas.functions import CHOICES, decisive_numbers, derivative, switching_functions
from derive.mechanics.energies.kinematic_tree import KinematicTree, kinematic_tree
from derive.mechanics.energies.reduction import gathered, reduced
from derive.system.orientation import dot
from derive.system.rigid_body import RigidBody
from derive.system.symbols import TIME
from derive.system.system import System

Vector: TypeAlias = tuple[sp.Expr, ...]
#: Products, with numbers as their factors.
Products: TypeAlias = dict[sp.Expr, sp.Expr]


def turned(tangents: Sequence[Vector]) -> list[Vector]:
    """The tangents after turns about coordinate axes, while these remove angles from them.

    A turn of all tangents by the same angle does not change their dot products. In axes that turn
    with a vehicle, tangents of its points do not depend on its heading ψ: (a cos ψ - b sin ψ,
    a sin ψ + b cos ψ) becomes (a, b), whatever a and b are, so that nothing is expanded.
    """
    best: list[Vector] | None = [*tangents]
    while best is not None:
        tangents, best = best, _simpler(best)
    return [*tangents]


def _simpler(tangents: Sequence[Vector]) -> list[Vector] | None:
    """The tangents after the first turn that removes angles from more of them than it adds."""
    angles = [[_angles(x) for x in tangent] for tangent in tangents]
    total = sum(len(set[sp.Expr]().union(*own)) for own in angles)
    every = {angle for own in angles for one in own for angle in one}
    for angle in sorted(every, key=sp.default_sort_key):
        for j, k in permutations(range(len(tangents[0])), 2):
            depends = [angle in own[j] or angle in own[k] for own in angles]
            pairs = [*zip(tangents, depends, strict=True)]
            added = sum(not yes and (t[j] != 0 or t[k] != 0) for t, yes in pairs)
            if sum(depends) <= added:
                continue
            new = [_without(t, angle, j, k) if yes else _with(t, angle, j, k) for t, yes in pairs]
            result = [t for t in new if t is not None]
            if len(result) == len(new) and sum(len(_angles(*t)) for t in result) < total:
                return result
    return None


def _angles(*formulas: sp.Expr) -> set[sp.Expr]:
    return {wave.args[0] for x in formulas for wave in x.atoms(sp.sin, sp.cos)}


def _with(tangent: Vector, angle: sp.Expr, j: int, k: int) -> Vector:
    """Components along axes that are turned from axis j towards k."""
    cosine, sine, components = sp.cos(angle), sp.sin(angle), [*tangent]
    components[j] = tangent[j] * cosine + tangent[k] * sine
    components[k] = tangent[k] * cosine - tangent[j] * sine
    return tuple(components)


def _without(tangent: Vector, angle: sp.Expr, j: int, k: int) -> Vector | None:
    """The same where the angle cancels; None if it does not."""
    waves = (sp.cos(angle), sp.sin(angle))
    first, second = _factors(tangent[j], waves), _factors(tangent[k], waves)
    if first is None or second is None:
        return None
    (a, minus_b), (b, also_a) = first, second
    if a != also_a or b != {product: -number for product, number in minus_b.items()}:
        return None
    components = [*tangent]
    components[j], components[k] = (
        sp.Add(*(number * product for product, number in part.items())) for part in (a, b)
    )
    return tuple(components)


def _factors(formula: sp.Expr, waves: Vector) -> tuple[Products, Products] | None:
    """The factors of the cosine and of the sine of an angle, if each term has one of both."""
    parts: tuple[Products, Products] = ({}, {})
    for term in sp.Add.make_args(formula):
        number, product = term.as_coeff_Mul()
        factors = sp.Mul.make_args(product)
        if number == 0:
            continue
        moving = [factor for factor in factors if factor.has(*waves)]
        inner: tuple[Products, Products] | None = None
        if moving == [waves[0]]:
            inner = ({sp.S.One: sp.S.One}, {})
        elif moving == [waves[1]]:
            inner = ({}, {sp.S.One: sp.S.One})
        elif len(moving) == 1 and moving[0].is_Add:
            inner = _factors(moving[0], waves)
        if inner is None:
            return None
        others = sp.Mul(*(factor for factor in factors if factor != moving[0]))
        for part, own in zip(parts, inner, strict=True):
            for factor, count in own.items():
                product = others * factor
                part[product] = part.get(product, sp.S.Zero) + number * count
    cosine, sine = ({product: n for product, n in part.items() if n} for part in parts)
    return cosine, sine


Matrix: TypeAlias = sp.ImmutableDenseMatrix

#: Terms of the largest dot product that is expanded to be reduced.
MOST_REDUCED = 1000
#: Terms of the largest expression whose common factors are searched.
MOST_FACTORED = 200


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
        positions = sp.Tuple(*(r for mass in self.system.masses for r in mass.placement))
        has_rows = any(one.rows > len(self.system.q) for one in self._given_matrices)
        time = (TIME,) if has_rows or TIME in positions.free_symbols else ()
        return (*self.system.q, *time, *self.system.reactions)

    @cached_property
    def rates(self) -> tuple[sp.Expr, ...]:
        """Rates of change of the variables: q̇, 1 for time, 0 for constant lengths."""
        n = len(self.system.q)
        others = (sp.S.One if variable == TIME else sp.S.Zero for variable in self.variables[n:])
        return (*self.system.qdot, *others)

    @cached_property
    def tree(self) -> KinematicTree | None:
        """The kinematic tree, where it shortens the equations; of coordinates alone."""
        positions = sp.Tuple(*(r for mass in self.system.masses for r in mass.placement))
        if self.bodies or self.variables != self.system.q or positions.has(*CHOICES):
            return None
        if self._given_matrices:
            return None
        return kinematic_tree(self.system.q, self._motions)

    @property
    def _motions(self) -> list[tuple[sp.Expr, tuple[sp.Expr, ...]]]:
        return [motion for mass in self.system.masses for motion in mass.motions]

    @property
    def _given_matrices(self) -> list[Matrix]:
        """Parts of the mass matrix that follow from no positions; the last row can be of time."""
        matrices = (mass.inertia_matrix for mass in self.system.masses)
        return [one for one in matrices if one is not None]

    @cached_property
    def inertia(self) -> Matrix:
        """M̄ = Σ m J̄ᵀJ̄ over all variables, symmetric; the mass matrix is its upper left part."""
        if self.tree:
            return self.tree.mass_matrix(self.tree.inertia)
        motions = self._motions
        tangents = [
            turned([tuple(derivative(r, v) for r in position) for v in self.variables])
            for _, position in motions
        ]
        inertias = [inertia for inertia, _ in motions]
        for body in self.bodies:
            turns = [self._turn(body, v) for v in self.variables]
            for moment, axes in body.turns:
                inertias.append(moment)
                tangents.append([tuple(dot(axis, turn) for axis in axes) for turn in turns])
        dots: dict[object, sp.Expr] = {}

        def entry(i: int, j: int) -> sp.Expr:
            # masses below a joint share their dot products, which are reduced once
            totals: dict[sp.Expr, sp.Expr] = {}
            for inertia, tangent in zip(inertias, tangents, strict=True):
                pair = (tangent[i], tangent[j])
                if pair not in dots:
                    dots[pair] = _factored(reduced(dot(*pair), MOST_REDUCED))
                totals[dots[pair]] = totals.get(dots[pair], sp.S.Zero) + inertia
            return sp.Add(*(total * dot for dot, total in totals.items()))

        n = len(self.variables)
        upper = {(i, j): entry(i, j) for i in range(n) for j in range(i, n)}
        for matrix in self._given_matrices:
            for i, j in upper:
                upper[i, j] += matrix[i, j]
        return Matrix(n, n, lambda i, j: upper[min(i, j), max(i, j)])

    @property
    def bodies(self) -> list[RigidBody]:
        """Bodies in space."""
        masses = self.system.masses
        return [mass for mass in masses if isinstance(mass, RigidBody) and mass.axes]

    @property
    def has_quaternions(self) -> bool:
        """Whether the orientation of a body is a unit quaternion."""
        return any(body.quaternion for body in self.bodies)

    @cached_property
    def quaternion_norms(self) -> dict[sp.Expr, tuple[sp.Symbol, ...]]:
        """The constraint of each unit quaternion, or the multiple of it that the system has."""
        norms = {body.conditions[0]: body.quaternion for body in self.bodies if body.quaternion}
        return {
            one.formula: parts
            for norm, parts in norms.items()
            for one in self.system.conditions
            if one.is_multiple(norm)
        }

    def angular_velocity(self, body: RigidBody) -> Matrix:
        """Angular velocity ω of a body in space, a column of components in body axes."""
        pairs = zip(self.variables, self.rates, strict=True)
        moving = [(self._turn(body, v), rate) for v, rate in pairs if rate != 0]
        parts = ([turn[k] * rate for turn, rate in moving] for k in range(3))
        return Matrix([sp.Add(*part) for part in parts])

    def _turn(self, body: RigidBody, variable: sp.Symbol) -> tuple[sp.Expr, ...]:
        """The angular velocity for each unit of the variable's rate."""
        orientation = body.axes
        return tuple(map(reduced, orientation.turn(variable))) if orientation else ()

    @cached_property
    def angular_momentum(self) -> Matrix:
        """Σ m r × ṙ + R J ω about the origin, a column; of systems in space."""
        total = sp.zeros(3, 1)
        for mass in self.system.masses:
            for inertia, position in mass.motions:
                total += inertia * Matrix(position).cross(self._velocity(position))
        for body in self.bodies:
            if body.axes and body.turns:
                total += body.axes.matrix * body.tensor * self.angular_velocity(body)
        return Matrix(total)

    def _velocity(self, position: Sequence[sp.Expr]) -> Matrix:
        r, q = Matrix(position), self.system.q
        return r.jacobian(q) * Matrix(self.system.qdot) + r.diff(TIME)

    @cached_property
    def mass_matrix(self) -> Matrix:
        """M(q, t), symmetric, n × n."""
        n = len(self.system.q)
        return self.inertia[:n, :n]

    def mass_matrix_at(self, values: Mapping[sp.Symbol, sp.Expr]) -> Matrix:
        """M with `values` in place of symbols, which shorten its entries before they are added."""
        if self.tree:
            return self.tree.mass_matrix(self.tree.inertia.xreplace(values))
        return self.mass_matrix.xreplace(values)

    @cached_property
    def kinetic_energy(self) -> sp.Expr:
        """T = ½ q̇ᵀ M q̇; with moving pivots also terms that are linear in q̇ or independent of it."""
        return self._quadratic(range(len(self.variables)))

    def _quadratic(self, variables: range) -> sp.Expr:
        """½ vᵀ M̄ v of some of the variables."""
        if not variables:
            return sp.S.Zero
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
        positions = (r for mass in masses for r in mass.placement)
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
        explicit = self.lagrangian if TIME in self.variables else -self.potential_energy
        return sp.Add(*work) - explicit.diff(TIME)


def _factored(expression: sp.Expr) -> sp.Expr:
    """The expression with common factors outside, where quotients or roots may cancel with them.

    Elsewhere factors stay in the terms, which share them with those of other entries.
    """
    powers = (one for one in expression.atoms(sp.Pow) if not one.is_number)
    if all(power.exp.is_Integer and power.exp.is_positive for power in powers):
        return expression
    short = is_expandable(expression, largest=MOST_FACTORED)
    return sp.factor_terms(expression) if short else expression
