"""Operations on arrays, entry by entry, as far as their entries are known."""

from collections.abc import Sequence
from functools import reduce

from derive.reading.programs.evaluation.numeric_values import number
from derive.reading.programs.languages.language import Language
from derive.reading.programs.syntax.trees import (
    Array,
    Expression,
    Item,
    Name,
    NumberLiteral,
    OperatorExpression,
    Result,
)


def combined(
    line: int, operator: str, operands: Sequence[Expression], language: Language
) -> Expression:
    """The value of an operation."""
    if operator == "transpose" and not is_array(operands[0]):
        return operands[0]  # a number, or an array in one direction
    if not any(map(is_array, operands)):
        if operator in ("+", "-") and len(operands) == 2 and number(operands[0]) == 0:
            rest = operands[1]
            return rest if operator == "+" else OperatorExpression(line, "-", (rest,))
        return OperatorExpression(line, operator, tuple(operands))
    values = [Array(one.line, entries(one) or ()) if is_array(one) else one for one in operands]
    if operator == "transpose":
        return transposed(values[0])
    if len(values) == 1:
        return _each(line, operator, values, language)
    left, right = values
    is_matrix = is_square(left) or _is_inverse(left)
    if operator == "@" or (operator == "*" and language.has_matrix_products and is_matrix):
        return product(line, left, right, language)
    if operator in ("+", "-", "*", "/", "**"):
        return _each(line, operator, values, language)
    return OperatorExpression(line, operator, tuple(values))


def is_array(tree: Expression) -> bool:
    """Whether the entries of a value are known."""
    return isinstance(tree.value if isinstance(tree, Result) else tree, Array)


def is_square(tree: Expression) -> bool:
    """Whether a value is a matrix of as many rows as columns."""
    return isinstance(tree, Array) and all(
        isinstance(row, Array) and len(row.items) == len(tree.items) for row in tree.items
    )


def _is_inverse(tree: Expression) -> bool:
    return isinstance(tree, OperatorExpression) and tree.operator == "inverse"


def entries(tree: Expression) -> tuple[Expression, ...] | None:
    """The entries of an array, or of the solution of a linear system; None if not known."""
    match tree:
        case Array(items=items):
            return items
        case Result(call=call, value=value):
            result = entries(value)
            if result is None:
                return None
            numbers = (NumberLiteral(tree.line, str(i)) for i in range(len(result)))
            return tuple(
                Result(one.line, Item(tree.line, call, (number,)), one)
                for number, one in zip(numbers, result, strict=True)
            )
        case OperatorExpression(operator="solve", operands=(Array(items=rows), _)):
            return tuple(
                Item(tree.line, tree, (NumberLiteral(tree.line, str(i)),)) for i in range(len(rows))
            )
    return None


def flat(tree: Expression) -> Expression:
    """A column of rows of one entry as a plain array."""
    if isinstance(tree, Array) and tree.items:
        rows = [one.items if isinstance(one, Array) else () for one in tree.items]
        if all(len(row) == 1 for row in rows):
            return Array(tree.line, tuple(row[0] for row in rows))
        if len(tree.items) == 1 and rows[0]:
            return tree.items[0]
    return tree


def transposed(tree: Expression) -> Expression:
    """A matrix with rows and columns exchanged; a plain array stays as it is."""
    if isinstance(tree, Array) and all(isinstance(row, Array) for row in tree.items):
        rows = [row.items for row in tree.items if isinstance(row, Array)]
        if len({len(row) for row in rows}) == 1:
            return Array(tree.line, tuple(Array(tree.line, one) for one in zip(*rows, strict=True)))
    return tree


def product(line: int, left: Expression, right: Expression, language: Language) -> Expression:
    """The product of a matrix and a column, or of two columns."""
    if isinstance(left, OperatorExpression) and _is_inverse(left):
        return OperatorExpression(line, "solve", (left.operands[0], flat(right)))
    right = flat(right)
    if is_square(left) and isinstance(left, Array) and isinstance(right, Array):
        return Array(line, tuple(_dot(line, row, right, language) for row in left.items))
    if isinstance(left, Array) and isinstance(right, Array):
        return _dot(line, left, right, language)
    return OperatorExpression(line, "@", (left, right))


def _dot(line: int, left: Expression, right: Array, language: Language) -> Expression:
    if not isinstance(left, Array) or len(left.items) != len(right.items):
        return OperatorExpression(line, "@", (left, right))
    terms = [
        combined(line, "*", pair, language) for pair in zip(left.items, right.items, strict=True)
    ]
    return added(line, terms)


def added(line: int, terms: Sequence[Expression]) -> Expression:
    """The sum of several terms."""
    return reduce(lambda a, b: OperatorExpression(line, "+", (a, b)), terms)


def _each(line: int, operator: str, values: Sequence[Expression], language: Language) -> Expression:
    values = [flat(one) for one in values]
    lengths = {len(one.items) for one in values if isinstance(one, Array)}
    if len(lengths) > 1:
        return OperatorExpression(line, operator, tuple(values))
    (length,) = lengths
    rows = [_repeated(one, length, operator in "+-", language.first_index) for one in values]
    return Array(
        line,
        tuple(combined(line, operator, row, language) for row in zip(*rows, strict=True)),
    )


def _repeated(value: Expression, length: int, is_sum: bool, first: int) -> Sequence[Expression]:
    """The operands for each entry; an array is multiplied by numbers, and added to arrays."""
    if isinstance(value, Array):
        return value.items
    if is_sum and isinstance(value, Name):
        return [Name(value.line, f"{value.path}[{i + first}]") for i in range(length)]
    return (value,) * length
