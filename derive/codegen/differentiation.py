"""Derivatives of nodes, in their own graph: what is equal is shared as soon as it is made."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from derive.codegen.graph import Graph, Node

#: Derivatives of functions by their argument, of the call's node and its argument.
OUTER: dict[str, Callable[[Node, Node], Node]] = {
    "sin": lambda call, x: call.graph.call("cos", x),
    "cos": lambda call, x: -call.graph.call("sin", x),
    "tan": lambda call, x: call.graph.node(1) + call * call,
    "exp": lambda call, x: call,
    "log": lambda call, x: call.graph.power(x, -1),
    "sqrt": lambda call, x: call.graph.node(Fraction(1, 2)) / call,
}


class Differentiation:
    """Partial derivatives of the nodes of one graph by its leaves."""

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._leaves: dict[Node, frozenset[str]] = {}
        self._derivatives: dict[tuple[Node, str], Node] = {}

    def leaves(self, node: Node) -> frozenset[str]:
        """Names of all that `node` depends on."""
        if node not in self._leaves:
            own = {node.content} if node.kind == "leaf" else set()
            self._leaves[node] = frozenset(own).union(*map(self.leaves, node.operands()))
        return self._leaves[node]

    def __call__(self, node: Node, leaf: str) -> Node:
        """∂node/∂leaf."""
        if leaf not in self.leaves(node):
            return self._graph.node(0)
        if (node, leaf) not in self._derivatives:
            self._derivatives[node, leaf] = self._derivative(node, leaf)
        return self._derivatives[node, leaf]

    def _derivative(self, node: Node, leaf: str) -> Node:
        graph = self._graph
        match node.kind:
            case "leaf":
                return graph.node(1)
            case "let":
                return self(node.content, leaf)
            case "call":
                function, argument = node.content
                return OUTER[function](node, argument) * self(argument, leaf)
            case "sum":
                return graph.sum([(self(term, leaf), number) for term, number in node.content])
            case "product":
                return graph.sum([
                    (graph.product([*node.content, (factor, -1), (self(factor, leaf), 1)]), power)
                    for factor, power in node.content
                ])  # fmt: skip
            case kind:
                raise NotImplementedError(f"no derivative of a node of kind {kind}")
