"""The judging engine: statements compared with derived values, in numbers and by proof.

``"x1 = l1*sin(theta1)"`` is a statement with two sides, ``"a = b = c"`` has
three, ``"a >= b"`` is an inequality, and ``"a = b; c = d"`` is two statements.
A name that ends in ``_i`` stands for every index.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import sympy as sp

from derive.formulas.expression import RELATION, ExpressionError, Scope, parse
from derive.formulas.zero import is_positive, vanishes

State = Mapping[sp.Symbol, sp.Expr]

INDEXED = re.compile(r"\b(\w+_)i\b")

#: Digits of numeric values, and the largest value that counts as zero; both allow for cancellation.
DIGITS, TINY = 40, sp.Float("1e-30")

#: The number of states at which agreement is sufficient for what no proof decides.
SUFFICIENT_STATES = 5


@dataclass(frozen=True)
class Comparison:
    """Two neighbouring sides of a statement, or one entry of each if they are matrices."""

    relation: str
    residual: sp.Expr  # left minus right; of an inequality, larger minus smaller side
    comparable: bool  # both sides are numbers, or both are matrices


@dataclass(frozen=True)
class Check:
    """Whether a statement holds, and the first comparison in it that does not hold."""

    holds: bool
    comparison: int = 0  # its index
    witness: str = ""  # its residual as a number, at the first state of the context


@dataclass(frozen=True)
class Context:
    """The names that statements can use, and generic states at which they are evaluated.

    Substitutions, applied in order, leave independent symbols only: they replace momenta by
    velocities and, if the equations of motion are assumed, accelerations. States agree with them.
    """

    scope: Scope
    states: tuple[State, ...]
    substitutions: tuple[State, ...] = ()
    index_count: int = 0  # an index takes the values 1 to index_count

    def check(self, text: str, definitions: Scope | None = None) -> Check:
        """Check every part of `text`, with additional names from `definitions`."""
        for index, comparison in enumerate(self.comparisons(text, definitions)):
            residual = comparison.residual
            if comparison.relation != "=":
                if not is_positive(residual, strictly="=" not in comparison.relation):
                    return Check(False, index, "not proved positive")
            elif not comparison.comparable or not self.is_zero(residual):
                return Check(False, index, sp.sstr(_value(residual, self.states[0]).n(6)))
        return Check(holds=True)

    def comparisons(self, text: str, definitions: Scope | None = None) -> list[Comparison]:
        """Split `text` into comparisons of two numbers each."""
        scope = {**self.scope, **(definitions or {})}
        return [
            comparison
            for part in text.split(";")
            for index in (range(1, self.index_count + 1) if INDEXED.search(part) else (0,))
            for comparison in _compared(INDEXED.sub(rf"\g<1>{index}", part), scope)
        ]

    def is_zero(self, expression: sp.Expr) -> bool:
        """Whether `expression` is zero: by proof, or where none is possible, at many states."""
        if not all(is_small(expression, state) for state in self.states):
            return False
        for substitution in self.substitutions:
            expression = expression.xreplace(substitution)
        try:
            return vanishes(expression)
        except NotImplementedError:
            if len(self.states) < SUFFICIENT_STATES:
                raise
            return True


def is_small(expression: sp.Expr, state: State) -> bool:
    """Whether `expression` is zero at `state`, relative to its largest term."""
    terms = sp.Add.make_args(sp.expand_mul(expression))
    values = [_value(term, state) for term in terms]
    return bool(abs(sum(values)) <= TINY * max(map(abs, values)))


def _value(expression: sp.Expr, state: State) -> sp.Expr:
    # numbers first: `evalf` with symbols adds digits without end where the value is 0
    numbers = {symbol: sp.Float(value, DIGITS) for symbol, value in state.items()}
    return sp.sympify(expression.xreplace(numbers)).evalf(DIGITS)


def _compared(text: str, scope: Scope) -> Iterator[Comparison]:
    pieces = RELATION.split(text)
    if len(pieces) == 1:
        raise ExpressionError(f"{text.strip()[:80]!r} is not a statement: it has no =, < or >")
    sides = [parse(piece, scope) for piece in pieces[::2]]
    for left, relation, right in zip(sides, pieces[1::2], sides[1:], strict=False):
        pair = (right, left) if "<" in relation else (left, right)
        shapes = [side.shape for side in pair if isinstance(side, sp.MatrixBase)]
        if len(set(shapes)) > 1:
            both = " and ".join(map(str, shapes))
            raise ExpressionError(f"cannot compare matrices of shapes {both}")
        if len(shapes) == 1:  # a number beside a matrix stands for each entry
            ones = sp.ones(*shapes[0])
            pair = tuple(s if isinstance(s, sp.MatrixBase) else s * ones for s in pair)
        difference = pair[0] - pair[1]
        for residual in difference if shapes else [difference]:
            yield Comparison(relation, residual, comparable=len(shapes) != 1)
