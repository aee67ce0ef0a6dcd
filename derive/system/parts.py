"""What a system is made of: coordinates, parameters, and what has inertia."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from numbers import Real

import sympy as sp


class SystemDefinitionError(ValueError):
    """A system that cannot be derived; the message says which part and what is allowed."""


def formula(value: sp.Expr | float) -> sp.Expr:
    """A SymPy expression or a Python number, decimals as the fractions that their digits say.

    Parameters
    ----------
    value : sympy.Expr, int or float
        A number must be finite.

    Returns
    -------
    sympy.Expr
        Without floating-point numbers.

    Raises
    ------
    SystemDefinitionError
        For anything else, text above all: SymPy would execute it.
    """
    if isinstance(value, sp.Expr):
        return value.xreplace({n: sp.Rational(str(n)) for n in value.atoms(sp.Float)})
    if isinstance(value, Real) and not isinstance(value, bool):
        try:
            return sp.Rational(str(value))
        except (TypeError, ValueError):
            pass
    raise SystemDefinitionError(
        f"{str(value)[:50]!r} is no formula: use numbers and SymPy expressions"
    )


def _place(position: object) -> tuple[sp.Expr, ...]:
    if not isinstance(position, Iterable) or isinstance(position, str):
        raise SystemDefinitionError(
            f"position {str(position)[:50]!r} is no position: give its components, (x, up) or "
            "(x, y, up)"
        )
    return tuple(map(formula, position))


def check_text(place: str, text: str) -> None:
    """Refuse what would end a comment, a docstring or a text of a generated file.

    Parameters
    ----------
    place : str
        What the text is, for the message.
    text : str
        One line for people.

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
    """A generalized coordinate: its symbol, its unit and what it measures.

    Parameters
    ----------
    symbol : sympy.Symbol
        Real, or positive where it cannot change its sign; its name is that in generated code.
    unit : str
        Such as ``rad`` or ``m``; a coordinate in ``rad`` is taken for an angle.
    meaning : str
        One line for people.

    Raises
    ------
    SystemDefinitionError
        When `unit` or `meaning` is not one line that can stand in generated files.

    Examples
    --------
    >>> from sympy import Symbol
    >>> Coordinate(Symbol("theta", real=True), "rad", "from the downward vertical").unit
    'rad'
    """

    symbol: sp.Symbol
    unit: str
    meaning: str

    def __post_init__(self) -> None:
        check_text(f"the unit of {self.symbol}", self.unit)
        check_text(f"the meaning of {self.symbol}", self.meaning)


@dataclass(frozen=True)
class Parameter:
    """A constant of the system: its symbol, unit, default value and meaning.

    Parameters
    ----------
    symbol : sympy.Symbol
        Its name is that in generated code. One declared positive
        (``Symbol("l", positive=True)``) takes positive values only.
    unit : str
        Such as ``kg`` or ``m/s^2``.
    default : float
        Its value in `unit` where nobody gives another.
    meaning : str
        One line for people.

    Raises
    ------
    SystemDefinitionError
        When `unit` or `meaning` is not one line that can stand in generated files.

    Examples
    --------
    >>> from sympy import Symbol
    >>> Parameter(Symbol("g", real=True), "m/s^2", 9.81, "gravity").default
    9.81
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
    """A mass and its position, two or three Cartesian components (the last one points up).

    Parameters
    ----------
    mass : sympy.Expr or number
        In kg, made of parameters.
    position : sequence of sympy.Expr or numbers
        (x, up) or (x, y, up) in m, as functions of coordinates, parameters and ``derive.TIME``.

    Raises
    ------
    SystemDefinitionError
        When the mass cannot be positive, or something is neither an expression nor a number.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, k, m = symbols("x k m", real=True)
    >>> PointMass(m, (x, k * x**2)).position
    (x, k*x**2)
    """

    mass: sp.Expr
    position: tuple[sp.Expr, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "mass", formula(self.mass))
        object.__setattr__(self, "position", _place(self.position))
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

    Parameters
    ----------
    mass : sympy.Expr or number
        In kg, made of parameters.
    position : sequence of sympy.Expr or numbers
        The centre of mass, (x, up) in m.
    inertia : sympy.Expr or number
        Moment of inertia about the centre of mass in kg m²: m l²/12 for a uniform bar.
    angle : sympy.Expr or number
        Any angle in rad that turns with the body.

    Raises
    ------
    SystemDefinitionError
        When the mass cannot be positive, or the moment of inertia is negative; when the
        position has not two components, or something is neither an expression nor a number.

    Examples
    --------
    >>> from sympy import cos, sin, symbols
    >>> from derive import RigidBody
    >>> m, length, theta = symbols("m l theta", real=True, positive=True)
    >>> centre = (length * sin(theta) / 2, -length * cos(theta) / 2)
    >>> RigidBody(m, centre, inertia=m * length**2 / 12, angle=theta).inertia
    l**2*m/12
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
