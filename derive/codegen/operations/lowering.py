"""From the n-ary graph to straight-line operations.

Factors and terms that depend on parameters alone are grouped, so that they can
be computed once a run; a division by parameters becomes a product with their
reciprocal for the same reason. Then parts that several products or sums have in
common (``a*b*c`` and ``a*b*d`` share ``a*b``) become separate operations.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from fractions import Fraction
from functools import cache, cached_property
from math import prod
from typing import Any, TypeVar

from derive.codegen.expression_graph.node import (
    CallNode,
    ComponentNode,
    ConstantNode,
    FactorisedNode,
    IrrationalNode,
    LeafNode,
    LetNode,
    Node,
    ProductNode,
    RewrittenNode,
    SolutionNode,
    SumNode,
    SwitchNode,
    Terms,
    operands,
)
from derive.codegen.operations import operation as op
from derive.codegen.operations.sharing import share_pairs

ONE = Fraction(1)
Count = TypeVar("Count", int, Fraction)
Term = tuple[int, Fraction]


class Lowering:
    """The operations that compute `outputs`, by number; of `parameters` alone they are constant."""

    def __init__(self, outputs: Sequence[Node], parameters: Collection[str]) -> None:
        self.operations: dict[int, op.Operation] = {}  # in no particular order
        self._parameters = parameters
        self._numbers: dict[op.Operation, int] = {}
        self._lower = cache(self._operation)
        self.outputs = tuple(self._lower(node) for node in outputs)
        share_pairs(self.operations)

    @cached_property
    def used(self) -> tuple[op.Operation, ...]:
        """The operations that the outputs depend on."""
        return self._required(self.outputs)

    def _required(self, outputs: Iterable[int]) -> tuple[op.Operation, ...]:
        numbers, pending = set(outputs), list(outputs)
        while pending:
            new = set(self.operations[pending.pop()].operands) - numbers
            numbers |= new
            pending += new
        return tuple(self.operations[n] for n in numbers)

    @property
    def inputs(self) -> frozenset[str]:
        """Names of the leaves."""
        return self.inputs_of(self.outputs)

    def inputs_of(self, outputs: Sequence[int]) -> frozenset[str]:
        """Names of the leaves that some of the outputs depend on."""
        return frozenset(o.name for o in self._required(outputs) if isinstance(o, op.LeafOperation))

    @property
    def functions(self) -> frozenset[str]:
        """Names of the functions that are called."""
        return frozenset(o.function for o in self.used if isinstance(o, op.CallOperation))

    @property
    def library_functions(self) -> frozenset[str]:
        """Those of the mathematical library, which numbers call and vectors cannot."""
        return self.functions - {"select"}

    @property
    def has_switches(self) -> bool:
        """Whether a result depends on the signs of switching functions."""
        return any(isinstance(o, op.SwitchOperation) for o in self.used)

    @property
    def cost(self) -> tuple[int, int]:
        """Arithmetic operations and calls: their number, and how many are of parameters alone."""
        costs = [(op.cost(o), o.constant) for o in self.used]
        return sum(cost for cost, _ in costs), sum(cost for cost, constant in costs if constant)

    def _add(self, kind: type[op.Operation], operands: Iterable[int], *content: Any) -> int:
        operands = tuple(operands)
        constant = all(self.operations[n].constant for n in operands)
        return self._register(kind(operands, constant, *content))

    def _register(self, operation: op.Operation) -> int:
        number = self._numbers.setdefault(operation, len(self._numbers))
        self.operations[number] = operation
        return number

    def _operation(self, node: Node) -> int:
        match node:
            case LeafNode(name):
                return self._register(op.LeafOperation((), name in self._parameters, name))
            case ConstantNode(value) | IrrationalNode(value):
                return self._constant(value)
            case LetNode(inner) | RewrittenNode(value=inner):
                return self._lower(inner)
            case CallNode(function, arguments):
                return self._add(op.CallOperation, map(self._lower, arguments), function)
            case SwitchNode(index, value):
                return self._add(op.SwitchOperation, [self._lower(value)], index)
            case FactorisedNode(upper):
                return self._add(op.FactorisedOperation, map(self._lower, upper))
            case SolutionNode():
                return self._add(op.SolutionOperation, map(self._lower, operands(node)))
            case ComponentNode(solution, index):
                return self._add(op.ComponentOperation, [self._lower(solution)], index)
            case SumNode(terms):
                merged = [t for t in _merged(list(self._terms(terms))) if not self._is_zero(t[0])]
                return self._sum(merged) if merged else self._constant(0)
            case ProductNode():
                factors = _merged(list(self._powers(*_numeric(node))))
                if any(self._is_zero(n) for n, _ in factors):
                    return self._constant(0)
                return self._product(factors) if factors else self._constant(1)
            case _:
                raise NotImplementedError(f"no operation for a {type(node).__name__} node")

    def _is_zero(self, n: int) -> bool:
        """Whether an operation is 0, as a sum may be whose terms cancel without their `LetNode`."""
        operation = self.operations[n]
        return isinstance(operation, op.ConstantOperation) and operation.value == 0

    def _constant(self, value: Fraction | int) -> int:
        return self._add(op.ConstantOperation, (), Fraction(value))

    def _terms(self, terms: Terms) -> Iterator[Term]:
        """Terms of a sum; numbers are one term, and irrational factors include coefficients."""
        parts = [(*_numeric(node), coefficient) for node, coefficient in terms]
        numbers = (number * c for number, rest, c in parts if rest is None)
        total = sum(numbers, start=Fraction(0))
        for number, rest, coefficient in parts:
            value = total if rest is None else number * coefficient
            sign = ONE if value > 0 else -ONE
            if rest is None and value:
                yield self._constant(abs(value)), sign
                total = Fraction(0)
            elif rest is not None and number == 1:
                yield self._lower(rest), coefficient
            elif rest is not None:
                yield self._product(_merged(list(self._powers(abs(value), rest)))), sign

    def _powers(self, number: Fraction, rest: Node | None) -> Iterator[tuple[int, int]]:
        """Factors of a product, of which a number other than 1 is the first."""
        if number != 1:
            yield self._constant(number), 1
        for factor, power in rest.factors() if rest else ():
            yield self._lower(factor), power

    def _sum(self, terms: list[Term]) -> int:
        for part in self._parts(terms):
            if 1 < len(part) < len(terms):
                scale = abs(part[0][1]) if len({abs(c) for _, c in part}) == 1 else ONE
                inner = self._sum([(n, c / scale) for n, c in part])
                return self._sum([(inner, scale), *(t for t in terms if t not in part)])
        operands, coefficients = zip(*sorted(terms), strict=True)
        if coefficients == (ONE,):
            return operands[0]
        return self._add(op.SumOperation, operands, coefficients)

    def _parts(self, terms: list[Term]) -> Iterator[list[Term]]:
        """Terms to add first: the constants, then those with a common coefficient."""
        yield [t for t in terms if self.operations[t[0]].constant]
        by_scale: dict[Fraction, list[Term]] = {}
        for n, coefficient in terms:
            by_scale.setdefault(abs(coefficient), []).append((n, coefficient))
        yield from (part for scale, part in by_scale.items() if scale != 1)

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
        return self._add(op.ProductOperation, sorted(factors))

    def _quotient(self, above: int | None, below: int) -> int:
        return self._add(op.QuotientOperation, (below,) if above is None else (above, below))


def _numeric(node: Node) -> tuple[Fraction, Node | None]:
    """The number among the factors of a node, and the rest; exact factors are coefficients."""
    match node:
        case ConstantNode(value) | IrrationalNode(value):
            return value, None
        case ProductNode(powers):
            numbers = [(n.value, p) for n, p in powers if isinstance(n, IrrationalNode)]
            others = [(n, p) for n, p in powers if not isinstance(n, IrrationalNode)]
            if not numbers:
                return ONE, node
            number = prod((value**power for value, power in numbers), start=ONE)
            return number, node.graph.product(others) if others else None
    return ONE, node


def _merged(parts: list[tuple[int, Count]]) -> list[tuple[int, Count]]:
    """Terms or factors without repetitions, which a `LetNode` may have concealed."""
    totals: dict[int, Count] = {}
    for number, count in parts:
        totals[number] = totals[number] + count if number in totals else count
    return [(number, count) for number, count in totals.items() if count]
