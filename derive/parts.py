"""What a system is made of: coordinates, parameters, and what has inertia."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import sympy as sp


class SystemDefinitionError(ValueError):
    """A system that cannot be derived; the message says which part and what is allowed."""


def formula(value: sp.Expr | float) -> sp.Expr:
    """A SymPy expression or a Python number, decimals as the fractions that their digits say.

    Raises
    ------
    SystemDefinitionError
        For anything else, text above all: SymPy would execute it.
    """
    if isinstance(value, sp.Expr):
        return value.xreplace({n: sp.Rational(str(n)) for n in value.atoms(sp.Float)})
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            return sp.Rational(str(value))
        except (TypeError, ValueError):
            pass
    raise SystemDefinitionError(
        f"{str(value)[:50]!r} is no formula: use numbers and SymPy expressions"
    )


def check_text(place: str, text: str) -> None:
    """Refuse what would end a comment, a docstring or a text of a generated file.

    Raises
    ------
    SystemDefinitionError
        With what is allowed.
    """
    if not text.isprintable() or any(mark in text for mark in ('"', "\\", "*/", "/*")):
        raise SystemDefinitionError(
            f"{place} is {text[:50]!r}: it stands in generated files, so that it must be one line "
            'without ", \\, /* and */'
        )


@dataclass(frozen=True)
class Coordinate:
    """A generalized coordinate: its symbol, its unit and what it measures."""

    symbol: sp.Symbol
    unit: str
    meaning: str

    def __post_init__(self) -> None:
        check_text(f"the unit of {self.symbol}", self.unit)
        check_text(f"the meaning of {self.symbol}", self.meaning)


@dataclass(frozen=True)
class Parameter:
    """A constant of the system: its symbol, unit, default value and meaning.

    A symbol declared positive (``Symbol("l", positive=True)``) takes positive values only.
    """

    symbol: sp.Symbol
    unit: str
    default: float
    meaning: str

    def __post_init__(self) -> None:
        check_text(f"the unit of {self.symbol}", self.unit)
        check_text(f"the meaning of {self.symbol}", self.meaning)


@dataclass(frozen=True)
class PointMass:
    """A mass and its position, two or three Cartesian components (the last one points up)."""

    mass: sp.Expr
    position: tuple[sp.Expr, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "mass", formula(self.mass))
        object.__setattr__(self, "position", tuple(map(formula, self.position)))
        if self.mass.is_nonpositive:
            raise SystemDefinitionError(
                f"mass {self.mass} is not positive: give a number or a positive symbol, or leave "
                "out what has no mass"
            )

    @property
    def motions(self) -> tuple[tuple[sp.Expr, tuple[sp.Expr, ...]], ...]:
        """What moves, each with its inertia: half the inertia times its rate² is energy."""
        return ((self.mass, self.position),)

    @property
    def words(self) -> str:
        """What it is, and where."""
        return f"{self.mass} at ({', '.join(map(str, self.position))})"

    def mapped(self, function: Callable[[sp.Expr], sp.Expr]) -> PointMass:
        """The same with every expression replaced by what `function` makes of it."""
        return PointMass(function(self.mass), tuple(map(function, self.position)))


@dataclass(frozen=True)
class RigidBody(PointMass):
    """A rigid body in the plane: mass, centre of mass (x, up), moment of inertia, orientation.

    The moment of inertia is about the centre of mass, m l²/12 for a uniform bar; the angle
    is any one that turns with the body.
    """

    inertia: sp.Expr
    angle: sp.Expr

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "inertia", formula(self.inertia))
        object.__setattr__(self, "angle", formula(self.angle))
        if self.inertia.is_negative:
            raise SystemDefinitionError(f"moment of inertia {self.inertia} is negative")
        if len(self.position) != 2:
            raise SystemDefinitionError(
                f"the body of mass {self.mass} has a position of {len(self.position)} components: "
                "rigid bodies move in the plane, with two (x, up)"
            )

    @property
    def motions(self) -> tuple[tuple[sp.Expr, tuple[sp.Expr, ...]], ...]:
        """The centre of mass, and the orientation."""
        return ((self.mass, self.position), (self.inertia, (self.angle,)))

    @property
    def words(self) -> str:
        """What it is, where, and how it is turned."""
        return f"{super().words}, moment of inertia {self.inertia}, turned by {self.angle}"

    def mapped(self, function: Callable[[sp.Expr], sp.Expr]) -> RigidBody:
        """The same with every expression replaced by what `function` makes of it."""
        mass, position = function(self.mass), tuple(map(function, self.position))
        return RigidBody(mass, position, function(self.inertia), function(self.angle))
