"""Numbers that expressions of programs amount to."""

import math
from contextlib import suppress

from derive.reading.programs.syntax.trees import (
    Array,
    Expression,
    Name,
    NumberLiteral,
    OperatorExpression,
    Result,
)


def number(tree: Expression) -> float | None:
    """The value of an expression of numbers and pi; None for others."""
    match tree:
        case NumberLiteral(digits=digits):
            return float(digits)
        case Name(path="pi"):
            return math.pi
        case Result(value=inner):
            return number(inner)
        case OperatorExpression(operator="-", operands=(operand,)):
            positive = number(operand)
            return None if positive is None else -positive
        case OperatorExpression(operator=operator, operands=(left, right)):
            a, b = number(left), number(right)
            if a is not None and b is not None:
                with suppress(ArithmeticError, TypeError, ValueError):
                    return combined(operator, a, b)
    return None


def constant(tree: Expression) -> float | tuple[float, ...] | None:
    """The value of a number, or of an array of some; None for others."""
    value = tree.value if isinstance(tree, Result) else tree
    if isinstance(value, Array) and value.items:
        numbers = tuple(n for one in value.items if (n := number(one)) is not None)
        return numbers if len(numbers) == len(value.items) else None
    return number(tree)


def combined(operator: str, a: float, b: float) -> float:
    """The value of an operation.

    Raises
    ------
    ArithmeticError, TypeError, ValueError
        If it has no real value, or the operator is that of matrices.
    """
    match operator:
        case "+":
            return a + b
        case "-":
            return a - b
        case "*":
            return a * b
        case "/":
            return a / b
        case "**":
            return float(a**b)
    raise ValueError(f"{operator} is no operation on numbers")
