"""Expressions as one shared graph: equal subexpressions are one node.

Every node is interned, so that building an expression is at the same time its
common-subexpression pass: linear in its size, and in an order that depends on
the expressions alone. Sums and products are n-ary and normalised as they are
built:

- a product is a set of (factor, integer power), so common factors cancel;
- a sum is primitive: its numeric and its monomial content stand outside;
- ``a - a*cos(x)**2`` becomes ``a*sin(x)**2``: the same number of operations,
  and no cancellation where the cosine is near one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import reduce
from math import gcd
from typing import Any

Number = int | Fraction
Factors = tuple[tuple["Node", int], ...]

PARTNER = {"sin": "cos", "cos": "sin"}


class Node:
    """One value of a computation. Compare nodes by identity; combine them with ``+ - * /``.

    Attributes
    ----------
    kind : {"leaf", "number", "sum", "product", "call", "let", "factors", "solved", "component"}
    content : the name, the number, the terms, the factors, (function, argument); entries of a
        matrix, (factors, right side), or (solved, index)
    rank : order of creation; operands have a lower rank than what uses them
    """

    __slots__ = ("content", "graph", "kind", "rank")

    def __init__(self, graph: Graph, kind: str, content: Any, rank: int) -> None:
        self.graph, self.kind, self.content, self.rank = graph, kind, content, rank

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
        """Tell whether this is the constant `value`."""
        return self.kind == "number" and self.content == value

    def scaled(self) -> tuple[Fraction, Node | None]:
        """Split off the numeric factor: ``-2*x`` is ``(-2, x)``, ``3`` is ``(3, None)``."""
        if self.kind == "number":
            return self.content, None
        if self.kind == "sum" and len(self.content) == 1:
            term, coefficient = self.content[0]
            return coefficient, term
        return Fraction(1), self

    def factors(self) -> Factors:
        """The node as a product of powers."""
        return self.content if self.kind == "product" else ((self, 1),)

    def powers(self) -> dict[Node, int]:
        """Powers of its factors, the number left out."""
        rest = self.scaled()[1]
        return {} if rest is None else dict(rest.factors())

    def operands(self) -> tuple[Node, ...]:
        """The nodes that this one is computed from."""
        if self.kind in ("sum", "product"):
            return tuple(node for node, _ in self.content)
        match self.kind:
            case "call":
                return (self.content[1],)
            case "let":
                return (self.content,)
            case "factors":
                return self.content
            case "solved":
                return (self.content[0], *self.content[1])
            case "component":
                return (self.content[0],)
            case _:
                return ()


Operand = Node | int | Fraction


class Graph:
    """The interned nodes of one computation."""

    def __init__(self) -> None:
        self._nodes: dict[tuple[str, Any], Node] = {}

    def _intern(self, kind: str, content: Any) -> Node:
        key = (kind, content)
        if key not in self._nodes:
            self._nodes[key] = Node(self, kind, content, len(self._nodes))
        return self._nodes[key]

    def leaf(self, name: str) -> Node:
        """An input, by name."""
        return self._intern("leaf", name)

    def node(self, value: Operand) -> Node:
        """A node as it is, a number as a node."""
        return value if isinstance(value, Node) else self._intern("number", Fraction(value))

    def let(self, value: Node) -> Node:
        """`value` under a name of its own: products and sums do not look inside."""
        coefficient, rest = value.scaled()
        if rest is None or rest.kind in ("leaf", "let"):
            return value
        return self._scale(self._intern("let", rest), coefficient)

    def call(self, function: str, argument: Node) -> Node:
        """``function(argument)``, an odd or even function's sign taken outside."""
        coefficient, rest = argument.scaled()
        if function in PARTNER and rest is not None and coefficient < 0:
            positive = self._intern("call", (function, -argument))
            return -positive if function == "sin" else positive
        return self._intern("call", (function, argument))

    def factors(self, upper: Iterable[Node]) -> Node:
        """A symmetric matrix taken apart by a loop: its upper triangle, row by row."""
        return self._intern("factors", tuple(upper))

    def solution(self, factors: Node, right: Iterable[Node]) -> list[Node]:
        """What the matrix of `factors` takes to the right side."""
        solved = self._intern("solved", (factors, tuple(right)))
        return [self._intern("component", (solved, i)) for i in range(len(solved.content[1]))]

    def power(self, base: Node, exponent: int) -> Node:
        """``base**exponent``."""
        return self.product([(base, exponent)])

    def product(self, factors: Iterable[tuple[Node, int]]) -> Node:
        """The product of powers, common factors cancelled."""
        coefficient = Fraction(1)
        powers: dict[Node, int] = {}
        for factor, power in factors:
            number, rest = factor.scaled()
            coefficient *= number**power
            if rest is not None:
                for node, inner in rest.factors():
                    powers[node] = powers.get(node, 0) + inner * power
        if coefficient == 0:
            return self.node(0)
        return self._scale(self._monomial(powers), coefficient)

    def _monomial(self, powers: Mapping[Node, int]) -> Node:
        kept = sorted(((n, p) for n, p in powers.items() if p), key=lambda item: item[0].rank)
        if not kept:
            return self.node(1)
        if len(kept) == 1 and kept[0][1] == 1:
            return kept[0][0]
        return self._intern("product", tuple(kept))

    def _scale(self, node: Node, coefficient: Fraction) -> Node:
        if node.kind == "number":
            return self.node(node.content * coefficient)
        if coefficient == 1:
            return node
        return self._intern("sum", ((node, coefficient),))

    def sum(self, terms: Iterable[tuple[Node, Number]]) -> Node:
        """The sum of coefficient times node, its content taken outside."""
        collected: dict[Node, Fraction] = {}
        one = self.node(1)
        for node, number in terms:
            coefficient, rest = node.scaled()
            key = one if rest is None else rest
            collected[key] = collected.get(key, Fraction(0)) + coefficient * number
        kept = {node: c for node, c in collected.items() if c}
        if len(kept) > 1:
            kept = self._pythagoras(kept)
        if not kept:
            return self.node(0)
        if len(kept) == 1:
            ((node, coefficient),) = kept.items()
            return self._scale(node, coefficient)
        return self._primitive(kept)

    def spread(self, node: Node, number: Fraction) -> Node:
        """`number` times `node`, multiplied into every term of a sum."""
        coefficient, rest = node.scaled()
        if rest is None or rest.kind != "sum":
            return self.sum([(node, number)])
        return self.sum([(term, c * coefficient * number) for term, c in rest.content])

    def _primitive(self, terms: Mapping[Node, Fraction]) -> Node:
        ordered = sorted(terms.items(), key=lambda item: item[0].rank)
        one = self.node(1)
        monomials = [{} if n is one else dict(n.factors()) for n, _ in ordered]
        common = {
            n: min(m.get(n, 0) for m in monomials)
            for n in monomials[0]
            if all(m.get(n, 0) > 0 for m in monomials) or all(m.get(n, 0) < 0 for m in monomials)
        }
        # ½a + ½b is ½(a + b), but ½a + b stays: (a + 2b)/2 would multiply twice
        content = Fraction(
            reduce(gcd, (c.numerator for _, c in ordered)),
            reduce(gcd, (c.denominator for _, c in ordered)),
        )
        # of s and -s the one with more plus signs is the node
        negative = sum(c < 0 for _, c in ordered)
        if 2 * negative > len(ordered) or (2 * negative == len(ordered) and ordered[0][1] < 0):
            content = -content
        rest = []
        for (node, coefficient), monomial in zip(ordered, monomials, strict=True):
            if common:
                quotient = dict(monomial)
                for n, p in common.items():
                    quotient[n] = quotient.get(n, 0) - p
                node = self._monomial(quotient)
            rest.append((node, coefficient / content))
        rest.sort(key=lambda item: item[0].rank)
        primitive = self._intern("sum", tuple(rest))
        # the sum that is left may be one of the common factors
        powers = {**common, primitive: common.get(primitive, 0) + 1}
        return self._scale(self._monomial(powers), content)

    def _pythagoras(self, terms: dict[Node, Fraction]) -> dict[Node, Fraction]:
        """Replace ``a - a*cos(x)**2`` by ``a*sin(x)**2``, and with sine and cosine exchanged."""
        for node, coefficient in terms.items():
            for factor, power in node.factors():
                if factor.kind != "call" or factor.content[0] not in PARTNER or power != 2:
                    continue
                function, argument = factor.content
                rest = self.product([(node, 1), (factor, -2)])
                opened = self._opened(terms, rest)
                if opened is not None and opened.get(rest) == -coefficient:
                    partner = self._intern("call", (PARTNER[function], argument))
                    turned = self.product([(rest, 1), (partner, 2)])
                    opened = {n: c for n, c in opened.items() if n not in (rest, node)}
                    opened[turned] = opened.get(turned, Fraction(0)) - coefficient
                    return opened
        return terms

    def _opened(self, terms: dict[Node, Fraction], wanted: Node) -> dict[Node, Fraction] | None:
        """`terms` with the one nested sum expanded that holds `wanted`, if any does."""
        if wanted in terms:
            return dict(terms)
        for node, coefficient in terms.items():
            if node.kind == "sum" and wanted in dict(node.content):
                opened = {n: c for n, c in terms.items() if n is not node}
                for inner, c in node.content:
                    opened[inner] = opened.get(inner, Fraction(0)) + c * coefficient
                return opened
        return None
