"""Formulas from text, safely: an expression is read, never executed.

Python's own parser makes the syntax tree, and only the nodes listed here are
turned into SymPy values; a name is looked up in the scope that the caller
gives, and nowhere else.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from difflib import get_close_matches
from typing import Any, TypeAlias

import sympy as sp

Value: TypeAlias = sp.Expr | sp.MatrixBase
Scope = Mapping[str, Any]

#: Longest text that is read, and largest exponent: enough for any formula on paper.
LONGEST, LARGEST_POWER = 20_000, 100


class ExpressionError(ValueError):
    """A text that is no formula; the message says which part, and what is allowed."""


def parsed(text: str, scope: Scope) -> Value:
    """The value of the formula `text`, with names from `scope`.

    Numbers are exact (``1/2`` is one half, ``9.81`` is 981/100), ``(a, b)`` is a
    column and ``[[a, b], [c, d]]`` a matrix.

    Raises
    ------
    ExpressionError
        For everything that is not arithmetic on known names and functions.
    """
    return evaluated(tree(text), scope)


def tree(text: str) -> ast.expr:
    """The syntax tree of a formula."""
    if len(text) > LONGEST:
        raise ExpressionError(f"a formula of {len(text)} characters: at most {LONGEST} are read")
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise ExpressionError(f"cannot read {text.strip()[:80]!r} as a formula: {error}") from None


def evaluated(node: ast.expr, scope: Scope) -> Value:
    """The value of a syntax tree, with names from `scope`."""
    try:
        return _value(node, scope)
    except RecursionError:
        raise ExpressionError("a formula nested too deeply: name its parts") from None


def _value(node: ast.expr, scope: Scope) -> Any:
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            return sp.Rational(str(number))
        case ast.Name(id=name):
            return _named(name, scope)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_value(operand, scope)
        case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
            return _power(_value(base, scope), _value(exponent, scope))
        case ast.BinOp(left=left, op=operator, right=right) if type(operator) in OPERATORS:
            return OPERATORS[type(operator)](_value(left, scope), _value(right, scope))
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
            function = _named(name, scope)
            if not callable(function) or isinstance(function, sp.Basic):
                raise ExpressionError(f"{name!r} is no function; write the product with *")
            return function(*(_value(argument, scope) for argument in arguments))
        case ast.Tuple(elts=items):
            return sp.ImmutableDenseMatrix([_value(item, scope) for item in items])
        case ast.List(elts=rows):
            return sp.ImmutableDenseMatrix(
                [
                    [_value(item, scope) for item in row.elts]
                    for row in rows
                    if isinstance(row, ast.List)
                ]
            )
        case ast.BinOp(op=ast.BitXor()):
            raise ExpressionError(f"{ast.unparse(node)[:80]!r}: write powers with **, not ^")
    raise ExpressionError(
        f"{ast.unparse(node)[:80]!r} is not allowed in a formula: use numbers, names, + - * / ** "
        "and known functions"
    )


OPERATORS: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
}


def _named(name: str, scope: Scope) -> Any:
    if name not in scope:
        close = get_close_matches(name, scope, n=1)
        hint = f" (did you mean {close[0]!r}?)" if close else ""
        raise ExpressionError(
            f"unknown name {name[:50]!r}{hint}; known are: {', '.join(sorted(scope))}"
        )
    return scope[name]


def _power(base: Value, exponent: Value) -> Value:
    if not (exponent.is_Rational and abs(exponent) <= LARGEST_POWER):
        raise ExpressionError(
            f"exponent {str(exponent)[:50]}: only numbers up to {LARGEST_POWER} are allowed"
        )
    return base**exponent
