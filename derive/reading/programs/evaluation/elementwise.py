"""Loops over the entries of arrays, and functions of entries, for whole arrays."""

from derive.reading.programs.syntax.code import Assignment, Definition, Loop, Return, Statement
from derive.reading.programs.syntax.trees import (
    Expression,
    FunctionCall,
    Item,
    Name,
    NumberLiteral,
    OperatorExpression,
    replaced,
)


class _NotElementwiseError(Exception):
    pass


def elementwise(loop: Loop) -> tuple[Statement, ...] | None:
    """The statements of a loop without its index; None if the index has another use."""
    if not loop.variable or not loop.body:
        return None
    result = []
    for one in loop.body:
        if not isinstance(one, Assignment) or not isinstance(one.target, Item):
            return None
        try:
            target, value = (_without(tree, loop.variable) for tree in (one.target, one.value))
        except _NotElementwiseError:
            return None
        result.append(Assignment(one.line, target, one.operator, value))
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
