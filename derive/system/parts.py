"""The parts of a system: coordinates, parameters, inputs and point masses."""

import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from numbers import Real
from typing import Any, ClassVar, Self

import sympy as sp
from sympy.core.function import AppliedUndef

from solvers.io.suggestion import shortened


class SystemDefinitionError(ValueError):
    """An invalid system; the message names the part, its value and what is allowed."""


def formula(value: sp.Expr | float) -> sp.Expr:
    """`value` as an exact real expression; decimals become fractions, and text is refused."""
    if isinstance(value, sp.Expr) and not _is_column_or_not_real(value):
        if value.has(AppliedUndef):
            raise SystemDefinitionError(
                f"{str(value)[:50]!r} contains a function of time: a coordinate is a symbol x, its "
                "velocity is derive.velocity(x), and time is derive.TIME"
            )
        return value.xreplace({n: sp.Rational(str(n)) for n in value.atoms(sp.Float)})
    if isinstance(value, Real) and not isinstance(value, bool):
        with suppress(TypeError, ValueError):
            return sp.Rational(str(value))
    raise SystemDefinitionError(
        f"{str(value)[:50]!r} is not a formula: use finite real numbers and SymPy expressions"
    )


def _is_column_or_not_real(value: sp.Expr) -> bool:
    # SymPy's immutable matrices are expressions
    return isinstance(value, sp.MatrixBase) or value.has(sp.I, sp.oo, -sp.oo, sp.zoo, sp.nan)


def formulas(name: str, values: object, contents: str) -> tuple[sp.Expr, ...]:
    """Each of `values` as a formula; a message calls them by `name` and requests `contents`."""
    return tuple(map(formula, items(name, values, contents)))


def items(name: str, values: object, contents: str, kind: type = object) -> tuple[Any, ...]:
    """`values` as a tuple; refused if they are no sequence, or one is not of the given kind."""
    if isinstance(values, sp.MatrixBase):
        values = values.flat()  # a position may be a column
    if not isinstance(values, Iterable) or isinstance(values, str):
        given = shortened(values)
        raise SystemDefinitionError(f"{name} = {given} is not a sequence: give {contents}")
    values = tuple(values)
    for value in values:
        if not isinstance(value, kind):
            raise SystemDefinitionError(f"{name} contains {shortened(value)}: give {contents}")
    return values


def _check_symbol(symbol: object) -> None:
    if not isinstance(symbol, sp.Symbol) or symbol.is_extended_real is False:
        raise SystemDefinitionError(
            f"{shortened(symbol)} is not a real symbol: declare Symbol(..., real=True), or "
            "positive=True, for a coordinate or parameter"
        )


def check_text(name: str, text: str) -> None:
    """Raise `SystemDefinitionError` if a text cannot be part of a comment or docstring."""
    if not text.isprintable() or any(mark in text for mark in ('"', "\\", "*/", "/*")):
        raise SystemDefinitionError(
            f"{name} is {text[:50]!r}: generated files contain it, so it must be one line "
            'without ", \\, /* and */'
        )


def _check_unit(name: str, unit: str) -> None:
    check_text(name, unit)
    if "," in unit:
        raise SystemDefinitionError(
            f"{name} is {unit[:50]!r}, with a comma, which separates columns of tables: write a "
            "product as N m, a quotient as m/s^2"
        )


@dataclass(frozen=True)
class Coordinate:
    """A generalized coordinate: its symbol, its unit and its meaning.

    Parameters
    ----------
    symbol : sympy.Symbol
        Real, or positive if it cannot change sign; generated code uses its name.
    unit : str
        Such as ``rad`` or ``m``; a coordinate in ``rad`` is an angle.
    meaning : str
        A description of one line.

    Raises
    ------
    SystemDefinitionError
        When `symbol` is not a real symbol; when `unit` or `meaning` is not one line that generated
        files can contain.

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
        _check_symbol(self.symbol)
        _check_unit(f"the unit of {self.symbol}", self.unit)
        check_text(f"the meaning of {self.symbol}", self.meaning)


@dataclass(frozen=True)
class Parameter:
    """A constant of the system: its symbol, unit, default value and meaning.

    Parameters
    ----------
    symbol : sympy.Symbol
        Generated code uses its name. A positive symbol (``Symbol("l", positive=True)``) allows
        positive values only.
    unit : str
        Such as ``kg`` or ``m/s^2``.
    default : float
        Its default value in `unit`.
    meaning : str
        A description of one line.

    Raises
    ------
    SystemDefinitionError
        When `symbol` is not a real symbol; when `default` is not a finite number, or not positive
        for a positive symbol; when `unit` or `meaning` is not one line that generated files can
        contain.

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
        _check_symbol(self.symbol)
        _check_unit(f"the unit of {self.symbol}", self.unit)
        check_text(f"the meaning of {self.symbol}", self.meaning)
        number, positive = self.default, self.symbol.is_positive
        is_real = isinstance(number, Real) and not isinstance(number, bool)
        is_real = is_real and abs(number) <= sys.float_info.max  # which NaN is not
        if not is_real or (positive and number <= 0):
            raise SystemDefinitionError(
                f"the default of {self.symbol} is {shortened(number)}: give a "
                f"{'positive' if positive else 'finite'} number in {self.unit}"
            )


