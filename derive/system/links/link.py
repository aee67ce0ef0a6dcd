"""Base of the links that pictures show between points, and the points themselves."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Self, TypeAlias

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
