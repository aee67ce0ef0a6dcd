"""Operations on arrays and functions of them, as far as their entries are known."""

import math
from collections.abc import Sequence
from functools import reduce
from operator import itemgetter

from derive.reading.programs.evaluation.mathematics import IDENTITIES, applied, split
from derive.reading.programs.evaluation.numeric_values import number
from derive.reading.programs.evaluation.sums import inner
from derive.reading.programs.languages.language import Language
from derive.reading.programs.syntax.trees import (
    Array,
    Expression,
    FunctionCall,
    Item,
    Name,
    NumberLiteral,
    Opaque,
    OperatorExpression,
    Result,
)

#: The largest limit of a denominator that only keeps it from zero.
SMALL_LIMIT = 0.01


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
    values = [_opened(one) for one in operands]
    if operator == "transpose":
        return transposed(values[0])
    if len(values) == 1:
        return _each(line, operator, values, language)
    if operator == "solve":
        return OperatorExpression(line, operator, tuple(flat(inner(one)) for one in operands))
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


def _opened(tree: Expression) -> Expression:
    """An array of arrays, of which some are values of calls, as written."""
    return Array(tree.line, tuple(map(_opened, entries(tree) or ()))) if is_array(tree) else tree


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
        case OperatorExpression(
            operator="solve", operands=(Array(items=rows), _) | (Name(), Array(items=rows))
        ):
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


def turned(tree: Expression) -> Expression:
    """A matrix with rows and columns exchanged; rows and columns are plain arrays."""
    return flat(transposed(tree))


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


#: Functions that place arrays one behind the other.
STACKED = {"concatenate", "hstack", "vcat", "block", "concat", "r_", "append", "vstack"}
#: Methods of a matrix of Eigen that return it in factors.
FACTORED = {"ldlt", "llt", "lu", "partialPivLu", "fullPivLu", "householderQr"}
FACTORED |= {"colPivHouseholderQr", "fullPivHouseholderQr"}
#: Methods that return the array, perhaps in another shape or type.
RESHAPED = {"copy", "flatten", "ravel", "tolist", "astype", "item"}
RESHAPED |= {"clone", "to_vec", "iter", "into_iter", "collect", "unwrap"}


def of_arrays(
    call: FunctionCall, path: str, base: Expression | None, language: Language
) -> Expression | None:
    """The value of a function of arrays, or of a method of `base`; None for others."""
    library, name = split(path)
    is_method = base is not None and library not in ("np", "numpy", "jnp")
    match name, call.arguments:
        case "sum" | "accu", (array,) if items := entries(array):
            return added(call.line, items)
        case "sum", () if base is not None and (items := entries(base)):
            return added(call.line, items)
        case (("norm" | "magnitude" | "mag"), (array,)) if items := entries(array):
            return _norm(call.line, items)
        case (("norm" | "mag"), ()) if base is not None and (items := entries(base)):
            return _norm(call.line, items)
        case "hypot", (x, y):
            return _norm(call.line, (x, y))
        case "hat", (array,) if items := entries(array):
            return combined(call.line, "/", (array, _norm(call.line, items)), language)
        case "hat", () if base is not None and (items := entries(base)):
            return combined(call.line, "/", (base, _norm(call.line, items)), language)
        case "mag2", (array,) if items := entries(array):
            return _norm(call.line, items).parts[1]
        case (("max" | "min" | "maximum" | "minimum"), given) if best := _extreme(name, given):
            return best
        case ("max" | "min", (FunctionCall(function=Name(path=other), arguments=(x, _)), _)) if {
            name,
            split(other)[1],
        } == {"max", "min"}:
            return x  # between two limits
        case "dot", (right,) if base is not None:
            return product(call.line, base, right, language)
        case ("dot" | "matmul" | "dot_product", (left, right)):
            return product(call.line, left, right, language)
        case ("solve" | "linsolve" | "mldivide", (matrix, column)):
            return OperatorExpression(call.line, "solve", (inner(matrix), flat(inner(column))))
        case "solve", (column,) if is_method and base is not None:  # of Eigen
            return OperatorExpression(call.line, "solve", (inner(base), flat(inner(column))))
        case "inverse", () if is_method and base is not None:
            return OperatorExpression(call.line, "inverse", (base,))
        case name, () if name in FACTORED and is_method and base is not None:
            return base
        case ("inv" | "pinv" | "inverse", (matrix,)):
            return OperatorExpression(call.line, "inverse", (matrix,))
        case "sincos" | "sin_cos", (x,):
            names = (Name(call.line, one) for one in ("sin", "cos"))
            return Array(call.line, tuple(FunctionCall(call.line, one, (x,)) for one in names))
        case "reshape", shape if is_method and base is not None:
            is_row = shape[-1:] in (
                (NumberLiteral(0, "1"),),
                (OperatorExpression(0, "-", (NumberLiteral(0, "1"),)),),
            )
            return flat(base) if is_row else Opaque(call.line, "another shape is not followed")
        case "transpose", () if is_method and base is not None:
            return turned(base)
        case _ if is_method and base is not None and name in RESHAPED:
            return flat(base)
        case "concatenate", (Array(items=parts), *_) if any(isinstance(x, Name) for x in parts):
            return Opaque(call.line, "an array of unknown length is not followed")
        case _, (first, *rest) if name in STACKED and (stacked := _stacked(first, rest)):
            return stacked
        case _, (first, *rest) if name in IDENTITIES:
            return (
                first if not rest or isinstance(first, Array) else Array(call.line, call.arguments)
            )
    return None


def of_entries(line: int, path: str, arguments: tuple[Expression, ...]) -> Expression | None:
    """The value of a function of mathematics, of each entry of an array."""
    if len(arguments) == 1 and (items := entries(arguments[0])) is not None:
        values = [applied(line, path, (one,)) for one in items]
        return Array(line, tuple(v for v in values if v)) if all(values) else None
    return applied(line, path, arguments)


def _extreme(name: str, given: Sequence[Expression]) -> Expression | None:
    """The largest or the smallest of numbers, or a value within limits; None for others.

    A limit of 0 is that of a contact or a thread, which has another equation on its other side;
    that of an expression, which is no variable, must be one that only avoids a division by zero.
    """
    values = [(value, one) for one in given if (value := number(one)) is not None]
    others = [one for one in given if number(one) is None]
    if not values or others:
        if len(others) != 1 or not values:
            return None
        most = math.inf if isinstance(others[0], Name) else SMALL_LIMIT
        return others[0] if all(0 < abs(v) <= most for v, _ in values) else None
    return (max if name.startswith("max") else min)(values, key=itemgetter(0))[1]


def _norm(line: int, items: Sequence[Expression]) -> Expression:
    """The length of a vector."""
    two = NumberLiteral(line, "2")
    squares = [OperatorExpression(line, "**", (one, two)) for one in items]
    return FunctionCall(line, Name(line, "sqrt"), (added(line, squares),))


def _stacked(first: Expression, rest: Sequence[Expression]) -> Expression | None:
    """Arrays one behind the other."""
    arrays = [*first.items] if isinstance(first, Array) and not rest else [first, *rest]
    parts = [entries(one) for one in arrays]
    if not arrays or all(part is None for part in parts):
        return first if isinstance(first, Array) and not rest else None
    rows = [part if part is not None else (one,) for one, part in zip(arrays, parts, strict=True)]
    return Array(first.line, tuple(one for row in rows for one in row))
