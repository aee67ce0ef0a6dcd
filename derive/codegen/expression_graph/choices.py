"""Functions with kinks or jumps as choices between two values, by the sign of a number.

All values of a choice are computed, in vectors as for numbers. Hence a function that has no value
everywhere, such as a root, gets the argument 1 where the choice discards its result. At a kink or
jump itself, derivatives are those of one side.
"""

from collections.abc import Callable, Sequence
from functools import cache, reduce

import sympy as sp
from sympy.logic.boolalg import Boolean

from derive.codegen.expression_graph.graph import Graph
from derive.codegen.expression_graph.node import (
    CallNode,
    LetNode,
    Node,
    ProductNode,
    RewrittenNode,
    SumNode,
)

#: Functions of generated code that some numbers have no value of, or none that is finite.
PARTIAL = ("exp", "log", "sqrt", "sinh", "cosh", "pow")

Choice = Callable[[Node, Node], Node]


class Choices:
    """Nodes of functions in `CHOICES`; `translate` gives those of their parts.

    A choice by the sign of one of the `switching` functions refers to it by its index.
    """

    def __init__(
        self,
        graph: Graph,
        translate: Callable[[sp.Expr], Node],
        switching: Sequence[sp.Expr] = (),
    ) -> None:
        self._graph, self._translate = graph, translate
        self._switching, self._switches = switching, dict[Node, Node]()

    def __call__(self, expression: sp.Expr) -> Node:
        """The node of a function in `CHOICES`."""
        graph, select = self._graph, self._select
        self._find_switches()
        if isinstance(expression, sp.DiracDelta):
            return graph.zero
        if isinstance(expression, sp.Piecewise):
            return self._pieces(expression.args)
        first, *rest = map(self._translate, expression.args)
        zero, one = graph.zero, graph.one
        if isinstance(expression, sp.Abs):
            return select(first, first, -first)
        if isinstance(expression, sp.sign):
            return select(first, one, select(-first, -one, zero))
        if isinstance(expression, sp.Heaviside):
            return select(first, one, zero)
        if isinstance(expression, sp.Max):
            return reduce(lambda a, b: select(b - a, b, a), rest, first)
        return reduce(lambda a, b: select(b - a, a, b), rest, first)

    def _find_switches(self) -> None:
        """Find the nodes of switching functions, once."""
        switching, self._switching = self._switching, ()
        for index, expression in enumerate(switching):
            value = self._translate(expression)  # which may contain those before it
            coefficient, rest = value.scaled()
            if rest is not None:
                switch = self._graph.switch(index, value)
                self._switches[rest] = switch if coefficient > 0 else -switch

    def _select(self, number: Node, positive: Node, other: Node) -> Node:
        coefficient, rest = number.scaled()
        if rest is not None and rest in self._switches:
            number = self._graph.sum([(self._switches[rest], 1 if coefficient > 0 else -1)])
        return self._graph.call("select", number, positive, other)

    def _pieces(self, pieces: Sequence[tuple[sp.Expr, Boolean]]) -> Node:
        (value, condition), *rest = pieces
        if not rest:  # its condition holds where no other does
            return self._translate(value)
        choice, one = self._choice(condition), self._graph.one
        yes, no = self._translate(value), self._pieces(rest)
        return choice(
            self._guarded(yes, lambda node: choice(node, one)),
            self._guarded(no, lambda node: choice(one, node)),
        )

    def _choice(self, condition: Boolean) -> Choice:
        """The choice between two values, of which the first is that where the condition holds."""
        match condition:
            case sp.true:
                return lambda yes, no: yes
            case sp.false:
                return lambda yes, no: no
            case sp.Not(args=(inner,)):
                choice = self._choice(inner)
                return lambda yes, no: choice(no, yes)
            case sp.And(args=parts):
                choices = [*map(self._choice, parts)]
                return lambda yes, no: reduce(lambda value, each: each(value, no), choices, yes)
            case sp.Or(args=parts):
                choices = [*map(self._choice, parts)]
                return lambda yes, no: reduce(lambda value, each: each(yes, value), choices, no)
        difference = self._translate(condition.lhs) - self._translate(condition.rhs)
        match condition:
            case sp.StrictGreaterThan():
                return lambda yes, no: self._select(difference, yes, no)
            case sp.StrictLessThan():
                return lambda yes, no: self._select(-difference, yes, no)
            case sp.LessThan():
                return lambda yes, no: self._select(difference, no, yes)
            case sp.GreaterThan():
                return lambda yes, no: self._select(-difference, no, yes)
            case sp.Eq():
                return lambda yes, no: self._equal(difference, yes, no)
            case _:
                return lambda yes, no: self._equal(difference, no, yes)

    def _equal(self, difference: Node, yes: Node, no: Node) -> Node:
        return self._select(difference, no, self._select(-difference, no, yes))

    def _guarded(self, value: Node, guard: Callable[[Node], Node]) -> Node:
        """`value`, with `guard` applied to divisors and arguments of partial functions."""
        graph = self._graph

        @cache
        def guarded(node: Node) -> Node:
            match node:
                case CallNode(function, arguments):
                    parts = [*map(guarded, arguments)]
                    if function in PARTIAL:
                        parts = [*map(guard, parts)]
                    return graph.call(function, *parts)
                case ProductNode(powers):
                    pairs = [(guarded(factor), power) for factor, power in powers]
                    return graph.product([(guard(f) if p < 0 else f, p) for f, p in pairs])
                case SumNode(terms):
                    return graph.sum([(guarded(term), number) for term, number in terms])
                case LetNode(inner):
                    return graph.let(guarded(inner))
                case RewrittenNode(long, short):
                    return graph.rewritten(guarded(long), guarded(short))
            return node

        return guarded(value)
