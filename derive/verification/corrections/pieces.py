"""Pieces of a formula as written, each with the values that would make the formula right.

If the whole must have the value X, then the factor a of a*b must be X/b, the term a of a + b
must be X - b, and so on, down to the smallest piece.
"""

import ast
import math
import operator
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from derive.formulas.expression import Namespace, parse
from derive.formulas.syntax import is_sum, place, summands, syntax_tree
from derive.verification.corrections.state_samples import (
    FUNCTIONS,
    Numbers,
    StateSamples,
    applied,
    power,
    quotient,
)

OPERATIONS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: quotient,
    ast.Pow: power,
}


@dataclass(frozen=True, eq=False)
class FormulaPart:
    """A part of a formula, with its values and the required ones."""

    node: ast.expr
    source: str  # without the sign before it
    span: tuple[int, int]  # in the formula
    start: int  # the same, with the minus sign before it and the brackets after that
    end: int
    value: Numbers
    required: Numbers
    states: Sequence[int]  # at which the required values are reliable
    sign: int = 1  # -1 where a minus sign precedes it in a sum
    parent: "FormulaPart | None" = None  # the smallest larger term
    # a reader sees it as a unit: a term of a sum, a denominator, a factor beside a bracket
    is_term: bool = True
    is_summand: bool = False
    is_squared: bool = False  # the sign of the required values is not known


class Pieces:
    """The pieces of one side of a formula, which begins at `offset` in the text."""

    def __init__(self, text: str, offset: int, namespace: Namespace, samples: StateSamples) -> None:
        self._text, self._offset, self._namespace, self._samples = text, offset, namespace, samples
        self._values: dict[ast.expr, Numbers] = {}
        self.tree = syntax_tree(text)
        self.value = self._value(self.tree)

    def walk(self, required: Numbers, states: Sequence[int]) -> Iterator[FormulaPart]:
        """Yield all pieces, the whole first, with the values required of them."""
        end = self._offset + len(self._text.rstrip())
        start = self._offset + len(self._text) - len(self._text.lstrip())
        whole = FormulaPart(
            self.tree, self._text.strip(), (start, end), start, end, self.value, required, states
        )
        yield from self._walk(whole)

    def _walk(self, piece: FormulaPart) -> Iterator[FormulaPart]:
        yield piece
        for part in self._parts(piece):
            yield from self._walk(part)

    def _value(self, node: ast.expr) -> Numbers:
        if node not in self._values:
            self._values[node] = self._computed(node)
        return self._values[node]

    def _computed(self, node: ast.expr) -> Numbers:
        match node:
            case ast.Constant(value=int() | float() as number):
                return [float(number)] * self._samples.count
            case ast.Name(id=name):
                return self._samples(self._namespace[name])
            case ast.UnaryOp(operand=operand):
                return [-x for x in self._value(operand)]
            case ast.Call(func=ast.Name(id=name), args=arguments) if name in FUNCTIONS:
                return applied(name, *map(self._value, arguments))
            case ast.BinOp(left=left, op=symbol, right=right):
                return [*map(OPERATIONS[type(symbol)], self._value(left), self._value(right))]
            case ast.Call():  # an operator such as a derivative
                return self._samples(
                    parse(self._text[slice(*place(self._text, node))], self._namespace)
                )
        raise NotImplementedError(ast.unparse(node))

    def _parts(self, whole: FormulaPart) -> Iterator[FormulaPart]:
        required = whole.required
        if is_sum(whole.node):
            yield from self._summands(whole)
            return
        match whole.node:
            case ast.UnaryOp(operand=operand):
                yield self._factor(whole, operand, [-x for x in required])
            case ast.BinOp(left=left, op=ast.Mult(), right=right):
                ratio = [*map(quotient, required, self._value(right))]
                yield self._factor(whole, left, ratio, right)
                ratio = [*map(quotient, required, self._value(left))]
                yield self._factor(whole, right, ratio, left)
            case ast.BinOp(left=left, op=ast.Div(), right=right):
                product = [*map(operator.mul, required, self._value(right))]
                yield self._factor(whole, left, product, right)
                ratio = [*map(quotient, self._value(left), required)]
                yield self._factor(whole, right, ratio, left)
            case ast.BinOp(left=base, op=ast.Pow(), right=ast.Constant(value=int(n))) if n:
                roots = [power(abs(x), 1 / n) for x in required]
                signs = required if n % 2 else self._value(base)
                roots = [*map(math.copysign, roots, signs)]
                yield self._part(whole, base, roots, is_term=is_sum(base), is_squared=n % 2 == 0)
            case ast.Call(func=ast.Name(id="sqrt"), args=[argument]):
                squares = [x * x if x > 0 else math.nan for x in required]
                yield self._part(whole, argument, squares, is_term=True)
            case ast.Call(func=ast.Name(id="exp"), args=[argument]):
                logarithms = [math.log(x) if x > 0 else math.nan for x in required]
                yield self._part(whole, argument, logarithms, is_term=True)

    def _factor(
        self, whole: FormulaPart, node: ast.expr, required: Numbers, other: ast.expr | None = None
    ) -> FormulaPart:
        # a factor beside a bracket is seen, one of several names in a row is not
        beside = other is not None and has_bracket(other)
        seen = beside or is_sum(node)
        return self._part(whole, node, required, is_term=seen, is_squared=whole.is_squared)

    def _summands(self, whole: FormulaPart) -> Iterator[FormulaPart]:
        total = self._value(whole.node)
        for node, sign in summands(whole.node):
            value, states = self._value(node), whole.states
            if whole.is_squared:
                # the root keeps its sign where the term is small beside the others
                others = [t - sign * v for t, v in zip(total, value, strict=True)]
                states = _smallest([*map(quotient, value, others)], len(states))
            changes = map(operator.sub, whole.required, total)
            required = [v + sign * change for v, change in zip(value, changes, strict=True)]
            yield self._part(
                whole, node, required, states=states, sign=sign, is_term=True, is_summand=True
            )

    def _part(
        self,
        whole: FormulaPart,
        node: ast.expr,
        required: Numbers,
        *,
        states: Sequence[int] = (),
        sign: int = 1,
        is_term: bool = False,
        is_summand: bool = False,
        is_squared: bool = False,
    ) -> FormulaPart:
        start, end = place(self._text, node)
        source, span = self._text[start:end], (start + self._offset, end + self._offset)
        if sign < 0:
            bracketed, start = start, self._text.rindex("-", 0, start)
            for _ in range(self._text.count("(", start, bracketed)):
                end = self._text.index(")", end) + 1
        return FormulaPart(
            node,
            source,
            span,
            start + self._offset,
            end + self._offset,
            self._value(node),
            required,
            states or whole.states,
            sign,
            whole if whole.is_term else whole.parent,
            is_term,
            is_summand,
            is_squared,
        )


def has_bracket(node: ast.expr) -> bool:
    """Whether a product contains a sum, outside functions."""
    match node:
        case ast.BinOp(left=left, right=right):
            return is_sum(node) or has_bracket(left) or has_bracket(right)
        case ast.UnaryOp(operand=operand):
            return has_bracket(operand)
    return False


def _smallest(values: Numbers, count: int) -> Sequence[int]:
    """The indices of the smallest finite values."""
    finite = (k for k, x in enumerate(values) if math.isfinite(x))
    return sorted(finite, key=lambda k: abs(values[k]))[:count]
