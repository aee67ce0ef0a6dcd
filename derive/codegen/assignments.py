"""Operations as named assignments: what gets a name, which one, and in what order.

A value is named when it is used more than once, or when writing it in place
would make a line long. What depends on parameters alone always has one where
the rest uses it. The expressions are valid in Python and in C alike.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from math import isqrt
from types import MappingProxyType

from derive.codegen.lowering import Lowering
from derive.codegen.operation import Operation

#: Longest expression that is written in place instead of named.
IN_PLACE = 48

SUM, PRODUCT, ATOM = 1, 2, 3


@dataclass(frozen=True)
class Statement:
    """A value with a name.

    Attributes
    ----------
    name, text : str
        The name and the expression; of ``factors`` and ``solved`` that of what is taken apart
        or solved with.
    kind : {"value", "factors", "solved"}
        A number; a symmetric matrix taken apart; the solution with one that is.
    parts : tuple of str
        Entries of the matrix, its upper triangle row by row; or the right side.
    """

    name: str
    text: str
    kind: str = "value"
    parts: tuple[str, ...] = ()

    @property
    def size(self) -> int:
        """Rows of the matrix, or of the right side."""
        count = len(self.parts)
        return (isqrt(8 * count + 1) - 1) // 2 if self.kind == "factors" else count


@dataclass(frozen=True)
class Assignments:
    """A function's body, ready to be laid out in a language.

    Attributes
    ----------
    inputs : frozenset of str
        Names of the leaves that are used.
    called : frozenset of str
        Names of the functions that are called.
    constants, terms : tuple of Statement
        What has a name, that of the parameters alone first.
    outputs : tuple of str
        Expressions of the results.
    operations, constant_operations : int
        Arithmetic operations and function calls, and those of the parameters alone.
    """

    inputs: frozenset[str]
    called: frozenset[str]
    constants: tuple[Statement, ...]
    terms: tuple[Statement, ...]
    outputs: tuple[str, ...]
    operations: int
    constant_operations: int

    @property
    def count(self) -> str:
        """The number of operations, in words."""
        return (
            f"{self.operations} operations, {self.constant_operations} of them on parameters alone."
        )


def assignments(
    lowering: Lowering, taken: Collection[str], called: Mapping[str, str] = MappingProxyType({})
) -> Assignments:
    """Lay out `lowering`; no new name is one of those `taken`, and inputs are `called` so."""
    writer = _Writer(lowering, taken, called)
    outputs = tuple(writer.text(output, 0) for output in lowering.outputs)
    used = [lowering.operations[n] for n in writer.uses]
    return Assignments(
        inputs=frozenset(o.label for o in used if o.kind == "leaf"),
        called=frozenset(o.label for o in used if o.kind == "call"),
        constants=tuple(writer.constants),
        terms=tuple(writer.terms),
        outputs=outputs,
        operations=sum(o.cost() for o in used),
        constant_operations=sum(o.cost() for o in used if o.constant),
    )


def number(value: Fraction) -> str:
    """A constant as Python and C write it, exact where the machine's numbers are."""
    above, below = float(value.numerator), float(value.denominator)
    # a quotient of exact numbers is rounded once, in whatever type
    if value == float(value) or (above, below) != (value.numerator, value.denominator):
        return repr(float(value))
    return f"({above!r}/{below!r})"


