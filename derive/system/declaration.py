"""The declared parts of a system, and the symbols and formulas that follow from them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import cast

import sympy as sp

from derive.system.constraints import Constraint, Eliminated, Point
from derive.system.line_links import Link, Shape
from derive.system.parts import Coordinate, Input, Parameter, PointMass, SystemDefinitionError
from derive.system.symbols import acceleration, momentum, variation, velocity


@dataclass(frozen=True)
class Declaration:
    """The parts of a `System`, which describes and checks them."""

    name: str
    title: str
    coordinates: Sequence[Coordinate]
    parameters: Sequence[Parameter]
    masses: Sequence[PointMass]
    potential: sp.Expr | None = None
    gravity: Sequence[sp.Expr] | None = None
    dissipation: sp.Expr = sp.S.Zero
    forces: Sequence[sp.Expr] = ()
    equilibrium: Sequence[sp.Expr] | None = None
    reactions: Sequence[sp.Symbol] = ()
    inputs: Sequence[Input] = ()
    outputs: Mapping[str, sp.Expr] | Sequence[tuple[str, sp.Expr]] = ()
    constraints: Sequence[Constraint | sp.Expr] = ()
    coincide: Sequence[tuple[Point, Point]] = ()
    links: Sequence[Link] = ()
    keep_coordinates: bool = False
    eliminated: Sequence[Eliminated] = ()

    @property
    def measured(self) -> tuple[tuple[str, sp.Expr], ...]:
        """Names and formulas of the outputs."""
        return cast("tuple[tuple[str, sp.Expr], ...]", self.outputs)

    @property
    def conditions(self) -> tuple[Constraint, ...]:
        """The constraints."""
        return cast("tuple[Constraint, ...]", self.constraints)

    @property
    def all_conditions(self) -> tuple[Constraint, ...]:
        """The constraints with those that were eliminated, in their first order."""
        conditions = [*self.conditions]
        for one in sorted(self.eliminated, key=lambda one: one.index):
            conditions.insert(one.index, one.constraint)
        return tuple(conditions)

    @cached_property
    def multipliers(self) -> tuple[sp.Symbol, ...]:
        """The multipliers' symbols, one for each constraint."""
        return tuple(one.symbol for one in self.conditions)

    @cached_property
    def shapes(self) -> tuple[Shape, ...]:
        """The lines and areas of the links: kinds, and the points that determine them."""
        return tuple(chain(*(link.shapes(self.masses) for link in self.links)))

    @cached_property
    def points(self) -> tuple[tuple[sp.Expr, ...], ...]:
        """The points of the links."""
        return tuple(dict.fromkeys(point for _, points in self.shapes for point in points))

    @property
    def dimension(self) -> int:
        """Number of Cartesian components of a position."""
        return len(self.masses[0].position)

    @cached_property
    def q(self) -> tuple[sp.Symbol, ...]:
        """The coordinates' symbols."""
        return tuple(coordinate.symbol for coordinate in self.coordinates)

    @cached_property
    def qdot(self) -> tuple[sp.Symbol, ...]:
        """Symbols of the generalized velocities."""
        return tuple(velocity(q) for q in self.q)

    @cached_property
    def qddot(self) -> tuple[sp.Symbol, ...]:
        """Symbols of the generalized accelerations."""
        return tuple(acceleration(q) for q in self.q)

    @cached_property
    def p(self) -> tuple[sp.Symbol, ...]:
        """Symbols of the conjugate momenta."""
        return tuple(momentum(q) for q in self.q)

    @cached_property
    def variations(self) -> tuple[sp.Symbol, ...]:
        """Symbols of linear perturbations of the coordinates, then of the velocities."""
        return tuple(variation(s) for s in self.q + self.qdot)

    @cached_property
    def parameter_variations(self) -> tuple[sp.Symbol, ...]:
        """Symbols of perturbations of the parameters and, after them, of the inputs."""
        return tuple(map(variation, self.params))

    @cached_property
    def params(self) -> tuple[sp.Symbol, ...]:
        """Symbols of the parameters and, after them, of the inputs."""
        return tuple(part.symbol for part in self.parameters_and_inputs)

    @cached_property
    def u(self) -> tuple[sp.Symbol, ...]:
        """The inputs' symbols."""
        return tuple(part.symbol for part in self.inputs)

    @property
    def parameters_and_inputs(self) -> tuple[Parameter | Input, ...]:
        """In the order of ``params`` in generated code."""
        return (*self.parameters, *self.inputs)

    @cached_property
    def potential_energy(self) -> sp.Expr:
        """V(q, t), including gravity."""
        gravity, potential = self.gravity, self.potential
        if potential is None and gravity is None:
            gravity = (*[sp.S.Zero] * (self.dimension - 1), -self._named_gravity())
        weights = (
            -mass.mass * a * r
            for mass in self.masses
            for a, r in zip(gravity or (), mass.position, strict=bool(gravity))
        )
        return sp.Add(potential or sp.S.Zero, *weights)

    @cached_property
    def applied(self) -> tuple[sp.Expr, ...]:
        """Generalized forces without a potential: Q - ∂R/∂q̇, one for each coordinate."""
        forces = self.forces or (sp.S.Zero,) * len(self.q)
        pairs = zip(forces, self.qdot, strict=True)
        return tuple(force - self.dissipation.diff(qdot) for force, qdot in pairs)

    def _named_gravity(self) -> sp.Symbol:
        for symbol in self.params:
            if symbol.name == "g":
                return symbol
        raise SystemDefinitionError(
            f"system {self.name!r} has no parameter named 'g' for its weight: add one, or give "
            "the potential (potential=0 for none)"
        )
