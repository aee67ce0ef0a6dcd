"""A statement as somebody wrote it, judged against what was derived.

``"x1 = l1*sin(theta1)"`` has two sides, ``"a = b = c"`` three, ``"a >= b"`` is
an inequality, and ``"a = b; c = d"`` says both. A name that ends in ``_i``
stands for every index.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from derive.formulas.expression import RELATION, ExpressionError, Scope, Value, parse
from derive.formulas.zero import is_positive, vanishes

INDEXED = re.compile(r"\b(\w+_)i\b")

#: Digits of a numeric witness, and what counts as zero there; both leave room for cancellation.
DIGITS, TINY = 40, sp.Float("1e-30")


@dataclass(frozen=True)
class Comparison:
    """Two neighbouring sides of a statement, entry by entry where they are matrices.

    Attributes
    ----------
    relation : {"=", "<", "<=", ">", ">="}
        What is said of them.
    residual : sympy.Expr
        Left minus right; for an inequality the larger minus the smaller side.
    possible : bool
        Whether the sides are of one kind: a number is never equal to a column.
    """

    relation: str
    residual: sp.Expr
    possible: bool = True


@dataclass(frozen=True)
class Finding:
    """What was found about a statement.

    Attributes
    ----------
    holds : bool
        Whether it is true; then the rest is empty.
    place : int
        Which of its comparisons is the first that does not hold.
    witness : str
        The residual of that comparison as a number, at the state of the context.
    """

    holds: bool
    place: int = 0
    witness: str = ""


@dataclass(frozen=True)
class Context:
    """What the names in a statement mean.

    Attributes
    ----------
    scope : mapping of str to SymPy values and functions
        Every name that a statement may use.
    substitutions : tuple of mappings
        Carried out in order, they leave independent symbols only: momenta by
        velocities, and where the equations of motion are taken to hold,
        accelerations by coordinates and velocities.
    state : mapping of symbols to numbers
        A generic state that agrees with the substitutions, for numeric witnesses.
    count : int
        How many values an index takes, from 1.
    """

    scope: Scope
    substitutions: tuple[Mapping[sp.Symbol, sp.Expr], ...]
    state: Mapping[sp.Symbol, sp.Expr]
    count: int

    def judged(self, text: str, definitions: Mapping[str, Value] | None = None) -> Finding:
        """Whether every part of `text` holds, with further names from `definitions`."""
        for place, comparison in enumerate(self.comparisons(text, definitions)):
            residual = comparison.residual
            if comparison.relation != "=":
                if not is_positive(residual, strictly="=" not in comparison.relation):
                    return Finding(False, place, "not seen to be positive")
                continue
            number = self._number(residual)
            differ = abs(number) > TINY or not comparison.possible
            if differ or not vanishes(self._reduced(residual)):
                return Finding(False, place, sp.sstr(number.n(6)))
        return Finding(holds=True)

    def comparisons(
        self, text: str, definitions: Mapping[str, Value] | None = None
    ) -> list[Comparison]:
        """Everything that `text` says, one comparison of two numbers each."""
        scope = {**self.scope, **(definitions or {})}
        found = []
        for part in text.split(";"):
            indices = range(1, self.count + 1) if INDEXED.search(part) else (0,)
            for index in indices:
                pieces = RELATION.split(INDEXED.sub(rf"\g<1>{index}", part))
                if len(pieces) == 1:
                    raise ExpressionError(f"{part.strip()[:80]!r} states nothing: no =, <, >")
                sides = [parse(piece, scope) for piece in pieces[::2]]
                for left, relation, right in zip(sides, pieces[1::2], sides[1:], strict=False):
                    larger, smaller = (right, left) if "<" in relation else (left, right)
                    found += [
                        Comparison(relation, r, _is_matrix(left) == _is_matrix(right))
                        for r in _differences(larger, smaller)
                    ]
        return found

    def _number(self, residual: sp.Expr) -> sp.Expr:
        # numbers first: `evalf` with symbols tries ever more digits where a residual is 0
        numbers = {symbol: sp.Float(value, DIGITS) for symbol, value in self.state.items()}
        return sp.sympify(residual.xreplace(numbers)).evalf(DIGITS)

    def _reduced(self, expression: sp.Expr) -> sp.Expr:
        for substitution in self.substitutions:
            if expression.free_symbols & set(substitution):
                expression = expression.xreplace(dict(substitution))
        return expression


def _is_matrix(side: Value) -> bool:
    return isinstance(side, sp.MatrixBase)


def _differences(left: Value, right: Value) -> list[sp.Expr]:
    """Left minus right, entry by entry; a number beside a matrix stands for each entry."""
    if not _is_matrix(left) and not _is_matrix(right):
        return [left - right]
    ones = sp.ones(*(left if _is_matrix(left) else right).shape)
    left, right = (side if _is_matrix(side) else side * ones for side in (left, right))
    if left.shape != right.shape:
        raise ExpressionError(f"cannot compare matrices of shapes {left.shape} and {right.shape}")
    return list(left - right)