@dataclass(frozen=True)
class Input:
    """A force, torque or other quantity that may change during a motion.

    In generated code an input is one of the parameters, after all others; its default value is 0.

    Parameters
    ----------
    symbol : sympy.Symbol
        Real, and not only positive; generated code uses its name.
    unit : str
        Such as ``N`` or ``N m``.
    meaning : str
        A description of one line.
    motion : bool, optional
        Whether it is a prescribed motion s, such as that of a pivot, on which positions can depend.
        Then the system has the inputs ``s``, ``s_dot``, ``s_ddot`` and ``s_time``: position,
        velocity and acceleration at that time. While they are constant, the acceleration is, and
        the motion is s + s_dot (t - s_time) + s_ddot (t - s_time)²/2.

    Raises
    ------
    SystemDefinitionError
        When `symbol` is not a real symbol, or cannot be 0; when `unit` or `meaning` is not one line
        that generated files can contain.

    Examples
    --------
    >>> from sympy import Symbol
    >>> Input(Symbol("F", real=True), "N", "force on the cart").default
    0.0
    """

    symbol: sp.Symbol
    unit: str
    meaning: str
    motion: bool = False
    default: ClassVar[float] = 0.0

    def __post_init__(self) -> None:
        _check_symbol(self.symbol)
        if self.symbol.is_zero is False:
            raise SystemDefinitionError(
                f"input {self.symbol} cannot be 0, its default value: declare "
                f"Symbol({self.symbol.name!r}, real=True)"
            )
        _check_unit(f"the unit of {self.symbol}", self.unit)
        check_text(f"the meaning of {self.symbol}", self.meaning)


@dataclass(frozen=True)
class PointMass:
    """A mass and its position, two or three Cartesian components (the last one points up).

    Parameters
    ----------
    mass : sympy.Expr or number
        In kg, a function of parameters.
    position : sequence of sympy.Expr or numbers
        (x, up) or (x, y, up) in m, as functions of coordinates, parameters and ``derive.TIME``.

    Raises
    ------
    SystemDefinitionError
        When the mass is not positive, or a value is neither a real expression nor a finite number.

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
        components = "the components (x, up) or (x, y, up)"
        object.__setattr__(self, "position", formulas("position", self.position, components))
        if self.mass.is_nonpositive:
            raise SystemDefinitionError(
                f"mass {self.mass} is not positive: give a positive number or symbol, or omit the "
                "point without mass"
            )

    @property
    def motions(self) -> tuple[tuple[sp.Expr, tuple[sp.Expr, ...]], ...]:
        """Pairs of inertia and position; half the inertia times the rate squared is energy."""
        return ((self.mass, self.position),)

    @property
    def turns(self) -> tuple[tuple[sp.Expr, tuple[tuple[int, ...], ...]], ...]:
        """Pairs of a moment of inertia and combinations of the angular velocity's components.

        Half the moment times the sum of their squares is energy.
        """
        return ()

    @property
    def inertia_matrix(self) -> sp.ImmutableDenseMatrix | None:
        """Its part of the mass matrix, if this is given in place of positions."""
        return None

    @property
    def placement(self) -> tuple[sp.Expr, ...]:
        """The functions of coordinates and time that place the mass."""
        return tuple(r for _, position in self.motions for r in position)

    @property
    def conditions(self) -> tuple[sp.Expr, ...]:
        """Functions of the coordinates that remain 0."""
        return ()

    @property
    def words(self) -> str:
        """Mass and position."""
        return f"{self.mass} at ({', '.join(map(str, self.position))})"

    def mapped(self, function: Callable[[sp.Expr], sp.Expr]) -> Self:
        """A copy with `function` applied to every expression."""
        values = {name: function(value) for name, value in vars(self).items() if name != "position"}
        return replace(self, position=tuple(map(function, self.position)), **values)
