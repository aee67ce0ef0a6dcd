"""Straight-line operations: each computes one value from earlier ones."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import isqrt


@dataclass(frozen=True, slots=True)
class Operation:
    """One value, computed from earlier ones.

    Attributes
    ----------
    operands : tuple of int
        Numbers of the operations it uses; a repeated factor occurs twice.
    constant : bool
        Whether it depends on parameters alone.
    """

    operands: tuple[int, ...]
    constant: bool

    def cost(self) -> int:
        """Number of arithmetic operations and function calls."""
        return 0


@dataclass(frozen=True, slots=True)
class Leaf(Operation):
    """An input."""

    name: str


@dataclass(frozen=True, slots=True)
class Constant(Operation):
    """An exact number."""

    value: Fraction


@dataclass(frozen=True, slots=True)
class Sum(Operation):
    """The sum of coefficient times operand."""

    coefficients: tuple[Fraction, ...]

    def cost(self) -> int:
        scalings = sum(abs(c) != 1 for c in self.coefficients)
        negation = all(c == -1 for c in self.coefficients)
        return len(self.operands) - 1 + scalings + negation


@dataclass(frozen=True, slots=True)
class Product(Operation):
    """The product of the operands."""

    def cost(self) -> int:
        return len(self.operands) - 1


@dataclass(frozen=True, slots=True)
class Quotient(Operation):
    """The quotient of two operands, or the reciprocal of one."""

    def cost(self) -> int:
        return 1


@dataclass(frozen=True, slots=True)
class Call(Operation):
    """A call of a function of one argument."""

    function: str

    def cost(self) -> int:
        return 1


@dataclass(frozen=True, slots=True)
class Factorised(Operation):
    """A factorised symmetric matrix; the operands are its upper triangle, row by row."""

    def cost(self) -> int:
        # the reciprocal of every pivot, and for every row below it a multiple of its row
        return sum(1 + k + k * (k + 1) for k in range(triangle_rows(len(self.operands))))


@dataclass(frozen=True, slots=True)
class Solution(Operation):
    """The solution of M x = b; the operands are the factorised matrix M and the entries of b."""

    def cost(self) -> int:
        n = len(self.operands) - 1
        return n + 2 * n * (n - 1)


@dataclass(frozen=True, slots=True)
class Component(Operation):
    """One component of a solution."""

    index: int


def triangle_rows(count: int) -> int:
    """Number of rows of a matrix whose upper triangle has `count` entries."""
    return (isqrt(8 * count + 1) - 1) // 2
