"""Constraints: functions of the state that remain 0; coordinates that they determine."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Self, TypeAlias

import sympy as sp

from derive.system.parts import (
    Coordinate,
    SystemDefinitionError,
    check_text,
    formula,
    formulas,
    items,
)
from solvers.io.suggestion import shortened

#: Components of a position.
Point: TypeAlias = Sequence[sp.Expr]
AXES = {2: ("x", "y"), 3: ("x", "y", "z")}


@dataclass(frozen=True)
class Constraint:
    """A function of the state that remains 0, and the reaction that keeps it so.

    Parameters
    ----------
    formula : sympy.Expr
        A function of coordinates, parameters and ``derive.TIME``; or an affine function of the
        velocities (``derive.velocity(x)``), such as that of a rolling wheel. If this is integrable
        and its integral is found, motions keep the integral at its value at the start.
    name : str
        Name of the multiplier λ: the generalized reaction is λ ∂formula/∂q, or λ ∂formula/∂q̇.
    unit : str, optional
        Unit of the multiplier: N, if the formula is a length or a velocity.
    meaning : str, optional
        A description of the multiplier, of one line.

    Raises
    ------
    SystemDefinitionError
        When `formula` is no real expression; when `unit` or `meaning` is not one line that
        generated files can contain.

    Examples
    --------
    >>> from sympy import symbols
    >>> from derive import Constraint
    >>> x, y = symbols("x y", real=True)
    >>> l = symbols("l", positive=True)
    >>> Constraint(x**2 + y**2 - l**2, "rod", "N/m", "tension per length, negative").name
    'rod'
    """

    formula: sp.Expr
    name: str
    unit: str = "1"
    meaning: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "formula", formula(self.formula))
        object.__setattr__(self, "meaning", self.meaning or f"reaction of {self.formula} = 0")
        check_text(f"the unit of {self.name}", self.unit)
        check_text(f"the meaning of {self.name}", self.meaning)

    @property
    def symbol(self) -> sp.Symbol:
        """The multiplier."""
        return sp.Symbol(self.name, real=True)

    def is_multiple(self, value: sp.Expr) -> bool:
        """Whether the formula is a number times another one."""
        return bool(sp.cancel(self.formula / value).is_number)

    def with_formula(self, value: sp.Expr) -> Self:
        """The same constraint with another formula."""
        return replace(self, formula=value)


def constraints(
    given: object, pairs: object, of_bodies: Sequence[sp.Expr]
) -> tuple[Constraint, ...]:
    """Constraints from formulas, from pairs of points that remain together, and of orientations."""
    result = [
        one if isinstance(one, Constraint) else Constraint(one, f"lambda_{k}")
        for k, one in enumerate(items("constraints", given, "formulas that remain 0"), 1)
    ]
    contents = "pairs of points, such as ((x, y), (l*cos(theta), l*sin(theta)))"
    for k, pair in enumerate(items("coincide", pairs, contents), 1):
        first, second = _points(pair, contents)
        for axis, a, b in zip(AXES[len(first)], first, second, strict=True):
            if a == b:  # as along the axis of a planar loop in space
                continue
            meaning = f"force along {axis} on the first of the points {k}"
            result.append(Constraint(a - b, f"pin_{k}_{axis}", "N", meaning))
    for k, condition in enumerate(dict.fromkeys(of_bodies), 1):
        # a system that is a copy of another has them
        if not any(one.is_multiple(condition) for one in result):
            meaning = "keeps the coordinates of a body those of an orientation"
            result.append(Constraint(condition, f"rigid_{k}", "J", meaning))
    return tuple(result)


def _points(pair: object, contents: str) -> tuple[tuple[sp.Expr, ...], ...]:
    points = [formulas("coincide", point, contents) for point in items("coincide", pair, contents)]
    if len(points) != 2 or len(points[0]) != len(points[1]) or len(points[0]) not in AXES:
        raise SystemDefinitionError(
            f"coincide contains {shortened(pair)}: give {contents}, of two or three components each"
        )
    return tuple(points)


@dataclass(frozen=True)
class Eliminated:
    """A coordinate, its constraint, and both as functions of the remaining coordinates."""

    coordinate: Coordinate
    constraint: Constraint
    #: The coordinate, a function of the others, of parameters and of time.
    formula: sp.Expr
    #: The multiplier of the constraint, a function of the others, their velocities and
    #: accelerations, and of the multipliers of the remaining constraints.
    reaction: sp.Expr
    #: Index of the constraint among all constraints.
    index: int

    def mapped(self, function: Callable[[sp.Expr], sp.Expr]) -> Self:
        """A copy with `function` applied to formula and reaction."""
        return replace(self, formula=function(self.formula), reaction=function(self.reaction))
