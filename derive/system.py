"""A mechanical system: where its masses are, as functions of generalized coordinates."""

from __future__ import annotations

import keyword
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from derive.symbols import acceleration, momentum, variation, velocity

IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,39}\Z")

#: Words that a generated Python or C function needs for itself.
RESERVED = {
    *keyword.kwlist,
    *keyword.softkwlist,
    *"auto char const default do double enum extern float goto inline int long register".split(),
    *"restrict short signed sizeof static struct switch typedef union unsigned void".split(),
    *"volatile NULL NAN INFINITY sin cos tan exp log sqrt pi".split(),
    *"t params state result numpy math".split(),
}


class SystemDefinitionError(ValueError):
    """A system that cannot be derived; the message says which part and what is allowed."""


def formula(value: sp.Expr | float) -> sp.Expr:
    """A SymPy expression as it is, a Python number as the fraction that its digits say.

    Raises
    ------
    SystemDefinitionError
        For anything else, text above all: SymPy would execute it.
    """
    if isinstance(value, sp.Expr):
        return value
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            return sp.Rational(str(value))
        except (TypeError, ValueError):
            pass
    raise SystemDefinitionError(
        f"{str(value)[:50]!r} is no formula: use numbers and SymPy expressions"
    )


@dataclass(frozen=True)
class Coordinate:
    """A generalized coordinate: its symbol, its unit and what it measures."""

    symbol: sp.Symbol
    unit: str
    meaning: str


@dataclass(frozen=True)
class Parameter:
    """A constant of the system: its symbol, unit, default value and meaning.

    A symbol declared positive (``Symbol("l", positive=True)``) takes positive values only.
    """

    symbol: sp.Symbol
    unit: str
    default: float
    meaning: str


@dataclass(frozen=True)
class PointMass:
    """A mass and its position, two or three Cartesian components (the last one points up)."""

    mass: sp.Expr
    position: tuple[sp.Expr, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "mass", formula(self.mass))
        object.__setattr__(self, "position", tuple(map(formula, self.position)))


@dataclass(frozen=True)
class System:
    """Positions in: everything that the derivation needs to know of a system.

    Parameters
    ----------
    name : str
        Identifier; the generated module is called so.
    title : str
        One line for people.
    coordinates : sequence of Coordinate
        Generalized coordinates q, in the order of the state.
    parameters : sequence of Parameter
        Constants, in the order of ``params``.
    masses : sequence of PointMass
        Point masses with their positions r(q).
    potential : sympy.Expr, optional
        Potential energy V(q); by default uniform gravity along the last axis,
        downwards, with the parameter named ``g``.
    equilibrium : sequence of sympy.Expr, optional
        Coordinates about which ``linear`` describes small motions. By default
        zeros if the system is at rest there; else there is no ``linear``.

    Raises
    ------
    SystemDefinitionError
        When a name is no identifier, or is used twice or reserved; when an
        expression names an unknown symbol; when a position has not two or three
        components, or differs in their number from the others.
    """

    name: str
    title: str
    coordinates: Sequence[Coordinate]
    parameters: Sequence[Parameter]
    masses: Sequence[PointMass]
    potential: sp.Expr | None = None
    equilibrium: Sequence[sp.Expr] | None = None

    def __post_init__(self) -> None:
        for field in ("coordinates", "parameters", "masses"):
            object.__setattr__(self, field, tuple(getattr(self, field)))
        if self.potential is not None:
            object.__setattr__(self, "potential", formula(self.potential))
        if self.equilibrium is not None:
            object.__setattr__(self, "equilibrium", tuple(map(formula, self.equilibrium)))
        if not self.coordinates or not self.masses:
            raise SystemDefinitionError(
                f"system {self.name!r} needs at least one coordinate and one mass, "
                f"got {len(self.coordinates)} and {len(self.masses)}"
            )
        self._check_names()
        if len({len(mass.position) for mass in self.masses} | {self.dimension}) > 1 or not (
            2 <= self.dimension <= 3
        ):
            counts = ", ".join(str(len(mass.position)) for mass in self.masses)
            raise SystemDefinitionError(
                f"positions of system {self.name!r} have {counts} components; "
                "all must have two (x, up) or all three (x, y, up)"
            )
        if self.potential is None:
            object.__setattr__(self, "potential", self._gravity())
        self._check_symbols()

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
        """Symbols of small changes of the coordinates, then of the velocities."""
        return tuple(variation(s) for s in self.q + self.qdot)

    @cached_property
    def params(self) -> tuple[sp.Symbol, ...]:
        """The parameters' symbols."""
        return tuple(parameter.symbol for parameter in self.parameters)

    def _gravity(self) -> sp.Expr:
        g = next((s for s in self.params if s.name == "g"), None)
        if g is None:
            raise SystemDefinitionError(
                f"system {self.name!r} has no parameter named 'g' for its weight; add one, "
                "or give the potential yourself (potential=0 for none)"
            )
        return sp.Add(*(mass.mass * g * mass.position[-1] for mass in self.masses))

    def _check_names(self) -> None:
        declared = [s.name for s in (*self.q, *self.params)]
        for name in [self.name, *declared]:
            if not IDENTIFIER.match(name) or name in RESERVED:
                raise SystemDefinitionError(
                    f"{name[:50]!r} cannot be a name in system {self.name[:50]!r}: use a letter "
                    "and then up to 39 letters, digits or underscores, and no word that Python, "
                    "C or the generated functions reserve"
                )
        names = declared + [s.name for s in self.qdot + self.qddot + self.p + self.variations]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise SystemDefinitionError(
                f"system {self.name!r} uses a name twice: {', '.join(twice)} (velocities are "
                "named q_dot, accelerations q_ddot, momenta p_q, small changes delta_q)"
            )

    def _check_symbols(self) -> None:
        known = set(self.q + self.params)
        places = {
            f"the position of mass {mass.mass}": sp.Tuple(*mass.position) for mass in self.masses
        }
        places["the potential"] = self.potential
        for place, expression in places.items():
            unknown = sorted(str(s) for s in expression.free_symbols - known)
            if unknown:
                raise SystemDefinitionError(
                    f"{place} names unknown symbols: {', '.join(unknown)}; known are "
                    f"{', '.join(sorted(s.name for s in known))}; declare them as coordinates or "
                    "parameters (a symbol of the same name with other assumptions is another one)"
                )
        for mass in self.masses:
            if mass.mass.free_symbols - set(self.params):
                raise SystemDefinitionError(
                    f"mass {mass.mass} must depend on parameters alone; "
                    f"known are {', '.join(s.name for s in self.params)}"
                )
