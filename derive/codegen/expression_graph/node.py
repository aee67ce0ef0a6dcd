"""Nodes of the expression graph: one small frozen class for each kind of value."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Protocol

Number = int | Fraction
Terms = tuple[tuple["Node", Fraction], ...]
Powers = tuple[tuple["Node", int], ...]
ONE = Fraction(1)


class Arithmetic(Protocol):
    """Combines nodes to new ones: the graph that holds them."""

    def node(self, value: Operand) -> Node: ...
    def sum(self, terms: Iterable[tuple[Node, Number]]) -> Node: ...
    def product(self, factors: Iterable[tuple[Node, int]]) -> Node: ...


@dataclass(frozen=True, eq=False, slots=True)
class Node:
    """One value of a computation. Compare nodes by identity; combine them with ``+ - * /``."""

    graph: Arithmetic = field(kw_only=True, repr=False)
    rank: int = field(kw_only=True)  # order of creation: operands have a lower one

    def __add__(self, other: Operand) -> Node:
        return self.graph.sum([(self, 1), (self.graph.node(other), 1)])

    def __sub__(self, other: Operand) -> Node:
        return self.graph.sum([(self, 1), (self.graph.node(other), -1)])

    def __mul__(self, other: Operand) -> Node:
        return self.graph.product([(self, 1), (self.graph.node(other), 1)])

    def __truediv__(self, other: Operand) -> Node:
        return self.graph.product([(self, 1), (self.graph.node(other), -1)])

    def __neg__(self) -> Node:
        return self.graph.sum([(self, -1)])

    def is_number(self, value: Number) -> bool:
        """Whether this is the constant `value`."""
        return isinstance(self, ConstantNode) and self.value == value

    def scaled(self) -> tuple[Fraction, Node | None]:
        """Numeric factor and the rest: ``-2*x`` is ``(-2, x)``, ``3`` is ``(3, None)``."""
        return ONE, self

    def factors(self) -> Powers:
        """The node as a product of powers."""
        return ((self, 1),)

    def exponents(self) -> dict[Node, int]:
        """Exponents of the factors, without the numeric factor."""
        rest = self.scaled()[1]
        return {} if rest is None else dict(rest.factors())


Operand = Node | Number


@dataclass(frozen=True, eq=False, slots=True)
class LeafNode(Node):
    """An input."""

    name: str


@dataclass(frozen=True, eq=False, slots=True)
class ConstantNode(Node):
    """An exact number."""

    value: Fraction

    def scaled(self) -> tuple[Fraction, Node | None]:
        return self.value, None


@dataclass(frozen=True, eq=False, slots=True)
class IrrationalNode(Node):
    """A number such as pi, which cancels as inputs do."""

    value: Fraction  # to some 50 digits


@dataclass(frozen=True, eq=False, slots=True)
class SumNode(Node):
    """Σ coefficient · node; a single term is a multiple."""

    terms: Terms

    def scaled(self) -> tuple[Fraction, Node | None]:
        if len(self.terms) > 1:
            return ONE, self
        ((node, coefficient),) = self.terms
        return coefficient, node


@dataclass(frozen=True, eq=False, slots=True)
class ProductNode(Node):
    """Π node^exponent, with integer exponents other than 0."""

    powers: Powers

    def factors(self) -> Powers:
        return self.powers


@dataclass(frozen=True, eq=False, slots=True)
class CallNode(Node):
    """``function(*arguments)``, by the name of the function in C99.

    Beside those of C99 there is ``select(s, a, b)``: a where s > 0, b where s <= 0.
    """

    function: str
    arguments: tuple[Node, ...]


@dataclass(frozen=True, eq=False, slots=True)
class SwitchNode(Node):
    """The switching function of this index, for which its sign may stand."""

    index: int
    value: Node


@dataclass(frozen=True, eq=False, slots=True)
class LetNode(Node):
    """A named value: sums and products are not merged with it."""

    value: Node


@dataclass(frozen=True, eq=False, slots=True)
class RewrittenNode(Node):
    """The same value by two formulas: an accurate one, and a short one for its derivatives."""

    value: Node
    short: Node


@dataclass(frozen=True, eq=False, slots=True)
class FactorisedNode(Node):
    """The L D Lᵀ factorisation, by a loop, of a symmetric matrix."""

    upper: tuple[Node, ...]  # its upper triangle, row by row


@dataclass(frozen=True, eq=False, slots=True)
class SolutionNode(Node):
    """The solution x of M x = `right`, with M factorised."""

    matrix: Node
    right: tuple[Node, ...]


@dataclass(frozen=True, eq=False, slots=True)
class ComponentNode(Node):
    """One component of a solution."""

    solution: SolutionNode
    index: int


def operands(node: Node) -> tuple[Node, ...]:
    """The nodes that a node is computed from."""
    match node:
        case SumNode(pairs) | ProductNode(pairs):
            return tuple(part for part, _ in pairs)
        case CallNode(_, arguments):
            return arguments
        case LetNode(value) | SwitchNode(value=value):
            return (value,)
        case RewrittenNode(value, short):
            return (value, short)
        case FactorisedNode(upper):
            return upper
        case SolutionNode(matrix, right):
            return (matrix, *right)
        case ComponentNode(solution):
            return (solution,)
    return ()
