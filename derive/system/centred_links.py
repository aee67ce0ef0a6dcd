"""Links of a size about a centre: wheels, blocks, carts and boxes."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Self

import sympy as sp

from derive.system.line_links import Link, Place, Point, Shape, checked_place, mapped, position
from derive.system.parts import PointMass, SystemDefinitionError, formula, formulas, items
from derive.system.rigid_body import RigidBody


@dataclass(frozen=True)
class Centred(Link):
    """A link with a size about a centre."""

    centre: Place

    def __post_init__(self) -> None:
        name = type(self).__name__
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name == "centre":
                value = checked_place(name, value)
            elif field.name == "plane":
                value = value and _axes(value)
            elif value is not None:
                value = formula(value)
            object.__setattr__(self, field.name, value)

    def mapped(self, function: Callable[[sp.Expr], sp.Expr]) -> Self:
        """A copy with `function` applied to every expression."""
        return replace(
            self, **{name: mapped(value, function) for name, value in vars(self).items()}
        )

    def _frame(
        self, masses: Sequence[PointMass]
    ) -> tuple[Point, sp.Expr | None, tuple[Point, ...]]:
        """The centre, the angle and the axes: by default those of a rigid body at the centre."""
        centre, angle = position(self, self.centre, masses), getattr(self, "angle", None)
        axes = tuple(tuple(sp.eye(len(centre)).row(k)) for k in range(len(centre)))
        if body := self._body(masses):
            if body.axes:
                return centre, angle or sp.S.Zero, tuple(map(body.axes.turned, axes))
            if angle is None:
                angle = formula(body.orientation)
        return centre, angle, axes

    def _body(self, masses: Sequence[PointMass]) -> RigidBody | None:
        """The rigid body at the centre."""
        mass = masses[self.centre] if isinstance(self.centre, int) else None
        return mass if isinstance(mass, RigidBody) else None


@dataclass(frozen=True)
class Wheel(Centred):
    """A wheel, disc or ring; a spoke shows its angle.

    Parameters
    ----------
    centre : int or sequence of sympy.Expr
        The number of a mass, from 0, or the components of a position in m.
    radius : sympy.Expr or number
        In m.
    angle : sympy.Expr or number, optional
        Of the spoke in rad, from the first axis of the plane to the second one; by default that of
        the rigid body at the centre. Without either there is no spoke.
    plane : pair of sequences of sympy.Expr, optional
        Perpendicular unit vectors that span the wheel; by default along the first and last axis,
        or, of a rigid body in space at the centre, the body's first and second axis.

    Raises
    ------
    SystemDefinitionError
        When a value is no formula, or the centre no point.

    Examples
    --------
    >>> from sympy import symbols
    >>> from derive import Wheel
    >>> x = symbols("x", real=True)
    >>> R = symbols("R", positive=True)
    >>> Wheel((x, R), R, angle=-x / R).radius
    R
    """

    radius: sp.Expr
    angle: sp.Expr | None = None
    plane: tuple[Sequence[sp.Expr], Sequence[sp.Expr]] | None = None

    def shapes(self, masses: Sequence[PointMass]) -> Iterator[Shape]:
        """The centre, and two points of the rim a quarter turn apart."""
        centre, angle, axes = self._frame(masses)
        kind, turn = ("ring", sp.S.Zero) if angle is None else ("wheel", angle)
        body = self._body(masses)
        first, second = self.plane or (axes[0], axes[1 if body and body.axes else -1])
        if not len(first) == len(second) == len(centre):
            raise SystemDefinitionError(
                f"Wheel has a plane of {len(first)} and {len(second)} components: give two unit "
                f"vectors of {len(centre)}, as of the masses"
            )
        angles = (turn, turn + sp.pi / 2)
        spokes = ((self.radius * sp.cos(a), self.radius * sp.sin(a)) for a in angles)
        rim = (_along(centre, spoke, (first, second)) for spoke in spokes)
        yield kind, (centre, *rim)


@dataclass(frozen=True)
class Block(Centred):
    """A rectangle about a centre, such as a sliding block.

    Parameters
    ----------
    centre : int or sequence of sympy.Expr
        The number of a mass, from 0, or the components of a position in m.
    width, height : sympy.Expr or number
        In m.
    angle : sympy.Expr or number, optional
        From the first axis to the width, in rad; by default that of the rigid body at the centre,
        or else 0.

    Raises
    ------
    SystemDefinitionError
        When a value is no formula, or the centre no point.

    Examples
    --------
    >>> from derive import Block
    >>> Block(0, 0.5, 0.25).height
    1/4
    """

    width: sp.Expr
    height: sp.Expr
    angle: sp.Expr | None = None

    def shapes(self, masses: Sequence[PointMass]) -> Iterator[Shape]:
        """The four corners."""
        yield (
            "plate",
            tuple(
                self._at(masses, across * self.width / 2, up * self.height / 2)
                for across, up in ((-1, -1), (1, -1), (1, 1), (-1, 1))
            ),
        )

    def _at(self, masses: Sequence[PointMass], across: sp.Expr, up: sp.Expr) -> Point:
        """The point at these distances from the centre along width and height."""
        centre, angle, axes = self._frame(masses)
        cos, sin = sp.cos(angle or 0), sp.sin(angle or 0)
        along = (across * cos - up * sin, across * sin + up * cos)
        return _along(centre, along, (axes[0], axes[-1]))


@dataclass(frozen=True)
class Cart(Block):
    """A `Block` on two wheels; the ground is `height` below its centre.

    Parameters
    ----------
    centre : int or sequence of sympy.Expr
        The number of a mass, from 0, or the components of a position in m.
    width, height : sympy.Expr or number
        Of the rectangle, in m; the wheels have half the height.
    angle : sympy.Expr or number, optional
        Of the ground, as in `Block`.

    Raises
    ------
    SystemDefinitionError
        When a value is no formula, or the centre no point.

    Examples
    --------
    >>> from derive import Cart
    >>> Cart(0, 0.5, 0.25).width
    1/2
    """

    def shapes(self, masses: Sequence[PointMass]) -> Iterator[Shape]:
        """The box, and the wheels below it."""
        yield from super().shapes(masses)
        radius = self.height / 4
        for side in (-1, 1):
            across, up = side * self.width / 4, -self.height / 2 - radius
            offsets = ((0, 0), (radius, 0), (0, radius))
            yield "ring", tuple(self._at(masses, across + a, up + b) for a, b in offsets)


@dataclass(frozen=True)
class Box(Centred):
    """A box in space, with faces along the axes of the rigid body at its centre.

    Parameters
    ----------
    centre : int or sequence of sympy.Expr
        The number of a mass, from 0, or the components of a position in m.
    length, width, height : sympy.Expr or number
        Along the first, second and third axis, in m.

    Raises
    ------
    SystemDefinitionError
        When a value is no formula, or the centre no point.

    Examples
    --------
    >>> from derive import Box
    >>> Box(0, 0.3, 0.2, 0.1).height
    1/10
    """

    length: sp.Expr
    width: sp.Expr
    height: sp.Expr

    def shapes(self, masses: Sequence[PointMass]) -> Iterator[Shape]:
        """The six faces."""
        centre, _, axes = self._frame(masses)
        if len(axes) != 3:
            raise SystemDefinitionError("Box is one in space: in the plane give a Block")
        sides = (self.length, self.width, self.height)
        for k in range(3):
            for sign in (-1, 1):
                corners = []
                for pair in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                    signs = [*pair[:k], sign, *pair[k:]]
                    lengths = [s * side / 2 for s, side in zip(signs, sides, strict=True)]
                    corners.append(_along(centre, lengths, axes))
                yield "plate", tuple(corners)


def _along(centre: Point, lengths: Sequence[sp.Expr], axes: Sequence[Sequence[sp.Expr]]) -> Point:
    """The point at these lengths along axes from a centre."""
    terms = [[length * x for x in axis] for length, axis in zip(lengths, axes, strict=True)]
    return tuple(c + sp.Add(*parts) for c, *parts in zip(centre, *terms, strict=True))


def _axes(plane: object) -> tuple[Point, ...]:
    axes = items("plane", plane, "two unit vectors")
    if len(axes) != 2:
        raise SystemDefinitionError(f"plane has {len(axes)} vectors: give two unit vectors")
    return tuple(formulas("plane", axis, "the components of a unit vector") for axis in axes)
