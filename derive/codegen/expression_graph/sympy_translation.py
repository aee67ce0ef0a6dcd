"""SymPy expressions as nodes of a graph; functions with kinks or jumps as choices.

All values of a choice are computed, in vectors as for numbers. Hence a function that has no value
everywhere, such as a root, gets the argument 1 where the choice discards its result. At a kink or
jump itself, derivatives are those of one side.

Elongations of springs, √E - d, become quotients without cancellation. If b² is a term of
E = b² + W, then √E - d = ((b - d)(b + d) + W)/(√E + d). For a spring of length d whose ends move
apart by u along it, b is d + u, and the numerator is u (2d + u) + W.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, reduce
from types import MappingProxyType

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
from derive.formulas.functions import CHOICES, FUNCTIONS

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


@dataclass(frozen=True)
class Elongation:
    """`scale` times √((d + u)² + W) - d."""

    scale: sp.Expr
    length: sp.Expr  # d, not negative
    change: sp.Expr  # u
    rest: sp.Expr  # W


def elongation(total: sp.Add) -> Elongation | None:
    """A sum as an elongation; None where it is none, or the sign of its length is not known."""
    for term in total.args:
        for root in sp.Mul.make_args(term):
            if root.is_Pow and root.exp == sp.S.Half and root.base.is_Add:
                scale = term / root
                length = (term - total) / scale
                # SymPy takes long to find the sign of a sum of roots with a minus
                parts = [part / scale for part in sp.Add.make_args(term - total)]
                has_minus = any(part.as_coeff_Mul()[0] < 0 for part in parts)
                if (length.is_number or not has_minus) and length.is_nonnegative:
                    return _shortest(scale, length, root.base)
    return None


def _shortest(scale: sp.Expr, length: sp.Expr, square: sp.Add) -> Elongation | None:
    """The elongation whose u has the fewest terms, so that lengths cancel where they are equal."""
    forms = [
        Elongation(scale, length, side - length, square - term)
        for term in square.args
        for side in _sides(term)
    ]
    return min(forms, key=lambda form: len(sp.Add.make_args(form.change)), default=None)


def _sides(term: sp.Expr) -> Iterator[sp.Expr]:
    """Roots b and -b of a square b² if a part of b, such as a length, has a known sign."""
    side = sp.sqrt(term) if term.is_positive else term.base if term.is_Pow else term
    is_rational = all(power.exp.is_Integer for power in side.atoms(sp.Pow))
    if is_rational and sp.expand(side**2 - term) == 0:
        known = [part for part in sp.Add.make_args(side) if part.is_positive or part.is_negative]
        if known:
            yield from (side, -side) if known[0].is_positive else (-side, side)


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
            return graph.node(fraction(expression))
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
        magnitude = self.graph.irrational(fraction(sp.Rational(abs(value))))
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


def fraction(number: sp.Rational) -> Fraction:
    """A number of SymPy's as one of Python's."""
    return Fraction(int(number.p), int(number.q))


def _unsupported(expression: sp.Expr) -> UnsupportedFunctionError:
    known = ", ".join(FUNCTIONS)
    reason = f"use finite real numbers, sums, products, powers and {known}"
    if expression.is_Function:
        reason = f"the function {expression.func} is unknown; use {known}"
    return UnsupportedFunctionError(f"no generated code for {str(expression)[:80]!r}: {reason}")
