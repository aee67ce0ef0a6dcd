"""Links between points of pictures: their base, and rods, threads, springs, rails and plates."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self, TypeAlias

import sympy as sp

from derive.system.parts import PointMass, SystemDefinitionError, formulas
from solvers.io.suggestion import shortened

#: A place in a picture: the number of a mass, from 0, or the components of a position in m.
Place: TypeAlias = int | Sequence[sp.Expr]
Point: TypeAlias = tuple[sp.Expr, ...]
#: A drawn line or area: its kind, and the points that determine it.
Shape: TypeAlias = tuple[str, tuple[Point, ...]]

POINT = "the number of a mass, from 0, or the components of a position"


class Link(ABC):
    """A part of a picture, whose points move with the system."""

    @abstractmethod
    def shapes(self, masses: Sequence[PointMass]) -> Iterator[Shape]:
        """Its lines and areas."""

    @abstractmethod
    def mapped(self, function: Callable[[sp.Expr], sp.Expr]) -> Self:
        """A copy with `function` applied to every expression."""


def checked_place(name: str, place: object) -> int | Point:
    """A place in a link called `name`; `SystemDefinitionError` where it is neither of these."""
    if isinstance(place, bool) or not isinstance(place, int | Sequence) or isinstance(place, str):
        raise SystemDefinitionError(f"{name} contains {shortened(place)}: give {POINT}")
    return place if isinstance(place, int) else formulas(name, place, POINT)


def position(link: Link, place: Place, masses: Sequence[PointMass]) -> Point:
    """The components of a place of a link."""
    name, dimension = type(link).__name__, len(masses[0].position)
    if not isinstance(place, int):
        if len(place) != dimension:
            raise SystemDefinitionError(
                f"{name} has a point of {len(place)} components: give {dimension}, as of the masses"
            )
        return tuple(place)
    if not 0 <= place < len(masses):
        raise SystemDefinitionError(
            f"{name} names mass {place}: masses are numbered from 0 to {len(masses) - 1}"
        )
    return masses[place].position


def mapped(value: Any, function: Callable[[sp.Expr], sp.Expr]) -> Any:
    """The value with `function` applied to the expressions in it."""
    if isinstance(value, tuple):
        return tuple(mapped(item, function) for item in value)
    return function(value) if isinstance(value, sp.Basic) else value


@dataclass(frozen=True, init=False)
class Line(Link):
    """A line through points, such as a `Rod`."""

    points: tuple[int | Point, ...]
    kind: ClassVar[str]
    fewest: ClassVar[int] = 2

    def __init__(self, *points: Place) -> None:
        name = type(self).__name__
        object.__setattr__(self, "points", tuple(checked_place(name, point) for point in points))
        if len(points) < self.fewest:
            raise SystemDefinitionError(
                f"{name} has {len(points)} points: give {self.fewest} at least, each {POINT}"
            )

    def shapes(self, masses: Sequence[PointMass]) -> Iterator[Shape]:
        """The line."""
        yield self.kind, tuple(position(self, point, masses) for point in self.points)

    def mapped(self, function: Callable[[sp.Expr], sp.Expr]) -> Self:
        """A copy with `function` applied to every expression."""
        return type(self)(*(mapped(point, function) for point in self.points))


class Rod(Line):
    """A rigid bar through two or more points.

    Parameters
    ----------
    *points : int or sequence of sympy.Expr
        Two points at least: each the number of a mass, from 0, or the components of a position in
        m, functions of coordinates, parameters and ``derive.TIME``.

    Raises
    ------
    SystemDefinitionError
        When there are fewer points, or a point is neither of these.

    Examples
    --------
    >>> from sympy import symbols
    >>> from derive import Rod
    >>> x, y = symbols("x y", real=True)
    >>> Rod((0, 0), (x, y), 0).points
    ((0, 0), (x, y), 0)
    """

    kind = "rod"


class Thread(Line):
    """A thread, belt or cable through two or more points, such as those of pulleys.

    Parameters
    ----------
    *points : int or sequence of sympy.Expr
        Two points at least: each the number of a mass, from 0, or the components of a position in
        m, functions of coordinates, parameters and ``derive.TIME``.

    Raises
    ------
    SystemDefinitionError
        When there are fewer points, or a point is neither of these.

    Examples
    --------
    >>> from derive import Thread
    >>> Thread(0, (0, 0), (1, 0), 1).points
    (0, (0, 0), (1, 0), 1)
    """

    kind = "thread"


class Spring(Line):
    """A spring through two or more points.

    Parameters
    ----------
    *points : int or sequence of sympy.Expr
        Two points at least: each the number of a mass, from 0, or the components of a position in
        m, functions of coordinates, parameters and ``derive.TIME``.

    Raises
    ------
    SystemDefinitionError
        When there are fewer points, or a point is neither of these.

    Examples
    --------
    >>> from derive import Spring
    >>> Spring(0, 1).points
    (0, 1)
    """

    kind = "spring"


class Rail(Line):
    """A guide: the straight line through two points, without ends.

    Parameters
    ----------
    *points : int or sequence of sympy.Expr
        Two points at least: each the number of a mass, from 0, or the components of a position in
        m, functions of coordinates, parameters and ``derive.TIME``.

    Raises
    ------
    SystemDefinitionError
        When there are fewer points, or a point is neither of these.

    Examples
    --------
    >>> from derive import Rail
    >>> Rail((0, 0), (1, 0)).kind
    'rail'
    """

    kind = "rail"


class Plate(Line):
    """A rigid area with three or more corners.

    Parameters
    ----------
    *points : int or sequence of sympy.Expr
        Three points at least: each the number of a mass, from 0, or the components of a position in
        m, functions of coordinates, parameters and ``derive.TIME``.

    Raises
    ------
    SystemDefinitionError
        When there are fewer points, or a point is neither of these.

    Examples
    --------
    >>> from derive import Plate
    >>> Plate(0, 1, (0, 0)).points
    (0, 1, (0, 0))
    """

    kind = "plate"
    fewest = 3
