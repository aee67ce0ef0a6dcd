"""A mechanical system: positions of masses as functions of generalized coordinates."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from derive.system.naming import check_name, check_unique
from derive.system.parts import (
    Coordinate,
    Parameter,
    PointMass,
    SystemDefinitionError,
    check_text,
    formula,
)
from derive.system.symbols import TIME, acceleration, momentum, variation, velocity


@dataclass(frozen=True)
class System:
    """A holonomic system: coordinates, parameters, masses and forces.

    Parameters
    ----------
    name : str
        Identifier, also the name of the generated module.
    title : str
        A description of one line.
    coordinates : sequence of Coordinate
        Generalized coordinates q, in the order of the state.
    parameters : sequence of Parameter
        Constants, in the order of ``params``.
    masses : sequence of PointMass and RigidBody
        Masses and bodies, with positions r(q, t) in m; time is ``derive.TIME``.
    potential : sympy.Expr, optional
        Potential energy V(q, t) in J without that of `gravity`. If neither is given, there is
        uniform gravity along the last axis, downwards, with the parameter named ``g``.
    gravity : sequence of sympy.Expr, optional
        Acceleration of free fall, one component for each of a position's, in m/s².
    dissipation : sympy.Expr, optional
        Rayleigh's function R(q, q̇, t) in W: the force is -∂R/∂q̇. If it is quadratic in the
        velocities (``derive.velocity(theta)``), it is half the dissipated power.
    forces : sequence of sympy.Expr, optional
        Further generalized forces Q(q, q̇, t), one for each coordinate: in N along a length,
        in N m about an angle.
    equilibrium : sequence of sympy.Expr, optional
        Coordinates of the equilibrium about which ``linear`` describes small motions. By
        default zeros if they are an equilibrium; otherwise there is no ``linear``.
    reactions : sequence of sympy.Symbol, optional
        Parameters, such as lengths of rods, whose constraint forces are requested: a rod's
        tension.

    Raises
    ------
    SystemDefinitionError
        When there is no coordinate or no mass; when `title` is not one line that generated
        files can contain; when a name is no identifier, reserved or used twice; when a value
        is neither an expression nor a number, or contains an unknown symbol; when positions
        do not all have two or all three components; when `gravity` or `forces` has a wrong
        number of components, or weight needs a parameter named ``g``; when `dissipation`
        depends on no velocity; when `reactions` are combined with applied forces.

    Examples
    --------
    >>> from sympy import symbols
    >>> from derive import Coordinate, Derivation, Parameter, PointMass
    >>> x, g = symbols("x g", real=True)
    >>> m = symbols("m", positive=True)
    >>> ball = System(
    ...     "ball", "A ball on a ramp of 45 degrees", [Coordinate(x, "m", "along the ground")],
    ...     [Parameter(m, "kg", 1.0, "mass"), Parameter(g, "m/s^2", 9.81, "gravity")],
    ...     [PointMass(m, (x, -x))],
    ... )
    >>> Derivation(ball).accelerations[0]
    g/2
    """

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

    def __post_init__(self) -> None:
        for field in ("coordinates", "parameters", "masses", "reactions"):
            object.__setattr__(self, field, tuple(getattr(self, field)))
        for field in ("gravity", "forces", "equilibrium"):
            if getattr(self, field) is not None:
                object.__setattr__(self, field, tuple(map(formula, getattr(self, field))))
        for field in ("potential", "dissipation"):
            if getattr(self, field) is not None:
                object.__setattr__(self, field, formula(getattr(self, field)))
        if not self.coordinates or not self.masses:
            raise SystemDefinitionError(
                f"system {self.name!r} needs at least one coordinate and one mass, "
                f"got {len(self.coordinates)} and {len(self.masses)}"
            )
        check_text(f"the title of system {self.name!r}", self.title)
        self._check_names()
        self._check_counts()
        self._check_symbols()
        self._check_weight()

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
    def params(self) -> tuple[sp.Symbol, ...]:
        """The parameters' symbols."""
        return tuple(parameter.symbol for parameter in self.parameters)

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

    def _check_names(self) -> None:
        declared = [s.name for s in (*self.q, *self.params)]
        for name in [self.name, *declared]:
            check_name(name, self.name)
        derived = self.qdot + self.qddot + self.p + self.variations
        waves = (f"{wave}_{q.name}" for q in self.q for wave in ("sin", "cos"))
        check_unique([*declared, *(s.name for s in derived), *waves], self.name)

    def _check_counts(self) -> None:
        if len({len(mass.position) for mass in self.masses}) > 1 or not 2 <= self.dimension <= 3:
            counts = ", ".join(str(len(mass.position)) for mass in self.masses)
            raise SystemDefinitionError(
                f"positions of system {self.name!r} have {counts} components: give all two "
                "(x, up) or all three (x, y, up)"
            )
        for field, count in (("gravity", self.dimension), ("forces", len(self.q))):
            given = getattr(self, field) or ()
            if len(given) not in (0, count):
                raise SystemDefinitionError(
                    f"{field} of system {self.name!r} has {len(given)} components: give {count}"
                )

    def _expressions(self) -> Iterator[tuple[str, sp.Basic, set[sp.Symbol]]]:
        """Every expression: its name, itself, and the symbols that it may depend on."""
        constants, moving = {*self.params}, {*self.q, *self.params, TIME}
        for mass in self.masses:
            for inertia, position in mass.motions:
                yield f"mass {inertia}", inertia, constants
                yield f"the position of mass {inertia}", sp.Tuple(*position), moving
        yield "the potential", self.potential_energy, moving
        yield "the equilibrium", sp.Tuple(*(self.equilibrium or ())), constants
        yield "the list of forces", sp.Tuple(self.dissipation, *self.forces), {*self.qdot, *moving}
        yield "the list of reactions", sp.Tuple(*self.reactions), constants

    def _check_weight(self) -> None:
        used = set().union(*(expression.free_symbols for _, expression, _ in self._expressions()))
        weightless = self.potential is not None and self.gravity is None
        if weightless and any(s.name == "g" and s not in used for s in self.params):
            down = ", ".join(["0"] * (self.dimension - 1) + ["-g"])
            raise SystemDefinitionError(
                f"parameter 'g' of system {self.name!r} is not used: a system with a potential has "
                f"weight only if gravity is given; give gravity=({down}), the acceleration of free "
                "fall, or omit g"
            )

    def _check_symbols(self) -> None:
        for name, expression, known in self._expressions():
            unknown = sorted(str(s) for s in expression.free_symbols - known)
            if unknown:
                raise SystemDefinitionError(
                    f"{name} contains unknown symbols: {', '.join(unknown)}; known are "
                    f"{', '.join(sorted(s.name for s in known))}; declare them as coordinates or "
                    "parameters (a symbol of the same name with other assumptions is different)"
                )
        if self.dissipation and not self.dissipation.free_symbols & {*self.qdot}:
            raise SystemDefinitionError(
                f"the dissipation of system {self.name!r} is {self.dissipation}, which depends on "
                "no velocity: give Rayleigh's function, such as c*theta_dot**2/2"
            )
        if self.reactions and any(self.applied):
            raise SystemDefinitionError(
                f"system {self.name!r} has reactions and applied forces: the components of applied "
                "forces along a constant length are not known; omit one of them"
            )
