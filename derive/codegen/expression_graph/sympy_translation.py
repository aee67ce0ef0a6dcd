"""SymPy expressions as nodes of a graph."""

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from types import MappingProxyType

import sympy as sp

from derive.codegen.expression_graph.choices import Choices
from derive.codegen.expression_graph.elongation import Elongation, elongation
from derive.codegen.expression_graph.graph import Graph
from derive.codegen.expression_graph.node import Node
from derive.formulas.function_table import FUNCTIONS
from derive.formulas.switching_functions import CHOICES

#: Digits of irrational numbers, more than any number type has.
DIGITS = 50

NAMES = {function: name for name, function in FUNCTIONS.items()}


class UnsupportedFunctionError(ValueError):
    """An expression without a counterpart in generated code; the message lists the known ones."""


class Translation:
    """Nodes of SymPy expressions; a symbol becomes the `known` node of its name, or a leaf.

    Choices by the signs of `switching` functions refer to these by their indices.
    """

    def __init__(
        self,
        graph: Graph,
        known: Mapping[str, Node] = MappingProxyType({}),
        switching: Sequence[sp.Expr] = (),
    ) -> None:
        self.graph, self._known = graph, known
        self._nodes: dict[sp.Expr, Node] = {}
        self._choice = Choices(graph, self, switching)

    def __call__(self, expression: sp.Expr) -> Node:
        """The node of an expression of symbols, real numbers and `FUNCTIONS`."""
        if expression not in self._nodes:
            self._nodes[expression] = self._translated(expression)
        return self._nodes[expression]

    def _translated(self, expression: sp.Expr) -> Node:
        graph = self.graph
        if expression.is_Symbol:
            return self._known.get(expression.name) or graph.leaf(expression.name)
        if expression.is_Rational:
            return graph.node(_fraction(expression))
        if expression.is_Add and not expression.is_number:
            spring = elongation(expression)
            if spring is not None:
                return self._elongation(spring)
            return graph.sum([(self(term), 1) for term in expression.args])
        if expression.is_Mul:
            return graph.product([(self(factor), 1) for factor in _factors(expression)])
        if expression.is_Pow and expression.exp.is_Integer:
            return graph.power(self(expression.base), int(expression.exp))
        if expression.is_number:
            return self._number(expression)
        if isinstance(expression, CHOICES):
            return self._choice(expression)
        if type(expression) in NAMES:
            return graph.call(NAMES[type(expression)], *map(self, expression.args))
        if expression.is_Pow:
            return self._power(expression)
        raise _unsupported(expression)

    def _number(self, expression: sp.Expr) -> Node:
        """A real number such as pi or sqrt(2)."""
        value = expression.evalf(DIGITS)
        if not (value.is_Float and value.is_finite):
            raise _unsupported(expression)
        magnitude = self.graph.irrational(_fraction(sp.Rational(abs(value))))
        return magnitude if value > 0 else -magnitude

    def _elongation(self, spring: Elongation) -> Node:
        graph = self.graph
        length, change, rest = map(self, (spring.length, spring.change, spring.rest))
        side = graph.sum([(length, 1), (change, 1)])
        root = graph.call("sqrt", graph.sum([(graph.power(side, 2), 1), (rest, 1)]))
        squares = graph.sum([(change * graph.sum([(change, 1), (length, 2)]), 1), (rest, 1)])
        value = graph.rewritten(squares / (root + length), root - length)
        return value * self(spring.scale)

    def _power(self, expression: sp.Pow) -> Node:
        """A power; by square roots if its exponent is a fraction with denominator 2, 4, 8, etc."""
        base, exponent = self(expression.base), expression.exp
        if not exponent.is_Rational or exponent.q & (exponent.q - 1):
            return self.graph.call("pow", base, self(exponent))
        while exponent.q % 2 == 0:
            base, exponent = self.graph.call("sqrt", base), 2 * exponent
        return self.graph.power(base, int(exponent))


def _factors(product: sp.Mul) -> Iterable[sp.Expr]:
    """The factors of a product; powers of one base, such as x**p/x, are one power."""
    if all(factor.exp.is_Rational for factor in product.args if factor.is_Pow):
        return product.args
    exponents: dict[sp.Expr, sp.Expr] = {}
    for factor in product.args:
        base, exponent = (factor.base, factor.exp) if factor.is_Pow else (factor, sp.S.One)
        exponents[base] = exponents.get(base, sp.S.Zero) + exponent
    return [base**exponent for base, exponent in exponents.items()]


def _fraction(number: sp.Rational) -> Fraction:
    return Fraction(int(number.p), int(number.q))


def _unsupported(expression: sp.Expr) -> UnsupportedFunctionError:
    known = ", ".join(FUNCTIONS)
    reason = f"use finite real numbers, sums, products, powers and {known}"
    if expression.is_Function:
        reason = f"the function {expression.func} is unknown; use {known}"
    return UnsupportedFunctionError(f"no generated code for {str(expression)[:80]!r}: {reason}")
