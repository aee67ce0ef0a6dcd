"""Straight-line operations: each computes one value from earlier ones."""

from dataclasses import dataclass
from fractions import Fraction
from math import isqrt


@dataclass(frozen=True, slots=True)
class Operation:
    """One value, computed from earlier ones."""

    operands: tuple[int, ...]  # numbers of operations; a repeated factor occurs twice
    constant: bool  # whether it depends on parameters alone


@dataclass(frozen=True, slots=True)
class LeafOperation(Operation):
    """An input."""

    name: str


@dataclass(frozen=True, slots=True)
class ConstantOperation(Operation):
    """An exact number."""

    value: Fraction


@dataclass(frozen=True, slots=True)
class SumOperation(Operation):
    """The sum of coefficient times operand."""

    coefficients: tuple[Fraction, ...]


class ProductOperation(Operation):
    """The product of the operands."""


class QuotientOperation(Operation):
    """The quotient of two operands, or the reciprocal of one."""


@dataclass(frozen=True, slots=True)
class CallOperation(Operation):
    """A call of a function."""

    function: str


@dataclass(frozen=True, slots=True)
class SwitchOperation(Operation):
    """A switching function, for which its sign may stand."""

    index: int


class FactorisedOperation(Operation):
    """A factorised symmetric matrix; the operands are its upper triangle, row by row."""


class SolutionOperation(Operation):
    """The solution of M x = b; the operands are the factorised matrix M and the entries of b."""


@dataclass(frozen=True, slots=True)
class ComponentOperation(Operation):
    """One component of a solution."""

    index: int


def cost(operation: Operation) -> int:
    """Number of arithmetic operations and function calls."""
    n = len(operation.operands)
    match operation:
        case SumOperation(coefficients=coefficients):
            scalings = sum(c not in (1, -1) for c in coefficients)
            return n - 1 + scalings + all(c == -1 for c in coefficients)
        case ProductOperation():
            return n - 1
        case QuotientOperation() | CallOperation():
            return 1
        case FactorisedOperation():
            # the reciprocal of every pivot, and for every row below it a multiple of its row
            return sum(1 + k + k * (k + 1) for k in range(triangle_rows(n)))
        case SolutionOperation():
            return n - 1 + 2 * (n - 1) * (n - 2)
    return 0


def triangle_rows(count: int) -> int:
    """Number of rows of a matrix whose upper triangle has `count` entries."""
    return (isqrt(8 * count + 1) - 1) // 2
