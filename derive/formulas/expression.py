"""Formulas from text, safely: an expression is read, never executed.

Python's own parser makes the syntax tree, and only the nodes listed here are
turned into SymPy values; a name is looked up in the scope that the caller
gives, and nowhere else. Sizes are limited before anything is computed.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping
from decimal import Decimal
from typing import Any, TypeAlias

import sympy as sp

from solvers.io.suggestion import did_you_mean

Value: TypeAlias = sp.Expr | sp.MatrixBase
Scope = Mapping[str, Any]

#: What stands between the sides of a statement.
RELATION = re.compile(r"(>=|<=|=|>|<)")

#: What a formula may call, and the numbers that have names.
FUNCTIONS: dict[str, Any] = {
    "sin": sp.sin, "cos": sp.cos, "tan": sp.tan, "exp": sp.exp, "log": sp.log, "sqrt": sp.sqrt,
    "pi": sp.pi,
}  # fmt: skip

#: Longest text that is read, largest exponent and most bits of a number: ample on paper.
LONGEST, LARGEST_POWER, MOST_BITS = 20_000, 100, 256


class ExpressionError(ValueError):
    """A text that is no formula; the message says which part, and what is allowed."""


def parsed(text: str, scope: Scope) -> Value:
    """The value of the formula `text`, with names from `scope`.

    Numbers are exact (``1/2`` is one half, ``9.81`` is 981/100), ``(a, b)`` is a
    column and ``[[a, b], [c, d]]`` a matrix.

    Parameters
    ----------
    text : str
        The formula, of at most `LONGEST` characters.
    scope : mapping of str to SymPy values and functions
        All names that it may use, functions such as those in `FUNCTIONS` among them.

    Returns
    -------
    sympy.Expr or sympy.ImmutableDenseMatrix

    Raises
    ------
    ExpressionError
        For everything that is not arithmetic on known names and functions, and
        for what has no finite value.
    """
    return evaluated(tree(text), text.strip(), scope)


def tree(text: str) -> ast.expr:
    """The syntax tree of a formula."""
    if len(text) > LONGEST:
        raise ExpressionError(f"a formula of {len(text)} characters: at most {LONGEST} are read")
    for character in "#\n\\":
        if character in text.strip():
            raise ExpressionError(f"{character!r} has no meaning in a formula: {text[:80]!r}")
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise ExpressionError(f"cannot read {text.strip()[:80]!r} as a formula: {error}") from None


def evaluated(node: ast.expr, text: str, scope: Scope) -> Value:
    """The value of the syntax tree of `text`, or of a part of it."""
    try:
        value = _Evaluation(text, scope).value(node)
    except ExpressionError:
        raise
    except RecursionError:
        raise ExpressionError("a formula nested too deeply: name its parts") from None
    except Exception as error:  # SymPy's many ways to refuse an operation
        raise ExpressionError(f"{text[:80]!r} cannot be computed: {error}") from None
    if value.has(sp.zoo, sp.nan, sp.oo):
        raise ExpressionError(f"{text[:80]!r} has no finite value: it divides by zero")
    return value


class _Evaluation:
    def __init__(self, text: str, scope: Scope) -> None:
        self._text, self._scope = text, scope

    def value(self, node: ast.expr) -> Any:
        value = self._value(node)
        if isinstance(value, sp.Rational):
            bits = max(abs(value.p).bit_length(), value.q.bit_length())
            if bits > MOST_BITS:
                raise ExpressionError(f"a number of {bits} bits: at most {MOST_BITS} are allowed")
        return value

    def _value(self, node: ast.expr) -> Any:
        match node:
            case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
                # from its digits: a float would have rounded them
                digits = Decimal(ast.get_source_segment(self._text, node) or "nan")
                if abs(digits.adjusted()) > LARGEST_POWER:
                    raise ExpressionError(f"{_shown(node)} is out of range: 1e-100 to 1e100")
                return sp.Rational(*digits.as_integer_ratio())
            case ast.Name(id=name):
                return self._named(name, function=False)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.value(operand)
            case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
                return _power(self.value(base), self.value(exponent))
            case ast.BinOp(left=left, op=operator, right=right) if type(operator) in OPERATORS:
                return OPERATORS[type(operator)](self.value(left), self.value(right))
            case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
                function = self._named(name, function=True)
                return function(*(self.value(argument) for argument in arguments))
            case ast.Tuple(elts=[_, *_] as items):
                return sp.ImmutableDenseMatrix([self._number(item) for item in items])
            case ast.List(elts=[ast.List(elts=[_, *_] as first), *_] as rows) if all(
                isinstance(row, ast.List) and len(row.elts) == len(first) for row in rows
            ):
                entries = [item for row in rows if isinstance(row, ast.List) for item in row.elts]
                shape = len(rows), len(first)
                return sp.ImmutableDenseMatrix(*shape, list(map(self._number, entries)))
            case ast.BinOp(op=ast.BitXor()):
                raise ExpressionError(f"{_shown(node)}: write powers with **, not ^")
        raise ExpressionError(
            f"{_shown(node)} is not allowed in a formula: use numbers, names, + - * / **, known "
            "functions, (a, b) for a column and [[a, b], [c, d]] for a matrix"
        )

    def _number(self, node: ast.expr) -> sp.Expr:
        value = self.value(node)
        if isinstance(value, sp.MatrixBase):
            raise ExpressionError(f"{_shown(node)} cannot be an entry: entries are numbers")
        return value

    def _named(self, name: str, *, function: bool) -> Any:
        if name not in self._scope:
            raise ExpressionError(
                f"unknown name {name[:50]!r}{did_you_mean(name, self._scope)}; "
                f"known are: {', '.join(sorted(self._scope))}"
            )
        value = self._scope[name]
        if isinstance(value, sp.Expr | sp.MatrixBase) == function:
            needs = "is no function; write a product with *" if function else "needs arguments"
            raise ExpressionError(f"{name!r} {needs}")
        return value


OPERATORS: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
}


def _shown(node: ast.expr) -> str:
    return repr(ast.unparse(node)[:80])


def _power(base: Value, exponent: Value) -> Value:
    if not (isinstance(exponent, sp.Rational) and abs(exponent) <= LARGEST_POWER):
        raise ExpressionError(
            f"exponent {str(exponent)[:50]}: only numbers up to {LARGEST_POWER} are allowed"
        )
    if isinstance(base, sp.MatrixBase):
        raise ExpressionError("a matrix has no powers here: write out the product")
    if isinstance(base, sp.Rational) and base.p.bit_length() * abs(exponent) > MOST_BITS:
        raise ExpressionError(f"{base}**{exponent} has more than {MOST_BITS} bits")
    return base**exponent
