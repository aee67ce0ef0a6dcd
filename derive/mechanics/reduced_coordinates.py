"""Fewest coordinates: constraints that can be solved for coordinates are eliminated.

Each constraint φ is solved as φ = ε. The derivatives of the coordinates by ε are displacements that
only this constraint prevents, so that its multiplier is their work, λ = Σ (M q̈ - f - Gᵀ μ)_i
∂q_i/∂ε at ε = 0, with the multipliers μ of the remaining constraints (C. Lanczos, The Variational
Principles of Mechanics, chapters II.5 and III.5).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import sympy as sp

from derive.formulas.functions import derivative
from derive.formulas.zero import vanishes
from derive.mechanics.derivation import warn_of_redundancy
from derive.mechanics.equations import Equations
from derive.system.constraints import Constraint, Eliminated
from derive.system.parts import SystemDefinitionError
from derive.system.symbols import TIME, prescribed_symbols
from derive.system.system import System, as_system

#: A coordinate from a formula that is 0; None if its value is not unique.
Solver: TypeAlias = Callable[[sp.Expr, sp.Symbol], sp.Expr | None]
NOTHING = sp.S.Zero


def reduced(system: System) -> System:
    """The system without the coordinates that its constraints determine.

    A constraint determines a coordinate on which it depends linearly, with a coefficient that
    cannot be 0, such as a number or a positive parameter; and a positive coordinate, of which it is
    a quadratic equation with one positive root. No branch is chosen otherwise: x² + y² = l² remains
    a constraint, unless x or y is declared positive. Of several coordinates, the last one that is
    not declared positive is eliminated. Modules are generated of reduced systems; a system with
    ``keep_coordinates=True`` remains as it is.

    Parameters
    ----------
    system : System
        A system.

    Returns
    -------
    System
        Its ``eliminated`` has the formulas of the eliminated coordinates, their constraints and
        the multipliers of these. Eliminated coordinates and their velocities become ``outputs``.
        Other constraints remain.

    Raises
    ------
    SystemDefinitionError
        When a constraint contradicts others.

    Warns
    -----
    derive.mechanics.derivation.RedundancyWarning
        When a constraint follows from others.

    Examples
    --------
    >>> from sympy import cos, sin, symbols
    >>> from derive import Coordinate, Parameter, PointMass, System
    >>> x, y, theta, g = symbols("x y theta g", real=True)
    >>> m, l = symbols("m l", positive=True)
    >>> pendulum = System(
    ...     "pendulum", "A pendulum", [Coordinate(x, "m", "to the right"),
    ...     Coordinate(y, "m", "upwards"), Coordinate(theta, "rad", "of the rod")],
    ...     [Parameter(m, "kg", 1.0, "mass"), Parameter(l, "m", 1.0, "length"),
    ...     Parameter(g, "m/s^2", 9.81, "gravity")], [PointMass(m, (x, y))],
    ...     coincide=[((x, y), (l * sin(theta), -l * cos(theta)))])
    >>> reduced(pendulum).q
    (theta,)
    >>> {one.coordinate.symbol: one.formula for one in reduced(pendulum).eliminated}
    {x: l*sin(theta), y: -l*cos(theta)}
    """
    if as_system(system).keep_coordinates:
        return system
    solutions, remaining = _solved(system)
    return _Reduction(system, solutions, remaining).system if solutions else system


@dataclass(frozen=True)
class _Solution:
    """A constraint solved for a coordinate."""

    constraint: Constraint
    q: sp.Symbol
    change: sp.Symbol  # ε
    formula: sp.Expr  # of q, where the constraint has the value ε


def _solved(system: System) -> tuple[list[_Solution], dict[Constraint, sp.Expr]]:
    """Solutions, none of which contains the coordinate of another, and remaining constraints."""
    solutions: list[_Solution] = []
    remaining, q = {one: one.formula for one in system.conditions}, [*system.q]
    while len(q) > 1 and (solution := _next_solution(system, remaining, q)):
        q.remove(solution.q)
        del remaining[solution.constraint]
        value = {solution.q: solution.formula}
        remaining = {one: formula.xreplace(value) for one, formula in remaining.items()}
        solutions = [replace(one, formula=one.formula.xreplace(value)) for one in solutions]
        solutions.append(solution)
    return solutions, remaining


def _next_solution(
    system: System, formulas: dict[Constraint, sp.Expr], coordinates: list[sp.Symbol]
) -> _Solution | None:
    # positions must not depend on inputs other than prescribed motions
    prescribed = prescribed_symbols(system.inputs)
    excluded, moving = {*system.u} - prescribed, {*system.qdot}
    stages: tuple[tuple[Solver, bool], ...] = (
        (_divided_by_number, False),
        (_divided, False),
        (_root, True),
        (_divided, True),
    )
    for solver, is_positive in stages:
        for constraint, formula in formulas.items():
            if formula.free_symbols & moving:  # no velocity determines a coordinate
                continue
            for q in reversed(coordinates):
                if bool(q.is_positive) != is_positive or q not in formula.free_symbols:
                    continue
                change = sp.Dummy(constraint.name, real=True)
                value = solver(formula - change, q)
                if value is not None and not value.free_symbols & excluded:
                    return _Solution(constraint, q, change, value)
    return None


def _divided_by_number(formula: sp.Expr, q: sp.Symbol) -> sp.Expr | None:
    return _divided(formula, q) if derivative(formula, q).is_number else None


def _divided(formula: sp.Expr, q: sp.Symbol) -> sp.Expr | None:
    """The solution of a linear equation with a coefficient that cannot be 0."""
    coefficient = derivative(formula, q)
    if q in coefficient.free_symbols:
        coefficient = sp.expand(coefficient)
    if q in coefficient.free_symbols or coefficient.is_zero is not False:
        return None
    return -formula.xreplace({q: NOTHING}) / coefficient


def _root(formula: sp.Expr, q: sp.Symbol) -> sp.Expr | None:
    """The positive root of a quadratic equation, if it has not more than one."""
    try:
        coefficients = sp.Poly(formula, q).all_coeffs()
    except sp.PolynomialError:  # other functions of q
        return None
    if len(coefficients) != 3 or coefficients[0].is_zero is not False:
        return None
    half, product = coefficients[1] / coefficients[0] / 2, coefficients[2] / coefficients[0]
    at_rest = product.xreplace(dict.fromkeys(product.atoms(sp.Dummy), NOTHING))
    if half != 0 and not at_rest.is_negative:
        return None
    return sp.sqrt(half**2 - product) - half


@dataclass(frozen=True)
class _Reduction:
    """Formulas in place of coordinates, in every part of a system."""

    given: System
    solutions: list[_Solution]
    remaining: dict[Constraint, sp.Expr]

    @property
    def system(self) -> System:
        """The reduced system."""
        given, new, n = self.given, self._new, range(len(self.given.q))
        kept = [i for i in n if given.q[i] not in self._formulas]
        dissipation, equilibrium = new(given.dissipation), given.equilibrium
        measured = {s.name: x for s, x in self._motion.items() if s not in (*given.qddot,)}
        return replace(
            given,
            coordinates=[given.coordinates[i] for i in kept],
            masses=[mass.mapped(new) for mass in given.masses],
            potential=None if given.potential is None else new(given.potential),
            # friction of a prescribed motion is that of no coordinate
            dissipation=dissipation if dissipation.free_symbols & {*self._qdot} else NOTHING,
            forces=[self._force(given.q[i]) for i in kept] if given.forces else (),
            equilibrium=equilibrium and [equilibrium[i] for i in kept],
            outputs=measured | {name: new(value) for name, value in given.measured},
            constraints=self._constraints,
            links=[link.mapped(new) for link in given.links],
            eliminated=[*(one.mapped(new) for one in given.eliminated), *self._eliminated],
        )

    @cached_property
    def _formulas(self) -> dict[sp.Symbol, sp.Expr]:
        """Eliminated coordinates as functions of the others, in the order of the system."""
        at_zero = {one.change: NOTHING for one in self.solutions}
        formulas = {one.q: one.formula.xreplace(at_zero) for one in self.solutions}
        return {q: formulas[q] for q in self.given.q if q in formulas}

    @cached_property
    def _motion(self) -> dict[sp.Symbol, sp.Expr]:
        """Eliminated coordinates, their velocities and accelerations, by those of the others."""
        motion = dict(self._formulas)
        q, qdot, qddot = self.given.q, self.given.qdot, self.given.qddot
        pairs = [(s, v) for s, v in zip(q + qdot, qdot + qddot, strict=True)]
        for s, rate in pairs:
            if s in motion:
                terms = (derivative(motion[s], other) * v for other, v in pairs)
                motion[rate] = sp.Add(*terms, derivative(motion[s], TIME))
        return motion

    def _new(self, formula: sp.Expr) -> sp.Expr:
        return formula.xreplace(self._motion)

    @property
    def _qdot(self) -> list[sp.Symbol]:
        return [v for v in self.given.qdot if v not in self._motion]

    def _force(self, q: sp.Symbol) -> sp.Expr:
        """Σ Q_i ∂q_i/∂q: the work of all forces along a change of q."""
        pairs = zip(self.given.q, self.given.forces, strict=True)
        work = (force * derivative(self._formulas.get(s, s), q) for s, force in pairs)
        return self._new(sp.Add(*work))

    @cached_property
    def _constraints(self) -> list[Constraint]:
        constraints = []
        for one in self.remaining:
            formula = self._new(one.formula)
            if _vanishes(formula):
                warn_of_redundancy(self.given, [one])
                continue
            if not formula.free_symbols & {*self.given.q, *self._qdot}:
                others = ", ".join(solution.constraint.name for solution in self.solutions)
                raise SystemDefinitionError(
                    f"constraint {one.name} of system {self.given.name!r} contradicts {others}, "
                    f"with which it is {formula} = 0: omit one of them"
                )
            constraints.append(one.with_formula(formula))
        return constraints

    @property
    def _eliminated(self) -> list[Eliminated]:
        given, at_zero = self.given, {one.change: NOTHING for one in self.solutions}
        kept, by_coordinate = self._constraints, {one.q: one for one in self.solutions}
        names = {one.name for one in kept} | {one.constraint.name for one in self.solutions}
        order = [one.name for one in given.conditions if one.name in names]
        missing = {s: NOTHING for s in given.multipliers if s not in {one.symbol for one in kept}}
        # M q̈ - f - Gᵀ μ, which the eliminated constraints alone keep from being 0
        rows = zip(given.q, Equations(given).euler_lagrange, strict=True)
        forces = {q: self._new(row.xreplace(missing)) for q, row in rows if q in self._formulas}
        coordinates = {part.symbol: part for part in given.coordinates}
        result = []
        for q, formula in self._formulas.items():
            change = by_coordinate[q].change
            work = (
                forces[one.q] * derivative(one.formula, change).xreplace(at_zero)
                for one in self.solutions
            )
            constraint = by_coordinate[q].constraint
            index = order.index(constraint.name)
            part = Eliminated(coordinates[q], constraint, formula, sp.Add(*work), index)
            result.append(part)
        return result


def _vanishes(formula: sp.Expr) -> bool:
    try:
        return vanishes(formula)
    except NotImplementedError:  # other functions than sines and cosines
        return sp.expand(formula) == 0
