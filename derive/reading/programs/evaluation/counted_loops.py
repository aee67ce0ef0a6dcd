"""Loops over bodies and over entries: of any number of bodies, the equations of two are read.

A name that bounds two nested loops, or a loop and both halves of the state, counts bodies; loops
over time steps have no such bound. A loop over the entries of arrays is one operation on arrays.
"""

from collections.abc import Iterable, Iterator, Sequence

from derive.reading.programs.evaluation.context import statements, static_path
from derive.reading.programs.evaluation.numeric_values import number
from derive.reading.programs.syntax.code import (
    Assignment,
    Definition,
    ExpressionStatement,
    Loop,
    Return,
    Statement,
)
from derive.reading.programs.syntax.trees import (
    Comprehension,
    Expression,
    FunctionCall,
    Item,
    Member,
    Name,
    NumberLiteral,
    OperatorExpression,
    Slice,
    replaced,
)

#: The number of bodies of which the equations are read.
BODIES = 2
#: The largest number that bounds loops over bodies.
MAX_BODIES = 4
#: Functions of the length of an array.
LENGTHS = {"len", "length", "numel", "size"}


def counts(body: tuple[Statement, ...]) -> set[str]:
    """The bounds that count bodies in a function: names, and lengths such as ``len(m)``."""
    loops = [one for one in statements(body, inner=False) if isinstance(one, Loop)]
    bounds = {bound(one.bounds[1]) for one in loops if one.bounds}
    nested = {
        key
        for loop in loops
        if loop.bounds
        for key in (bound(loop.bounds[1]),)
        if key in {*_inner(loop.body)} or key in {*_dependent(loop)}
    }
    ranges = [one for one in expressions(body) if isinstance(one, Slice)]
    lower, upper = (
        {bound(one.lower) for one in ranges if one.lower},
        {bound(one.upper) for one in ranges if one.upper},
    )
    result = (nested | (lower & upper & bounds)) - {""}
    return {one for one in result if not one.isdigit() or int(one) <= MAX_BODIES}


def bound(tree: Expression) -> str:
    """The bound of a loop as a text, without the 1 after it; empty for others."""
    match tree:
        case NumberLiteral(digits=digits):
            return digits
        case OperatorExpression(operator="+", operands=(inner, NumberLiteral(digits="1"))):
            return bound(inner)
        case FunctionCall(function=Name(path=name), arguments=(array,)) if name in LENGTHS:
            return f"len({static_path(array)})"
        case FunctionCall(function=Member(base=array, name=name), arguments=()) if name in LENGTHS:
            return f"len({static_path(array)})"
        case Member(base=array, name="length" | "size"):
            return f"len({static_path(array)})"
    return static_path(tree)


def integer(tree: Expression | None) -> int | None:
    """The value of an index; None if it is no whole number."""
    value = None if tree is None else number(tree)
    return int(value) if value is not None and value == int(value) else None


def mentions(tree: Expression, names: Iterable[str]) -> bool:
    """Whether an expression contains one of some names."""
    if isinstance(tree, Name):
        return tree.path in names
    return any(mentions(part, names) for part in tree.parts)


def _inner(body: tuple[Statement, ...]) -> Iterator[str]:
    """The bounds of loops and comprehensions in a body."""
    for one in statements(body, inner=False):
        if isinstance(one, Loop) and one.bounds:
            yield bound(one.bounds[1])
    yield from (bound(one.upper) for one in expressions(body) if isinstance(one, Comprehension))


def _dependent(loop: Loop) -> Iterator[str]:
    """The bound of a loop if ranges that start at its index stand in its body."""
    assert loop.bounds
    for one in expressions(loop.body):
        if isinstance(one, Slice) and one.lower and mentions(one.lower, {loop.variable}):
            yield bound(loop.bounds[1])


def expressions(body: Sequence[Statement]) -> Iterator[Expression]:
    """All expressions in statements, with their parts."""
    for one in statements(tuple(body), inner=False):
        match one:
            case Assignment(target=target, value=value):
                yield from _parts(target)
                yield from _parts(value)
            case Return(value=Expression() as value) | ExpressionStatement(value=value):
                yield from _parts(value)


def _parts(tree: Expression) -> Iterator[Expression]:
    yield tree
    for part in tree.parts:
        yield from _parts(part)


def has_index(loop: Loop) -> bool:
    """Whether the index of a loop stands in its body, unlike that of steps."""
    return any(mentions(one, {loop.variable}) for one in expressions(loop.body))


def changed_vectors(loop: Loop) -> set[str]:
    """The arrays of which a loop changes the entry at its index."""
    index = Name(0, loop.variable)
    found = (
        one.target for one in statements(loop.body, inner=False) if isinstance(one, Assignment)
    )
    return {static_path(one) for one in found if isinstance(one, Item) and index in one.indices}


class _NotElementwiseError(Exception):
    pass


def elementwise(loop: Loop) -> tuple[Statement, ...] | None:
    """The statements of a loop without its index; None if the index has another use.

    Variables that the loop declares do not keep their values in the next round.
    """
    if not loop.variable or not loop.body:
        return None
    result = []
    for one in loop.body:
        if not isinstance(one, Assignment):
            return None
        is_own = isinstance(one.target, Name) and one.is_declaration and not one.operator
        if not isinstance(one.target, Item) and not is_own:
            return None
        try:
            target, value = (_without(tree, loop.variable) for tree in (one.target, one.value))
        except _NotElementwiseError:
            return None
        result.append(Assignment(one.line, target, one.operator, value, one.is_declaration))
    return tuple(result)


def mapped(function: Definition, array: Expression) -> Expression | None:
    """The array of the values of a function of an entry and its index; None for others."""
    match function:
        case Definition(parameters=(entry, *rest), body=(Return(value=value),)) if value:
            try:
                value = _without(value, rest[0].name if rest else "")
            except _NotElementwiseError:
                return None
            return _with_array(value, entry.name, array)
    return None


def _with_array(tree: Expression, entry: str, array: Expression) -> Expression:
    if isinstance(tree, Name):
        return array if tree.path == entry else tree
    return replaced(tree, tuple(_with_array(part, entry, array) for part in tree.parts))


def _without(tree: Expression, variable: str) -> Expression:
    match tree:
        case Item(base=base, indices=(Name(path=path),)) if path == variable:
            return _without(base, variable)
        case FunctionCall(function=Name() as base, arguments=(Name(path=path),)) if (
            path == variable
        ):
            return base  # round brackets
        case Name(path=path) if path == variable:
            raise _NotElementwiseError
        case Name() | NumberLiteral():
            return tree
        case OperatorExpression() | Item():
            parts = tuple(_without(part, variable) for part in tree.parts)
            return replaced(tree, parts)
    raise _NotElementwiseError
