"""Derivatives of nodes in their own graph, in which equal subexpressions are shared."""

from collections.abc import Mapping
from types import MappingProxyType

import sympy as sp

from derive.codegen.expression_graph.graph import Graph
from derive.codegen.expression_graph.node import (
    CallNode,
    LeafNode,
    LetNode,
    Node,
    Number,
    Powers,
    ProductNode,
    RewrittenNode,
    SumNode,
    operands,
)
from derive.codegen.expression_graph.sympy_translation import Translation
from derive.formulas.functions import FUNCTIONS

#: Arguments of the functions that are differentiated.
X = sp.symbols("x y", real=True)


class Differentiation:
    """Partial derivatives of the nodes of a graph with respect to its leaves.

    A name in `directions` stands for the derivative along this combination of leaves.
    """

    def __init__(
        self,
        graph: Graph,
        directions: Mapping[str, Mapping[str, Number]] = MappingProxyType({}),
    ) -> None:
        self._graph, self._directions = graph, directions
        self._leaves: dict[Node, frozenset[str]] = {}
        self._derivatives: dict[tuple[Node, str], Node] = {}

    def leaves(self, node: Node) -> frozenset[str]:
        """Names of the leaves that `node` depends on."""
        if node not in self._leaves:
            own = {node.name} if isinstance(node, LeafNode) else set()
            self._leaves[node] = frozenset(own).union(*map(self.leaves, operands(node)))
        return self._leaves[node]

    def __call__(self, node: Node, leaf: str) -> Node:
        """∂node/∂leaf."""
        if not self._depends(node, leaf):
            return self._graph.zero
        if (node, leaf) not in self._derivatives:
            self._derivatives[node, leaf] = self._derivative(node, leaf)
        return self._derivatives[node, leaf]

    def _depends(self, node: Node, leaf: str) -> bool:
        if leaf in self._directions:
            return not self.leaves(node).isdisjoint(self._directions[leaf])
        return leaf in self.leaves(node)

    def _derivative(self, node: Node, leaf: str) -> Node:
        graph = self._graph
        match node:
            case LeafNode(name):
                return graph.node(self._directions.get(leaf, {leaf: 1})[name])
            case LetNode(value) | RewrittenNode(short=value):
                return self(value, leaf)
            case CallNode("select", (s, a, b)):
                return graph.call("select", s, self(a, leaf), self(b, leaf))
            case CallNode("pow", (base, exponent)):
                by_base = exponent * graph.call("pow", base, exponent - 1) * self(base, leaf)
                rate = self(exponent, leaf)
                if rate.is_number(0):
                    return by_base
                # where the base is 0, so is the power
                positive = graph.call("select", base, base, graph.one)
                return by_base + node * graph.call("log", positive) * rate
            case CallNode(function, arguments):
                variables = X[: len(arguments)]
                known = {x.name: value for x, value in zip(variables, arguments, strict=True)}
                translation, value = Translation(graph, known), FUNCTIONS[function](*variables)
                pairs = zip(variables, arguments, strict=True)
                return graph.sum(
                    [(translation(value.diff(x)) * self(a, leaf), 1) for x, a in pairs]
                )
            case SumNode(terms):
                return graph.sum([(self(term, leaf), number) for term, number in terms])
            case ProductNode(powers):
                changing = [(n, p) for n, p in powers if self._depends(n, leaf)]
                return graph.sum([(self._changed(powers, n, leaf), p) for n, p in changing])
            case _:
                raise NotImplementedError(f"no derivative of a {type(node).__name__} node")

    def _changed(self, powers: Powers, factor: Node, leaf: str) -> Node:
        """The product of `powers` with one `factor` replaced by its derivative."""
        return self._graph.product([*powers, (factor, -1), (self(factor, leaf), 1)])
