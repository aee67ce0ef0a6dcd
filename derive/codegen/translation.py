"""SymPy expressions as nodes of a graph."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from types import MappingProxyType

import sympy as sp

from derive.codegen.graph import Graph
from derive.codegen.node import Node

#: Functions that generated code may call, under the names of ``math`` and C99.
FUNCTIONS: dict[type[sp.Expr], str] = {
    sp.sin: "sin",
    sp.cos: "cos",
    sp.tan: "tan",
    sp.exp: "exp",
    sp.log: "log",
}


class UnsupportedFunctionError(ValueError):
    """An expression that generated code has no counterpart of; the message says what it has."""


class Translation:
    """Nodes of SymPy expressions in one graph; every symbol becomes a leaf of its name.

    Parameters
    ----------
    graph : Graph
        Where the nodes are.
    known : mapping of str to Node
        What stands in place of the leaves of these names.
    """

    def __init__(self, graph: Graph, known: Mapping[str, Node] = MappingProxyType({})) -> None:
        self.graph, self._known = graph, known
        self._nodes: dict[sp.Expr, Node] = {}

    def __call__(self, expression: sp.Expr) -> Node:
        """The node of `expression`.

        Parameters
        ----------
        expression : sympy.Expr
            Made of symbols, exact numbers and what `FUNCTIONS` has.

        Returns
        -------
        Node
            In the graph of this translation; the same one for the same expression.

        Raises
        ------
        UnsupportedFunctionError
            For a function or power that generated code has no counterpart of.
        """
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