class _Writer:
    def __init__(
        self, lowering: Lowering, taken: Collection[str], called: Mapping[str, str]
    ) -> None:
        self._operations, self._taken, self._called = lowering.operations, set(taken), called
        self._written: dict[int, tuple[str, int]] = {}
        self._counters = {letter: count() for letter in ("c", "x", "factors", "solved")}
        self.constants: list[Statement] = []
        self.terms: list[Statement] = []
        self.uses: dict[int, int] = {}
        self._hoisted: set[int] = set()
        for output in lowering.outputs:
            self._count(output)

    def _count(self, n: int) -> None:
        self.uses[n] = self.uses.get(n, 0) + 1
        if self.uses[n] == 1:
            for operand in self._operations[n].operands:
                self._count(operand)
                if self._operations[operand].constant and not self._operations[n].constant:
                    self._hoisted.add(operand)

    def text(self, n: int, context: int) -> str:
        """The operation's name or expression, in brackets if it binds weaker than `context`."""
        if n not in self._written:
            self._written[n] = self._write(n)
        text, precedence = self._written[n]
        return f"({text})" if precedence < context else text

    def _write(self, n: int) -> tuple[str, int]:
        operation = self._operations[n]
        if operation.kind in ("factors", "solved"):
            return self._parts(operation), ATOM
        text, precedence = self._expression(operation)
        in_place = self.uses[n] == 1 and n not in self._hoisted and len(text) <= IN_PLACE
        if in_place or operation.kind in ("leaf", "number", "component"):
            return text, precedence
        name = self._name(operation)
        (self.constants if operation.constant else self.terms).append(Statement(name, text))
        return name, ATOM

    def _parts(self, operation: Operation) -> str:
        """The name of a matrix taken apart, or of a solution."""
        texts = [self.text(operand, 0) for operand in operation.operands]
        matrix = texts.pop(0) if operation.kind == "solved" else ""
        name = self._numbered(operation.kind)
        statement = Statement(name, matrix, operation.kind, tuple(texts))
        (self.constants if operation.constant else self.terms).append(statement)
        return name

    def _name(self, operation: Operation) -> str:
        if operation.kind == "call":
            argument = self.text(operation.operands[0], 0)
            name = f"{operation.label}_{argument}"
            if argument.isidentifier() and name not in self._taken:
                self._taken.add(name)
                return name
        return self._numbered("c" if operation.constant else "x")

    def _numbered(self, letter: str) -> str:
        names = (f"{letter}{i}" for i in self._counters[letter])
        return next(name for name in names if name not in self._taken)

    def _expression(self, operation: Operation) -> tuple[str, int]:
        match operation.kind:
            case "leaf":
                return self._called.get(operation.label, operation.label), ATOM
            case "number":
                return number(operation.value), ATOM
            case "call":
                return f"{operation.label}({self.text(operation.operands[0], 0)})", ATOM
            case "component":
                return f"{self.text(operation.operands[0], 0)}[{operation.value}]", ATOM
            case "quotient":
                *above, below = operation.operands
                top = self.text(above[0], PRODUCT) if above else number(Fraction(1))
                return f"{top}/{self.text(below, ATOM)}", PRODUCT
            case "product":
                first, *rest = self._constants_first(operation.operands)
                factors = [self.text(first, PRODUCT), *(self.text(n, ATOM) for n in rest)]
                return "*".join(factors), PRODUCT
            case _:
                return self._sum(operation), SUM

    def _constants_first(self, operands: tuple[int, ...]) -> list[int]:
        return sorted(operands, key=lambda n: (not self._operations[n].constant, n))

    def _sum(self, operation: Operation) -> str:
        coefficients = dict(zip(operation.operands, operation.coefficients, strict=True))
        ordered = self._constants_first(operation.operands)
        positive = [n for n in ordered if coefficients[n] > 0]
        negative = [n for n in ordered if coefficients[n] < 0]
        if not positive and all(c == -1 for c in coefficients.values()) and len(negative) > 1:
            return f"-({' + '.join(self.text(n, SUM) for n in negative)})"
        text = ""
        for n in positive + negative:
            sign = "-" if n in negative else "+"
            scale, context = abs(coefficients[n]), PRODUCT if text or n in negative else SUM
            term = (
                self.text(n, context) if scale == 1 else f"{number(scale)}*{self.text(n, PRODUCT)}"
            )
            text += f" {sign} {term}" if text else f"{sign.strip('+')}{term}"
        return text
