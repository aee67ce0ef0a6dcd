"""Verlet's method without velocities: q_new = 2 q - q_old + a h**2.

The coordinate grows by its last change, and by the acceleration times the square of the step size.
"""

from collections.abc import Iterator, Sequence, Set

from derive.reading.programs.evaluation.numeric_values import number
from derive.reading.programs.evaluation.sums import Term, factors, product, terms, total
from derive.reading.programs.syntax.trees import (
    Expression,
    Name,
    NumberLiteral,
    OperatorExpression,
)


def recurrence(path: str, value: Expression, earlier: Set[str]) -> Expression | None:
    """The acceleration of a coordinate with a new value; None if that is no such step.

    `earlier` are the names of the coordinate one step before.
    """
    result = [*terms(value, lambda _: False)]
    twice = [one for one in result if _is_twice(one, path)]
    last = [(sign, one) for sign, one in result if isinstance(one, Name) and one.path in earlier]
    rest = [one for one in result if one not in (*twice, *last)]
    if len(twice) != 1 or [sign for sign, _ in last] != [-1] or not rest:
        return None
    for step in _squares(_factors(rest[0][1])):
        divided = [(sign, _divided(term, step)) for sign, term in rest]
        known = [(sign, term) for sign, term in divided if term]
        if len(known) == len(rest):
            return total(value.line, known)
    return None


def _factors(tree: Expression) -> list[Expression]:
    return factors(tree, lambda _: False)


def _is_twice(term: Term, path: str) -> bool:
    parts = _factors(term[1])
    numbers = [number(one) for one in parts if one != Name(0, path)]
    return term[0] == 1 and numbers == [2] and len(parts) == 2


def _squares(parts: Sequence[Expression]) -> Iterator[list[Expression]]:
    """Squares of names among factors: as powers, or as a name that occurs twice."""
    for one in parts:
        match one:
            case OperatorExpression(operator="**", operands=(Name(), NumberLiteral(digits="2"))):
                yield [one]
            case Name() if parts.count(one) == 2:
                yield [one, one]


def _divided(term: Expression, step: Sequence[Expression]) -> Expression | None:
    """A term without the factors of a step; None if it lacks one of them."""
    for parts in (factors(term, lambda tree: tree.line != term.line), _factors(term)):
        if all(one in parts for one in step):  # a value from another line stays whole
            for one in step:
                parts.remove(one)
            return product(term.line, parts)
    return None
