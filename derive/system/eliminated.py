"""Coordinates that constraints determine, and that equations of motion do not contain."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Self

import sympy as sp

from derive.system.constraints import Constraint
from derive.system.parts import Coordinate


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
