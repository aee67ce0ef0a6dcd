"""Sums and products in expressions of programs."""

from collections.abc import Callable, Iterator, Sequence

from derive.reading.programs.syntax.trees import Number, Operation, Result, Tree

Term = tuple[int, Tree]


def terms(tree: Tree, is_whole: Callable[[Tree], bool], sign: int = 1) -> Iterator[Term]:
    """The terms of a sum and their signs; trees that are whole are not divided."""
    match tree:
        case Operation(operator="+" | "-" as operator, operands=(left, right)) if not is_whole(
            tree
        ):
            yield from terms(left, is_whole, sign)
            yield from terms(right, is_whole, sign if operator == "+" else -sign)
        case Operation(operator="-", operands=(operand,)) if not is_whole(tree):
            yield from terms(operand, is_whole, -sign)
        case _:
            yield sign, tree


def factors(tree: Tree, is_whole: Callable[[Tree], bool]) -> list[Tree]:
    """The factors of a product; a divisor stays with its numerator's first factor out."""
    match tree:
        case Operation(operator="*", operands=operands) if not is_whole(tree):
            return [one for operand in operands for one in factors(operand, is_whole)]
        case Operation(line=line, operator="/", operands=(above, below)) if not is_whole(tree):
            return [*factors(above, is_whole), Operation(line, "/", (Number(line, "1"), below))]
        case Operation(line=line, operator="-", operands=(operand,)) if not is_whole(tree):
            return [
                Operation(line, "-", (Number(line, "1"),)),
                *factors(operand, is_whole),
            ]
    return [tree]


def product(line: int, found: Sequence[Tree]) -> Tree:
    """The product of factors, 1 for none."""
    one, minus = Number(line, "1"), Operation(line, "-", (Number(line, "1"),))
    result: Tree | None = None
    for factor in (factor for factor in found if factor not in (one, minus)):
        match factor:
            case Operation(operator="/", operands=(Number(digits="1"), below)):
                result = Operation(line, "/", (result or one, below))
            case _:
                result = Operation(line, "*", (result, factor)) if result else factor
    is_negative = sum(factor == minus for factor in found) % 2
    return Operation(line, "-", (result or one,)) if is_negative else result or one


def total(line: int, found: Sequence[Term]) -> Tree:
    """The sum of terms, 0 for none."""
    result: Tree | None = None
    for sign, term in found:
        if result is None:
            result = term if sign > 0 else Operation(line, "-", (term,))
        else:
            result = Operation(line, "+" if sign > 0 else "-", (result, term))
    return result or Number(line, "0")


def inner(tree: Tree) -> Tree:
    """The value of the result of a call; other values as they are."""
    return inner(tree.value) if isinstance(tree, Result) else tree
