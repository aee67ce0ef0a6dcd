"""From the n-ary graph to straight-line operations.

Two choices are made here. Factors and terms that depend on parameters alone
are grouped, so that they can be computed once a run; a division by parameters
becomes a product with their inverse for the same reason. Then parts that
several products or sums have in common (``a*b*c`` and ``a*b*d`` share ``a*b``)
become operations of their own.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from fractions import Fraction
from typing import TypeVar

from derive.codegen.graph import Node
from derive.codegen.operation import Operation
from derive.codegen.sharing import share_pairs

ONE = Fraction(1)
Count = TypeVar("Count", int, Fraction)


class Lowering:
    """The operations that compute `outputs` from the leaves.

    Attributes
    ----------
    operations : dict of number to Operation, in no particular order
    outputs : the operations' numbers, in the order of the given nodes
    """

    def __init__(self, outputs: Sequence[Node], parameters: Collection[str]) -> None:
        self.operations: dict[int, Operation] = {}
        self._parameters = parameters
        self._numbers: dict[Operation, int] = {}
        self._lowered: dict[Node, int] = {}
        self.outputs = tuple(self._lower(node) for node in outputs)
        share_pairs(self.operations)

    def _add(self, operation: Operation) -> int:
        number = self._numbers.setdefault(operation, len(self._numbers))
        self.operations[number] = operation
        return number

    def _lower(self, node: Node) -> int:
        if node not in self._lowered:
            self._lowered[node] = self._operation(node)
        return self._lowered[node]

    def _operation(self, node: Node) -> int:
        match node.kind:
            case "leaf":
                constant = node.content in self._parameters
                return self._add(Operation("leaf", label=node.content, constant=constant))
            case "number":
                return self._number(node.content)
            case "let":
                return self._lower(node.content)
            case "call":
                function, argument = node.content
                operands = (self._lower(argument),)
                constant = self._constant(operands)
                return self._add(Operation("call", operands, label=function, constant=constant))
            case "factors" | "solved":
                parts = tuple(self._lower(operand) for operand in node.operands())
                constant = self._constant(parts)
                return self._add(Operation(node.kind, parts, constant=constant))
            case "component":
                solved, index = self._lower(node.content[0]), Fraction(node.content[1])
                constant = self._constant((solved,))
                return self._add(Operation("component", (solved,), value=index, constant=constant))
            case "sum":
                terms = _merged([self._term(term, c) for term, c in node.content])
                return self._sum(terms) if terms else self._number(0)
            case _:
                powers = _merged([(self._lower(factor), p) for factor, p in node.content])
                return self._product(powers) if powers else self._number(1)

    def _number(self, value: Fraction | int) -> int:
        return self._add(Operation("number", value=Fraction(value), constant=True))

    def _term(self, node: Node, coefficient: Fraction) -> tuple[int, Fraction]:
        """A term of a sum; a number is one, and no multiple of 1."""
        if node.kind == "number":
            value = node.content * coefficient
            return self._number(abs(value)), ONE if value > 0 else -ONE
        return self._lower(node), coefficient

    def _sum(self, terms: list[tuple[int, Fraction]]) -> int:
        for part in self._parts(terms):
            if 1 < len(part) < len(terms):
                scale = abs(part[0][1]) if len({abs(c) for _, c in part}) == 1 else ONE
                inner = self._sum([(n, c / scale) for n, c in part])
                return self._sum([(inner, scale), *(t for t in terms if t not in part)])
        operands, coefficients = zip(*sorted(terms), strict=True)
        if coefficients == (ONE,):
            return operands[0]
        return self._add(
            Operation("sum", operands, coefficients, constant=self._constant(operands))
        )

    def _parts(self, terms: list[tuple[int, Fraction]]) -> Iterator[list[tuple[int, Fraction]]]:
        """Terms that are better added up first: the constants, those of one coefficient."""
        yield [t for t in terms if self.operations[t[0]].constant]
        for scale in {abs(c): None for _, c in terms if abs(c) != 1}:
            yield [t for t in terms if abs(t[1]) == scale]

    def _constant(self, operands: Iterable[int]) -> bool:
        return all(self.operations[n].constant for n in operands)

    def _product(self, powers: list[tuple[int, int]]) -> int:
        above = [n for n, power in powers for _ in range(power)]
        below = [n for n, power in powers for _ in range(-power)]
        constant_below = [n for n in below if self.operations[n].constant]
        if constant_below and len(constant_below) < len(above) + len(below):
            inverse = self._quotient(None, self._factors(constant_below))
            above.append(inverse)
            below = [n for n in below if n not in constant_below]
        if not below:
            return self._factors(above)
        return self._quotient(self._factors(above) if above else None, self._factors(below))

    def _factors(self, factors: list[int]) -> int:
        constant = [n for n in factors if self.operations[n].constant]
        if 1 < len(constant) < len(factors):
            factors = [self._factors(constant), *(n for n in factors if n not in constant)]
        if len(factors) == 1:
            return factors[0]
        operands = tuple(sorted(factors))
        return self._add(Operation("product", operands, constant=self._constant(operands)))

    def _quotient(self, above: int | None, below: int) -> int:
        operands = (below,) if above is None else (above, below)
        return self._add(Operation("quotient", operands, constant=self._constant(operands)))


def _merged(parts: list[tuple[int, Count]]) -> list[tuple[int, Count]]:
    """Terms or factors, each but once: a ``let`` may hide that two are the same."""
    totals: dict[int, Count] = {}
    for number, count in parts:
        totals[number] = totals[number] + count if number in totals else count
    return [(number, count) for number, count in totals.items() if count]
