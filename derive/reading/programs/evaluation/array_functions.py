"""Functions of arrays, as languages and libraries name them."""

from collections.abc import Sequence
from operator import itemgetter

from derive.reading.programs.evaluation.arrays import added, entries, flat, product
from derive.reading.programs.evaluation.mathematics import IDENTITIES, applied, split
from derive.reading.programs.evaluation.numeric_values import number
from derive.reading.programs.evaluation.sums import inner
from derive.reading.programs.languages.language import Language
from derive.reading.programs.syntax.trees import (
    Array,
    Expression,
    FunctionCall,
    Name,
    NumberLiteral,
    Opaque,
    OperatorExpression,
)

#: Functions that place arrays one behind the other.
STACKED = {"concatenate", "hstack", "vcat", "block", "concat", "r_", "append", "vstack"}
#: Methods of a matrix of Eigen that return it in factors.
FACTORED = {"ldlt", "llt", "lu", "partialPivLu", "fullPivLu", "householderQr"}
FACTORED |= {"colPivHouseholderQr", "fullPivHouseholderQr"}
#: Methods that return the array, perhaps in another shape or type.
RESHAPED = {"copy", "flatten", "ravel", "tolist", "transpose", "astype", "item"}


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
        case (("max" | "min" | "maximum" | "minimum"), given) if best := _extreme(name, given):
            return best
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
        case "sincos", (x,):
            names = (Name(call.line, one) for one in ("sin", "cos"))
            return Array(call.line, tuple(FunctionCall(call.line, one, (x,)) for one in names))
        case "reshape", shape if is_method and base is not None:
            is_row = shape[-1:] in (
                (NumberLiteral(0, "1"),),
                (OperatorExpression(0, "-", (NumberLiteral(0, "1"),)),),
            )
            return flat(base) if is_row else Opaque(call.line, "another shape is not followed")
        case _ if is_method and base is not None and name in RESHAPED:
            return flat(base)
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
    """The largest or the smallest of numbers; None if others are among them."""
    values = [(value, one) for one in given if (value := number(one)) is not None]
    if not given or len(values) < len(given):
        return None
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
