"""Sums and products in expressions of programs."""

from collections.abc import Callable, Iterator, Sequence

from derive.reading.programs.evaluation.numeric_values import number
from derive.reading.programs.syntax.trees import (
    Expression,
    Name,
    NumberLiteral,
    OperatorExpression,
    Result,
    replaced,
)

Term = tuple[int, Expression]


def _never(_: Expression) -> bool:
    return False


def terms(
    tree: Expression, is_whole: Callable[[Expression], bool] = _never, sign: int = 1
) -> Iterator[Term]:
    """The terms of a sum and their signs; trees that are whole are not divided."""
    match tree:
        case OperatorExpression(operator="+" | "-" as operator, operands=(left, right)) if (
            not is_whole(tree)
        ):
            yield from terms(left, is_whole, sign)
            yield from terms(right, is_whole, sign if operator == "+" else -sign)
        case OperatorExpression(operator="-", operands=(operand,)) if not is_whole(tree):
            yield from terms(operand, is_whole, -sign)
        case _:
            yield sign, tree


def factors(tree: Expression, is_whole: Callable[[Expression], bool] = _never) -> list[Expression]:
    """The factors of a product; a divisor stays with its numerator's first factor out."""
    match tree:
        case OperatorExpression(operator="*", operands=operands) if not is_whole(tree):
            return [one for operand in operands for one in factors(operand, is_whole)]
        case OperatorExpression(line=line, operator="/", operands=(above, below)) if not is_whole(
            tree
        ):
            return [
                *factors(above, is_whole),
                OperatorExpression(line, "/", (NumberLiteral(line, "1"), below)),
            ]
        case OperatorExpression(line=line, operator="-", operands=(operand,)) if not is_whole(tree):
            return [
                OperatorExpression(line, "-", (NumberLiteral(line, "1"),)),
                *factors(operand, is_whole),
            ]
    return [tree]


def quotients(sign: int, term: Expression) -> Iterator[Term]:
    """The terms of a sum over a factor of some, such as (m*v + F*dt)/m; others as they are."""
    match term:
        case OperatorExpression(line=line, operator="/", operands=(above, below)) if (
            len(found := [*terms(inner(above))]) > 1
        ):
            for own, one in found:
                parts = factors(one)
                if below in parts:
                    parts.remove(below)
                else:
                    parts.append(OperatorExpression(line, "/", (NumberLiteral(line, "1"), below)))
                yield from terms(product(one.line, parts), sign=sign * own)
        case _:
            yield sign, term


def divisors(parts: Sequence[Expression]) -> Iterator[Expression]:
    """Factors, with one for each factor of a divisor."""
    for one in parts:
        match one:
            case OperatorExpression(line=line, operator="/", operands=(above, below)):
                own = factors(below)
                yield from (OperatorExpression(line, "/", (above, divisor)) for divisor in own)
            case _:
                yield one


def product(line: int, found: Sequence[Expression]) -> Expression:
    """The product of factors, 1 for none."""
    one, minus = (
        NumberLiteral(line, "1"),
        OperatorExpression(line, "-", (NumberLiteral(line, "1"),)),
    )
    result: Expression | None = None
    for factor in (factor for factor in found if factor not in (one, minus)):
        match factor:
            case OperatorExpression(operator="/", operands=(NumberLiteral(digits="1"), below)):
                result = OperatorExpression(line, "/", (result or one, below))
            case _:
                result = OperatorExpression(line, "*", (result, factor)) if result else factor
    is_negative = sum(factor == minus for factor in found) % 2
    return OperatorExpression(line, "-", (result or one,)) if is_negative else result or one


def total(line: int, found: Sequence[Term]) -> Expression:
    """The sum of terms, 0 for none."""
    result: Expression | None = None
    for sign, term in found:
        if result is None:
            result = term if sign > 0 else OperatorExpression(line, "-", (term,))
        else:
            result = OperatorExpression(line, "+" if sign > 0 else "-", (result, term))
    return result or NumberLiteral(line, "0")


def joined(found: Sequence[Term]) -> list[Term]:
    """The terms of a sum, equal ones as one: two halves are the whole."""
    groups: dict[tuple[Expression, ...], list[tuple[Term, float, list[Expression], bool]]] = {}
    for term in found:
        size, rest, has_sum = _sized(*term)
        groups.setdefault(tuple(map(_bare, rest)), []).append((term, size, rest, has_sum))
    result: list[Term] = []
    for group in groups.values():
        (first, _, rest, has_sum), *others = group
        if not others and not has_sum:
            result.append(first)
            continue
        line, size = first[1].line, sum(one[1] for one in group)
        digits = f"{abs(size):.12g}"
        number_of = [] if digits == "1" and rest else [NumberLiteral(line, digits)]
        result.append((-1 if size < 0 else 1, product(line, [*number_of, *rest])))
    return result


def _bare(tree: Expression) -> Expression:
    """A value without the calls that it comes from."""
    if isinstance(tree, Result):
        return _bare(tree.value)
    return replaced(tree, tuple(map(_bare, tree.parts))) if tree.parts else tree


def _sized(sign: int, term: Expression) -> tuple[float, list[Expression], bool]:
    """A term as a number and other factors, and whether one of these was a sum of equal terms."""
    size, rest, has_sum = float(sign), list[Expression](), False
    for one in factors(term):
        own = [*terms(inner(one))]
        same = joined(own) if len(own) > 1 else []
        if len(same) == 1:
            has_sum = True
            size *= same[0][0]
        for part in factors(same[0][1]) if len(same) == 1 else (one,):
            value = None if part == Name(0, "pi") else number(part)
            size *= 1 if value is None else value
            rest += [part] if value is None else []
    return size, rest, has_sum


def inner(tree: Expression) -> Expression:
    """The value of the result of a call; other values as they are."""
    return inner(tree.value) if isinstance(tree, Result) else tree
