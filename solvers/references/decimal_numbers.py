"""Decimal numbers of any length: states, sines and cosines, and generated literals.

Generated functions compute with all digits of their literals, instead of floats. Else a quotient
such as ``1.0/3.0`` is rounded to double precision before it meets another number, and a literal
with forty digits when it is read: a series with more digits would not notice.
"""

import __future__

import ast
import inspect
from collections.abc import Callable, Sequence
from decimal import Decimal, localcontext
from functools import cache
from textwrap import dedent
from types import CodeType
from typing import Any

from solvers.equations.forms import Form


def decimal_state(form: Form, y0: Sequence[float]) -> list[Decimal]:
    """The state of a form, followed by the angles that it knows by sine and cosine.

    `y0` is an ordinary state, taken as exact; digits are those of the current context.
    """
    ordinary = [Decimal(float(y)) for y in y0]
    state = [Decimal(0)] * len(form.state)
    for k, i in form.shared_columns:
        state[i] = ordinary[k]
    for k, i in form.angle_columns:
        state[i], state[i + 1] = sine_and_cosine(ordinary[k])
    return [*state, *(ordinary[k] for k, _ in form.angle_columns)]


def sine_and_cosine(x: Decimal) -> tuple[Decimal, Decimal]:
    """Sine and cosine to the digits of the current context, by the exponential series."""
    with localcontext() as context:
        # digits that the reduction takes, and that terms up to exp π take
        context.prec += max(x.adjusted(), 0) + 5
        turn = 2 * _pi(context.prec)
        x = x - turn * (x / turn).to_integral_value()
        smallest = Decimal(10) ** -context.prec
        sums, term, k = [Decimal(0), Decimal(0)], Decimal(1), 0
        while abs(term) > smallest or k < abs(x):
            sums[k % 2] += term if k % 4 < 2 else -term
            k += 1
            term *= x / k
    cosine, sine = sums
    return +sine, +cosine


@cache
def _pi(digits: int) -> Decimal:
    """π by the arithmetic-geometric mean (R. P. Brent, E. Salamin, 1976)."""
    with localcontext(prec=digits + 5):
        a, b, t, power = Decimal(1), Decimal("0.5").sqrt(), Decimal("0.25"), 1
        while a - b > Decimal(10) ** -digits:
            mean = (a + b) / 2
            b, t, power = (a * b).sqrt(), t - power * (a - mean) ** 2, 2 * power
            a = mean
        return (a + b) ** 2 / (4 * t)


#: The name of the function that takes the text of a literal, and flags of the compiler.
LITERAL, FLAGS = "_literal", __future__.annotations.compiler_flag


def with_exact_literals(
    function: Callable[..., Any], number: Callable[[Decimal], Any]
) -> Callable[..., Any]:
    """A generated function in which `number` takes the place of each literal with a point.

    A function without source, or with variables of another function, stays as it is.
    """
    code = _code(function)
    if code is None:
        return function
    namespace = {**function.__globals__, LITERAL: lambda text: number(Decimal(text))}
    exec(code, namespace)  # the text of a function that is executed anyway
    result: Callable[..., Any] = namespace[function.__name__]
    return result


@cache
def _code(function: Callable[..., Any]) -> CodeType | None:
    """The definition of a function, compiled with calls in place of its literals."""
    try:
        source = dedent(inspect.getsource(function))
        tree = ast.parse(source)
    except (OSError, TypeError, SyntaxError):
        return None
    if not isinstance(tree.body[0], ast.FunctionDef) or inspect.getclosurevars(function).nonlocals:
        return None
    tree = ast.fix_missing_locations(_Literals(source).visit(tree))
    return compile(tree, function.__module__, "exec", FLAGS, dont_inherit=True)


class _Literals(ast.NodeTransformer):
    """Replaces literals of type float in a text by calls with their digits."""

    def __init__(self, source: str) -> None:
        self._source = source

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        if not isinstance(node.value, float):
            return node
        text = ast.Constant(ast.get_source_segment(self._source, node))
        return ast.copy_location(ast.Call(ast.Name(LITERAL, ast.Load()), [text], []), node)
