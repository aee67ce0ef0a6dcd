"""SymPy expressions as nodes of a graph."""

from collections.abc import Mapping
from fractions import Fraction
from types import MappingProxyType

import sympy as sp

from derive.codegen.graph import Graph
from derive.codegen.node import Node

#: Functions that generated code can call, by their names in ``math`` and C99.
FUNCTIONS = {sp.sin: "sin", sp.cos: "cos", sp.tan: "tan", sp.exp: "exp", sp.log: "log"}


class UnsupportedFunctionError(ValueError):
    """An expression without a counterpart in generated code; the message lists the known ones."""


class Translation:
    """Nodes of SymPy expressions; a symbol becomes the `known` node of its name, or a leaf."""

    def __init__(self, graph: Graph, known: Mapping[str, Node] = MappingProxyType({})) -> None:
        self.graph, self._known = graph, known
        self._nodes: dict[sp.Expr, Node] = {}

    def __call__(self, expression: sp.Expr) -> Node:
        """The node of an expression of symbols, exact numbers and `FUNCTIONS`."""
        if expression not in self._nodes:
            self._nodes[expression] = self._translated(expression)
        return self._nodes[expression]

    def _translated(self, expression: sp.Expr) -> Node:
        graph = self.graph
        if expression.is_Symbol:
            return self._known.get(expression.name) or graph.leaf(expression.name)
        if expression.is_Rational:
            return graph.node(Fraction(int(expression.p), int(expression.q)))
        if expression.is_Add:
            return graph.sum([(self(term), 1) for term in expression.args])
        if expression.is_Mul:
            return graph.product([(self(factor), 1) for factor in expression.args])
        if type(expression) in FUNCTIONS:
            return graph.call(FUNCTIONS[type(expression)], self(expression.args[0]))
        if expression.is_Pow:
            base, exponent = expression.as_base_exp()
            if exponent.is_Integer:
                return graph.power(self(base), int(exponent))
            if (2 * exponent).is_Integer:
                return graph.power(graph.call("sqrt", self(base)), int(2 * exponent))
        raise UnsupportedFunctionError(
            f"no generated code for {str(expression)[:80]!r}: use sums, products, integer and "
            f"half powers, and {', '.join(FUNCTIONS.values())}"
        )
