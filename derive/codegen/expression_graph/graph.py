"""Expressions as one shared graph: equal subexpressions are one node.

Every node is interned, so that building an expression is at the same time its
common-subexpression pass: linear in its size, and in an order that depends on
the expressions alone. Sums and products are n-ary and normalised as they are
built:

- a product is a set of (factor, integer power), so common factors cancel;
- a sum is primitive: its numeric and its monomial content stand outside;
- ``a + (b - a)`` becomes ``b``, also where the nested sum is shared;
- ``a - a*cos(x)**2`` becomes ``a*sin(x)**2``: the same number of operations,
  and no cancellation where the cosine is near one.
"""

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property, reduce
from math import gcd
from typing import Any, TypeVar

from derive.codegen.expression_graph.node import (
    ONE,
    CallNode,
    ComponentNode,
    ConstantNode,
    FactorisedNode,
    IrrationalNode,
    LeafNode,
    LetNode,
    Node,
    Number,
    Operand,
    ProductNode,
    RewrittenNode,
    SolutionNode,
    SumNode,
    SwitchNode,
    Terms,
    operands,
)

Kind = TypeVar("Kind", bound=Node)

PARTNER = {"sin": "cos", "cos": "sin"}


class Graph:
    """The interned nodes of one computation."""

    def __init__(self) -> None:
        self._nodes: dict[tuple[Any, ...], Any] = {}

    def _intern(
        self, kind: type[Kind], *content: Any, identity: Iterable[Any] | None = None
    ) -> Kind:
        key = (kind, *(content if identity is None else identity))
        if key not in self._nodes:
            self._nodes[key] = kind(*content, graph=self, rank=len(self._nodes))
        return self._nodes[key]

    def _constant(self, value: Fraction) -> ConstantNode:
        # identified by integers: to hash and compare fractions takes long
        return self._intern(ConstantNode, value, identity=(value.numerator, value.denominator))

    def _sum(self, terms: Terms) -> SumNode:
        identity = (x for node, c in terms for x in (node, c.numerator, c.denominator))
        return self._intern(SumNode, terms, identity=identity)

    @cached_property
    def zero(self) -> Node:
        """The number 0."""
        return self._constant(Fraction(0))

    @cached_property
    def one(self) -> Node:
        """The number 1."""
        return self._constant(ONE)

    def leaf(self, name: str) -> Node:
        """The input of this name."""
        return self._intern(LeafNode, name)

    def node(self, value: Operand) -> Node:
        """`value` as a node."""
        return value if isinstance(value, Node) else self._constant(Fraction(value))

    def irrational(self, value: Fraction) -> Node:
        """The irrational number that is `value` to some 50 digits."""
        return self._intern(IrrationalNode, value)

    def let(self, value: Node) -> Node:
        """`value` with its own name: sums and products are not merged with it."""
        coefficient, rest = value.scaled()
        if rest is None or isinstance(rest, LeafNode | LetNode):
            return value
        return self._scale(self._intern(LetNode, rest), coefficient)

    def rewritten(self, value: Node, short: Node) -> Node:
        """`value`, differentiated by an equal formula that is `short`."""
        return self._intern(RewrittenNode, value, short)

    def call(self, function: str, *arguments: Node) -> Node:
        """``function(*arguments)``; the sign of the argument of a sine or cosine is moved outside.

        A power whose exponent is an integer is a product, and a known choice is made.
        """
        coefficient, rest = arguments[0].scaled()
        match function, arguments:
            case (("sin" | "cos"), (argument,)) if rest is not None and coefficient < 0:
                positive = self._intern(CallNode, function, (-argument,))
                return -positive if function == "sin" else positive
            case "pow", (base, ConstantNode(exponent)) if exponent.denominator == 1:
                return self.power(base, int(exponent))
            case "select", (_, a, b) if rest is None or a is b:
                return a if coefficient > 0 else b
            case "select", (_, a, b) if rest is not None:  # its scale does not matter
                s = rest if coefficient > 0 else -rest
                match a, b:
                    case CallNode("select", (number, inner, _)), _ if number is s:
                        return self.call(function, s, inner, b)
                    case _, CallNode("select", (number, _, inner)) if number is s:
                        return self.call(function, s, a, inner)
                arguments = (s, a, b)
        return self._intern(CallNode, function, arguments)

    def switch(self, index: int, value: Node) -> Node:
        """The switching function of this index."""
        return self._intern(SwitchNode, index, value)

    def factorised(self, upper: Iterable[Node]) -> FactorisedNode:
        """The factorisation of a symmetric matrix, given by its upper triangle row by row."""
        return self._intern(FactorisedNode, tuple(upper))

    def solution(self, matrix: Node, right: Iterable[Node]) -> list[Node]:
        """The components of the solution x of M x = `right`, with M factorised."""
        solution = self._intern(SolutionNode, matrix, tuple(right))
        return [self._intern(ComponentNode, solution, i) for i in range(len(solution.right))]

    def power(self, base: Node, exponent: int) -> Node:
        """``base**exponent``."""
        return self.product([(base, exponent)])

    def product(self, factors: Iterable[tuple[Node, int]]) -> Node:
        """The product of powers; common factors are cancelled."""
        coefficient = ONE
        powers: dict[Node, int] = {}
        for factor, power in factors:
            number, rest = factor.scaled()
            if number is not ONE:  # operations with fractions take long
                scale = number if power == 1 else number**power
                coefficient = scale if coefficient is ONE else coefficient * scale
            if rest is not None:
                for node, inner in rest.factors():
                    powers[node] = powers.get(node, 0) + inner * power
        if not coefficient:
            return self.zero
        self._cancel(powers)
        for node, power in powers.items():
            match node:
                case CallNode("sqrt", (square,)) if power > 0 and power % 2 == 0:
                    rooted = {**powers, node: 0, self._constant(coefficient): 1}
                    return self.product([*rooted.items(), (square, power // 2)])
        return self._scale(self._monomial(powers), coefficient)

    def _cancel(self, powers: dict[Node, int]) -> None:
        """Replace named products of at most two factors by these where one is cancelled."""
        for node in [one for one in powers if isinstance(one, LetNode)]:
            count = powers[node]
            parts = [
                (part.value if isinstance(part, LetNode) and part.value in powers else part, power)
                for part, power in node.value.factors()
            ]
            is_cancelled = (powers.get(part, 0) * power * count < 0 for part, power in parts)
            if len(parts) <= 2 and any(is_cancelled):
                del powers[node]
                for part, power in parts:
                    powers[part] = powers.get(part, 0) + power * count

    def _monomial(self, powers: Mapping[Node, int]) -> Node:
        nonzero = sorted(((n, p) for n, p in powers.items() if p), key=lambda item: item[0].rank)
        if not nonzero:
            return self.one
        if len(nonzero) == 1 and nonzero[0][1] == 1:
            return nonzero[0][0]
        return self._intern(ProductNode, tuple(nonzero))

    def _scale(self, node: Node, coefficient: Fraction) -> Node:
        if isinstance(node, ConstantNode):
            return self.node(node.value * coefficient)
        if coefficient is ONE or coefficient == 1:
            return node
        return self._sum(((node, coefficient),))

    def sum(self, terms: Iterable[tuple[Node, Number]]) -> Node:
        """The sum of coefficient times node; its content is moved outside."""
        collected: dict[Node, Fraction] = {}
        one = self.one
        for node, number in terms:
            coefficient, rest = node.scaled()
            key = one if rest is None else rest
            if number != 1:
                coefficient = Fraction(number) if coefficient is ONE else coefficient * number
            collected[key] = collected[key] + coefficient if key in collected else coefficient
        nonzero = {node: c for node, c in collected.items() if c}
        if len(nonzero) > 1:
            simplified = self._pythagoras(self._without_opposites(nonzero))
            nonzero = {node: c for node, c in simplified.items() if c}
        if not nonzero:
            return self.zero
        if len(nonzero) == 1:
            ((node, coefficient),) = nonzero.items()
            return self._scale(node, coefficient)
        return self._primitive(nonzero)

    def common_factor(self, entries: Iterable[Node]) -> Node:
        """The product of powers that divides all entries other than 0."""
        powers = [entry.exponents() for entry in entries if not entry.is_number(0)]
        return self.product((f, p) for f, p in _common_powers(powers).items() if p > 0)

    def spread(self, node: Node, number: Fraction) -> Node:
        """`number` times `node`, multiplied into every term of a sum."""
        coefficient, rest = node.scaled()
        if not isinstance(rest, SumNode):
            return self.sum([(node, number)])
        return self.sum([(term, c * coefficient * number) for term, c in rest.terms])

    def _primitive(self, terms: Mapping[Node, Fraction]) -> Node:
        ordered = sorted(terms.items(), key=lambda item: item[0].rank)
        one = self.one
        monomials = [{} if n is one else dict(n.factors()) for n, _ in ordered]
        common = _common_powers(monomials)
        if common:
            divided = {
                self._monomial({n: p - common.get(n, 0) for n, p in monomial.items()}): coefficient
                for (_, coefficient), monomial in zip(ordered, monomials, strict=True)
            }
            fewer = self._without_opposites(divided)
            if fewer is not divided:
                return self.product([*common.items(), (self.sum(fewer.items()), 1)])
            ordered = [*divided.items()]
        # ½a + ½b is ½(a + b), but ½a + b stays: (a + 2b)/2 would multiply twice
        content = Fraction(
            reduce(gcd, (c.numerator for _, c in ordered)),
            reduce(gcd, (c.denominator for _, c in ordered)),
        )
        # of s and -s, the one with more plus signs is the node
        negative = sum(c.numerator < 0 for _, c in ordered)
        if 2 * negative > len(ordered) or (2 * negative == len(ordered) and ordered[0][1] < 0):
            content = -content
        rest = [(node, c if content == 1 else c / content) for node, c in ordered]
        rest.sort(key=lambda item: item[0].rank)
        primitive = self._sum(tuple(rest))
        # the remaining sum may be one of the common factors
        powers = {**common, primitive: common.get(primitive, 0) + 1}
        return self._scale(self._monomial(powers), content)

    def _without_opposites(self, terms: dict[Node, Fraction]) -> dict[Node, Fraction]:
        """`terms` with a nested sum expanded that contains the opposite of one of them."""
        for node, coefficient in terms.items():
            if isinstance(node, SumNode) and any(
                terms.get(inner) == -c * coefficient for inner, c in node.terms
            ):
                return _expansion(terms, node)
        return terms

    def _pythagoras(self, terms: dict[Node, Fraction]) -> dict[Node, Fraction]:
        """Replace ``a - a*cos(x)**2`` by ``a*sin(x)**2``, and their sum by ``a``.

        The same with sine and cosine exchanged.
        """
        for node, coefficient in terms.items():
            for factor, power in node.factors():
                if power != 2 or not isinstance(factor, CallNode) or factor.function not in PARTNER:
                    continue
                rest = self.product([(node, 1), (factor, -2)])
                partner = self._intern(CallNode, PARTNER[factor.function], factor.arguments)
                replaced = self.product([(rest, 1), (partner, 2)])
                if terms.get(replaced) == coefficient:
                    others = {n: c for n, c in terms.items() if n not in (node, replaced)}
                    return others | {rest: others.get(rest, Fraction(0)) + coefficient}
                expanded = self._expanded(terms, rest)
                if expanded is not None and expanded.get(rest) == -coefficient:
                    expanded = {n: c for n, c in expanded.items() if n not in (rest, node)}
                    expanded[replaced] = expanded.get(replaced, Fraction(0)) - coefficient
                    return expanded
        return terms

    def _expanded(self, terms: dict[Node, Fraction], term: Node) -> dict[Node, Fraction] | None:
        """`terms` with the nested sum expanded that contains `term`; None if there is none."""
        if term in terms:
            return dict(terms)
        nested = (n for n in terms if isinstance(n, SumNode) and term in operands(n))
        return next((_expansion(terms, node) for node in nested), None)


def _common_powers(monomials: Sequence[Mapping[Node, int]]) -> dict[Node, int]:
    """The factors that all of these products have, or that divide all of them."""
    return {
        node: min(m[node] for m in monomials)
        for node in monomials[0]
        if all(m.get(node, 0) > 0 for m in monomials) or all(m.get(node, 0) < 0 for m in monomials)
    }


def _expansion(terms: Mapping[Node, Fraction], nested: SumNode) -> dict[Node, Fraction]:
    """`terms` with one of them, a nested sum, replaced by its own terms."""
    expanded = {node: c for node, c in terms.items() if node is not nested}
    for inner, c in nested.terms:
        expanded[inner] = expanded.get(inner, Fraction(0)) + c * terms[nested]
    return expanded
