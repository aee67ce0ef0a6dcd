"""Operations as named assignments: which values have a name, which name, and in what order.

A value is named when it is used more than once, or when writing it in place
would make a line long. A value of the parameters alone is always named where
other values use it.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from fractions import Fraction
from itertools import count

from derive.codegen import operation as op
from derive.codegen.lowering import Lowering
from derive.codegen.notation import Notation
from derive.codegen.operation import Operation, triangle_rows

#: Longest expression that is written in place instead of named.
IN_PLACE = 48

SUM, PRODUCT, ATOM = 1, 2, 3


@dataclass(frozen=True)
class Value:
    """``name = text``."""

    name: str
    text: str


@dataclass(frozen=True)
class Factorisation:
    """The factorisation of a symmetric matrix, given by its upper triangle row by row."""

    name: str
    entries: tuple[str, ...]

    @property
    def size(self) -> int:
        """Number of rows of the matrix."""
        return triangle_rows(len(self.entries))


@dataclass(frozen=True)
class Solution:
    """The solution of M x = right, with M factorised under the name `matrix`."""

    name: str
    matrix: str
    entries: tuple[str, ...]

    @property
    def size(self) -> int:
        """Number of equations."""
        return len(self.entries)


Statement = Value | Factorisation | Solution


@dataclass(frozen=True)
class Assignments:
    """The body of a function, in the notation of a target language.

    Attributes
    ----------
    constants, terms : tuple of Statement
        Named values of the parameters alone, and the other named values.
    outputs : tuple of str
        Expressions of the results.
    """

    constants: tuple[Statement, ...]
    terms: tuple[Statement, ...]
    outputs: tuple[str, ...]

    @property
    def statements(self) -> tuple[Statement, ...]:
        """All named values."""
        return self.constants + self.terms


def assignments(lowering: Lowering, reserved: Collection[str], notation: Notation) -> Assignments:
    """The assignments of `lowering`, without new names among those `reserved`."""
    writer = _Writer(lowering, reserved, notation)
    outputs = tuple(writer.text(output, 0) for output in lowering.outputs)
    return Assignments(tuple(writer.constants), tuple(writer.terms), outputs)


class _Writer:
    def __init__(self, lowering: Lowering, reserved: Collection[str], notation: Notation) -> None:
        self._operations, self._notation = lowering.operations, notation
        self._reserved = set(reserved)
        self._texts: dict[int, tuple[str, int]] = {}
        self._counters = {prefix: count() for prefix in ("c", "x", "factors", "solved")}
        self.constants: list[Statement] = []
        self.terms: list[Statement] = []
        self._uses: dict[int, int] = {}
        self._hoisted: set[int] = set()
        for output in lowering.outputs:
            self._count(output)

    def _count(self, n: int) -> None:
        self._uses[n] = self._uses.get(n, 0) + 1
        if self._uses[n] == 1:
            for operand in self._operations[n].operands:
                self._count(operand)
                if self._operations[operand].constant and not self._operations[n].constant:
                    self._hoisted.add(operand)

    def text(self, n: int, context: int) -> str:
        """The operation's name or expression, in brackets if it binds weaker than `context`."""
        if n not in self._texts:
            self._texts[n] = self._written(n)
        text, precedence = self._texts[n]
        return f"({text})" if precedence < context else text

    def _written(self, n: int) -> tuple[str, int]:
        operation = self._operations[n]
        match operation:
            case op.Factorised(operands):
                entries = self._entries(operands)
                statement = Factorisation(self._numbered("factors"), entries)
                return self._named(operation, statement), ATOM
            case op.Solution(operands):
                matrix, *right = self._entries(operands)
                solution = Solution(self._numbered("solved"), matrix, tuple(right))
                return self._named(operation, solution), ATOM
        text, precedence = self._expression(operation)
        in_place = self._uses[n] == 1 and n not in self._hoisted and len(text) <= IN_PLACE
        if in_place or isinstance(operation, op.Leaf | op.Constant | op.Component):
            return text, precedence
        return self._named(operation, Value(self._name(operation), text)), ATOM

    def _named(self, operation: Operation, statement: Statement) -> str:
        (self.constants if operation.constant else self.terms).append(statement)
        return statement.name

    def _entries(self, operands: Collection[int]) -> tuple[str, ...]:
        return tuple(self.text(operand, 0) for operand in operands)

    def _name(self, operation: Operation) -> str:
        if isinstance(operation, op.Call):
            argument = self.text(operation.operands[0], 0)
            name = f"{operation.function}_{argument}"
            if argument.isidentifier() and name not in self._reserved:
                self._reserved.add(name)
                return name
        return self._numbered("c" if operation.constant else "x")

    def _numbered(self, prefix: str) -> str:
        names = (f"{prefix}{i}" for i in self._counters[prefix])
        return next(name for name in names if name not in self._reserved)

    def _expression(self, operation: Operation) -> tuple[str, int]:
        notation = self._notation
        match operation:
            case op.Leaf(name=name):
                return notation.name(name), ATOM
            case op.Constant(value=value):
                return notation.literal(value), ATOM
            case op.Call((argument,), function=function):
                return notation.call(function, self.text(argument, 0)), ATOM
            case op.Component((solution,), index=index):
                return notation.component(self.text(solution, 0), index), ATOM
            case op.Quotient((*above, below)):
                top = self.text(above[0], PRODUCT) if above else notation.literal(Fraction(1))
                return f"{top}/{self.text(below, ATOM)}", PRODUCT
            case op.Product(operands):
                first, *rest = self._constants_first(operands)
                factors = [self.text(first, PRODUCT), *(self.text(n, ATOM) for n in rest)]
                return "*".join(factors), PRODUCT
            case op.Sum(operands, coefficients=coefficients):
                return self._sum(dict(zip(operands, coefficients, strict=True))), SUM
            case _:
                raise NotImplementedError(f"no text of a {type(operation).__name__} operation")

    def _constants_first(self, operands: Collection[int]) -> list[int]:
        return sorted(operands, key=lambda n: (not self._operations[n].constant, n))

    def _sum(self, coefficients: dict[int, Fraction]) -> str:
        ordered = self._constants_first(coefficients)
        positive = [n for n in ordered if coefficients[n] > 0]
        negative = [n for n in ordered if coefficients[n] < 0]
        if not positive and all(c == -1 for c in coefficients.values()) and len(negative) > 1:
            return f"-({' + '.join(self.text(n, SUM) for n in negative)})"
        text = ""
        for n in positive + negative:
            sign = "-" if n in negative else "+"
            scale, context = abs(coefficients[n]), PRODUCT if text or n in negative else SUM
            term = self.text(n, context if scale == 1 else PRODUCT)
            if scale != 1:
                term = f"{self._notation.literal(scale)}*{term}"
            text += f" {sign} {term}" if text else f"{sign.strip('+')}{term}"
        return text
