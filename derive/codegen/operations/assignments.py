"""Operations as named assignments: which values have a name, which name, and in what order.

A value is named when it is used more than once, or when writing it in place
would make a line long. A value of the parameters alone is always named where
other values use it.
"""

from collections.abc import Collection
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import cache
from itertools import count

from derive.codegen.expression_graph.node import Number
from derive.codegen.expression_graph.sympy_translation import UnsupportedFunctionError
from derive.codegen.operations import operation as op
from derive.codegen.operations.lowering import Lowering
from derive.codegen.operations.operation import Operation, triangle_rows
from derive.formulas.budget import LARGEST, RANGE

#: Longest expression that is written in place instead of named.
IN_PLACE = 48
#: Digits of irrational numbers, of which the longest types of C have 36, and series may have more.
DIGITS = 40

SUM, PRODUCT, ATOM = 1, 2, 3


# signs are those of numerators: comparisons of fractions take long
@cache
def _is_in_range(value: Fraction) -> bool:
    return -LARGEST < value < LARGEST


@cache
def _is_float(value: Number) -> bool:
    return bool(-LARGEST < value < LARGEST and value == float(value))


@cache
def _digits(value: Number) -> str:
    digits = repr(abs(float(value)))
    if Fraction(digits) != abs(value):
        with localcontext(prec=DIGITS):
            digits = f"{abs(Decimal(value.numerator)) / value.denominator:e}"
    return digits


class LanguageNotation:
    """How a target language writes names, numbers and calls; by default as Python and C do."""

    def name(self, name: str) -> str:
        """An input."""
        return name

    def literal(self, value: Fraction) -> str:
        """A number, exact where the floating-point numbers are."""
        if not _is_in_range(value):
            raise UnsupportedFunctionError(f"no generated code for a number out of range: {RANGE}")
        # a quotient of exact numbers is rounded once, in any type
        if _is_float(value) or not all(map(_is_float, (value.numerator, value.denominator))):
            return self.decimal(value)
        return f"({self.decimal(value.numerator)}/{self.decimal(value.denominator)})"

    def decimal(self, value: Number) -> str:
        """A number as a decimal fraction, with `DIGITS` where no float is equal to it."""
        return f"{'-' * (value.numerator < 0)}{_digits(value)}"

    def call(self, function: str, *arguments: str) -> str:
        """A call of ``select`` or of a mathematical function, by its name in C99."""
        return f"{function}({', '.join(arguments)})"

    def switch(self, index: int, value: str) -> str:
        """A switching function, or its sign if that is given with the parameters."""
        return f"({value})"

    def component(self, vector: str, index: int) -> str:
        """The component of a vector, from 0 on."""
        return f"{vector}[{index}]"


@dataclass(frozen=True)
class ValueAssignment:
    """``name = text``."""

    name: str
    text: str


@dataclass(frozen=True)
class FactorisationAssignment:
    """The factorisation of a symmetric matrix, given by its upper triangle row by row."""

    name: str
    size: int  # number of rows
    entries: tuple[str, ...]


@dataclass(frozen=True)
class SolutionAssignment:
    """The solution of M x = right, with M factorised under the name `matrix`."""

    name: str
    matrix: str
    right: tuple[str, ...]


Statement = ValueAssignment | FactorisationAssignment | SolutionAssignment


class Assignments:
    """The body of a function, in the notation of a target language.

    `constants` are named values of the parameters alone, `terms` the others; `outputs` are
    expressions of the results. New names are none of those `reserved`.
    """

    def __init__(
        self, lowering: Lowering, reserved: Collection[str], notation: LanguageNotation
    ) -> None:
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
        self.outputs = [self._text(output) for output in lowering.outputs]

    def _count(self, n: int) -> None:
        self._uses[n] = self._uses.get(n, 0) + 1
        if self._uses[n] == 1:
            for operand in self._operations[n].operands:
                self._count(operand)
                if self._operations[operand].constant and not self._operations[n].constant:
                    self._hoisted.add(operand)

    def _text(self, n: int, context: int = 0) -> str:
        """The operation's name or expression, in brackets if it binds weaker than `context`."""
        if n not in self._texts:
            self._texts[n] = self._written(n)
        text, precedence = self._texts[n]
        return f"({text})" if precedence < context else text

    def _written(self, n: int) -> tuple[str, int]:
        operation = self._operations[n]
        match operation:
            case op.FactorisedOperation(operands):
                entries, name = tuple(map(self._text, operands)), self._numbered("factors")
                return self._named(
                    n, FactorisationAssignment(name, triangle_rows(len(entries)), entries)
                )
            case op.SolutionOperation(operands):
                matrix, *right = map(self._text, operands)
                return self._named(
                    n, SolutionAssignment(self._numbered("solved"), matrix, tuple(right))
                )
        text, precedence = self._expression(operation)
        in_place = self._uses[n] == 1 and n not in self._hoisted and len(text) <= IN_PLACE
        if in_place or isinstance(
            operation, op.LeafOperation | op.ConstantOperation | op.ComponentOperation
        ):
            return text, precedence
        return self._named(n, ValueAssignment(self._name(operation), text))

    def _named(self, n: int, statement: Statement) -> tuple[str, int]:
        (self.constants if self._operations[n].constant else self.terms).append(statement)
        return statement.name, ATOM

    def _name(self, operation: Operation) -> str:
        if isinstance(operation, op.CallOperation) and len(operation.operands) == 1:
            argument = self._text(operation.operands[0])
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
            case op.LeafOperation(name=name):
                return notation.name(name), ATOM
            case op.ConstantOperation(value=value):
                return notation.literal(value), ATOM
            case op.CallOperation(operands, function=function):
                return notation.call(function, *map(self._text, operands)), ATOM
            case op.SwitchOperation((value,), index=index):
                return notation.switch(index, self._text(value)), ATOM
            case op.ComponentOperation((solution,), index=index):
                return notation.component(self._text(solution), index), ATOM
            case op.QuotientOperation((*above, below)):
                top = self._text(above[0], PRODUCT) if above else notation.literal(Fraction(1))
                return f"{top}/{self._text(below, ATOM)}", PRODUCT
            case op.ProductOperation(operands):
                first, *rest = self._constants_first(operands)
                factors = [self._text(first, PRODUCT), *(self._text(n, ATOM) for n in rest)]
                return "*".join(factors), PRODUCT
            case op.SumOperation(operands, coefficients=coefficients):
                return self._sum(dict(zip(operands, coefficients, strict=True))), SUM
            case _:
                raise NotImplementedError(f"no text of a {type(operation).__name__} operation")

    def _constants_first(self, operands: Collection[int]) -> list[int]:
        return sorted(operands, key=lambda n: (not self._operations[n].constant, n))

    def _sum(self, coefficients: dict[int, Fraction]) -> str:
        ordered = self._constants_first(coefficients)
        positive = [n for n in ordered if coefficients[n].numerator > 0]
        negative = [n for n in ordered if coefficients[n].numerator < 0]
        if not positive and all(c == -1 for c in coefficients.values()) and len(negative) > 1:
            return f"-({' + '.join(self._text(n, SUM) for n in negative)})"
        text = ""
        for n in positive + negative:
            sign = "-" if n in negative else "+"
            scale, context = abs(coefficients[n]), PRODUCT if text or n in negative else SUM
            term = self._text(n, context if scale == 1 else PRODUCT)
            if scale != 1:
                term = f"{self._notation.literal(scale)}*{term}"
            text += f" {sign} {term}" if text else f"{sign.strip('+')}{term}"
        return text
