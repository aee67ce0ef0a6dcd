"""Loops over the entries of arrays, as statements about whole arrays."""

from derive.reading.programs.code import Assignment, Loop, Statement
from derive.reading.programs.trees import Call, Item, Name, Number, Operation, Tree, replaced


class _NotElementwiseError(Exception):
    pass


def elementwise(loop: Loop) -> tuple[Statement, ...] | None:
    """The statements of a loop without its index; None if the index has another use."""
    if not loop.variable or not loop.body:
        return None
    found = []
    for one in loop.body:
        if not isinstance(one, Assignment) or not isinstance(one.target, Item):
            return None
        try:
            target, value = (_without(tree, loop.variable) for tree in (one.target, one.value))
        except _NotElementwiseError:
            return None
        found.append(Assignment(one.line, target, one.operator, value))
    return tuple(found)


def _without(tree: Tree, variable: str) -> Tree:
    match tree:
        case Item(base=base, indices=(Name(path=path),)) if path == variable:
            return _without(base, variable)
        case Call(function=Name() as base, arguments=(Name(path=path),)) if path == variable:
            return base  # round brackets
        case Name(path=path) if path == variable:
            raise _NotElementwiseError
        case Name() | Number():
            return tree
        case Operation() | Item():
            parts = tuple(_without(part, variable) for part in tree.parts)
            return replaced(tree, parts)
    raise _NotElementwiseError
