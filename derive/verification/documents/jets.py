"""Numbers with their first rates of change, and formulas evaluated with them.

A jet holds the Taylor coefficients of a quantity in time, each an array over many states, so that
the rate of any formula is known without differentiating it (A. Griewank, A. Walther, Evaluating
Derivatives, chapter 13). Unknown coefficients, such as third derivatives, are NaN; a jet can also
have fewer of them, and what is computed with it has no more.
"""

import ast
import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, reduce
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from derive.formulas.syntax import syntax_tree

#: Taylor coefficients: the value, the rate, and half the second derivative.
ORDERS = 3

Array: TypeAlias = NDArray[np.float64]


class UnknownNameError(LookupError):
    """A name without a value, or a part of a formula that has none here."""


@dataclass(eq=False, slots=True)  # not frozen: setting fields would take most of the time
class Jet:
    """A quantity at many states; `coefficients` has the shape (orders, candidates, states)."""

    coefficients: Array

    #: NumPy leaves operations with arrays of jets to this class.
    __array_ufunc__ = None

    @classmethod
    def of(cls, value: Array, rate: Array | float = 0.0, second: Array | float = 0.0) -> "Jet":
        """A quantity from its value and its first two derivatives."""
        value = np.atleast_2d(value)
        coefficients = np.empty((ORDERS, *np.broadcast(value, rate, second).shape))
        coefficients[0], coefficients[1], coefficients[2] = value, rate, second
        coefficients[2] /= 2
        return cls(coefficients)

    @property
    def value(self) -> Array:
        """The values at all states."""
        value: Array = self.coefficients[0]
        return value

    @property
    def constant(self) -> "Jet":
        """The value alone, without its derivatives."""
        return Jet(self.coefficients[:1])

    @property
    def rate(self) -> "Jet":
        """The rate of change."""
        c = self.coefficients
        return Jet(np.array([c[1], 2 * c[2], np.full_like(c[0], np.nan)]))

    def __add__(self, other: "Jet") -> "Jet":
        a, b = self._common(other)
        return Jet(a + b)

    def __sub__(self, other: "Jet") -> "Jet":
        a, b = self._common(other)
        return Jet(a - b)

    def __neg__(self) -> "Jet":
        return Jet(-self.coefficients)

    def __mul__(self, other: "Jet") -> "Jet":
        a, b = self._common(other)
        if len(a) == 1:
            return Jet(a * b)
        orders = [a[0] * b[k] for k in range(len(a))]
        for k in range(1, len(a)):
            for j in range(1, k + 1):
                orders[k] += a[j] * b[k - j]
        return Jet(np.array(orders))

    def __truediv__(self, other: "Jet") -> "Jet":
        quotients: list[Array] = []
        a, b = self._common(other)
        if len(a) == 1:
            return Jet(a / b)
        for k in range(len(a)):
            rest = a[k] - sum(quotients[j] * b[k - j] for j in range(k))
            quotients.append(rest / b[0])
        return Jet(np.array(quotients))

    def _common(self, other: "Jet") -> tuple[Array, Array]:
        """The coefficients of both, as many as both have."""
        a, b = self.coefficients, other.coefficients
        orders = min(len(a), len(b))
        return a[:orders], b[:orders]

    def function(self, function: "Function") -> "Jet":
        """A function of the quantity, with its first two derivatives as far as these are known."""
        value, derivatives = function
        if len(self.coefficients) == 1:
            return Jet(value(self.coefficients))
        first, second = derivatives(self.value)
        _, b, c = self.coefficients
        return Jet(np.array([value(self.value), first * b, first * c + second * b**2 / 2]))

    def power(self, exponent: float) -> "Jet":
        """The quantity to a constant power."""
        return self.function(_power(exponent))


#: A function, and its first two derivatives.
Function: TypeAlias = tuple[Callable[[Array], Array], Callable[[Array], tuple[Array, Array]]]


def _power(n: float) -> Function:
    def derivatives(x: Array) -> tuple[Array, Array]:
        first = n * x ** (n - 1) if n else 0 * x
        second = n * (n - 1) * x ** (n - 2) if n * (n - 1) else 0 * x
        return first, second

    return lambda x: x**n, derivatives


def _flat(x: Array) -> tuple[Array, Array]:
    return 0 * x, 0 * x


FUNCTIONS: dict[str, Function] = {
    "sin": (np.sin, lambda x: (np.cos(x), -np.sin(x))),
    "cos": (np.cos, lambda x: (-np.sin(x), -np.cos(x))),
    "tan": (np.tan, lambda x: (np.cos(x) ** -2.0, 2 * np.tan(x) * np.cos(x) ** -2.0)),
    "exp": (np.exp, lambda x: (np.exp(x),) * 2),
    "log": (np.log, lambda x: (1 / x, -1 / x**2)),
    "sqrt": _power(0.5),
    **dict.fromkeys(("Abs", "abs", "norm"), (np.abs, lambda x: (np.sign(x), 0 * x))),
    "sinh": (np.sinh, lambda x: (np.cosh(x), np.sinh(x))),
    "cosh": (np.cosh, lambda x: (np.sinh(x), np.cosh(x))),
    "tanh": (np.tanh, lambda x: (np.cosh(x) ** -2.0, -2 * np.tanh(x) * np.cosh(x) ** -2.0)),
    "atan": (np.arctan, lambda x: (1 / (1 + x**2), -2 * x / (1 + x**2) ** 2)),
    "sign": (np.sign, _flat),
    "Heaviside": (lambda x: (np.sign(x) + 1) / 2, _flat),
    "DiracDelta": (lambda x: 0 * x, _flat),
}
#: The larger and the smaller of two numbers.
EXTREMES: dict[str, Callable[[Array, Array], Any]] = {
    **dict.fromkeys(("max", "Max"), np.greater),
    **dict.fromkeys(("min", "Min"), np.less),
}
COMPARISONS: dict[type[ast.cmpop], Callable[[Array, Array], Any]] = {
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
}

OPERATIONS: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
}

#: Jets, and matrices of them as arrays of objects.
Value: TypeAlias = Any


class Constants(dict[str, Value]):
    """The values of names without their derivatives, of which most formulas need none."""

    def __init__(self, values: Mapping[str, Value]) -> None:
        super().__init__()
        self._values = values

    def __missing__(self, name: str) -> Value:
        value = self._values[name]
        self[name] = value = value.constant if isinstance(value, Jet) else value
        return value


@cache
def _tree(text: str) -> ast.expr:
    return syntax_tree(text)


def evaluated(text: str, values: Mapping[str, Value]) -> Value:
    """The value of a formula; `UnknownNameError` if it has none."""
    with np.errstate(all="ignore"):
        try:
            return _value(_tree(text), values)
        except (ValueError, TypeError, AttributeError) as error:  # shapes of matrices, or text
            raise UnknownNameError(str(error)) from error


def _value(node: ast.expr, values: Mapping[str, Value]) -> Value:
    match node:
        case ast.Constant(value=int() | float() as number):
            return _constant(float(number))
        case ast.Name(id=name):
            try:
                return values[name]
            except KeyError:
                raise UnknownNameError(name) from None
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_value(operand, values)
        case ast.BinOp(left=base, op=ast.Pow(), right=ast.Constant(value=int() | float() as n)):
            value = _value(base, values)
            is_square = isinstance(value, np.ndarray) and n == 2
            return _of_matrices(value, value) if is_square else value.power(float(n))
        case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
            return _raised(_value(base, values), _value(exponent, values))
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            a, b = _value(left, values), _value(right, values)
            if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
                return _of_matrices(a, b)
            return _product(b, a) if isinstance(b, np.ndarray) else _product(a, b)
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            return _value(left, values) / _value(right, values)
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as op, right=right):
            return OPERATIONS[type(op)](_value(left, values), _value(right, values))
        case ast.Call(func=ast.Name(id="ddt"), args=[argument]):
            return _value(argument, values).rate
        case ast.Call(func=ast.Name(id="transpose"), args=[argument]):
            return _value(argument, values).T
        case ast.Call(func=ast.Name(id="square"), args=[argument]):
            column = _value(argument, values)
            return (column.T @ column)[0, 0]
        case ast.Call(func=ast.Name(id=name), args=[argument]) if name in FUNCTIONS:
            return _value(argument, values).function(FUNCTIONS[name])
        case ast.Call(func=ast.Name(id="Heaviside"), args=[argument, _]):
            return _value(argument, values).function(FUNCTIONS["Heaviside"])
        case ast.Call(func=ast.Name(id=name), args=[_, *_] as arguments) if name in EXTREMES:
            jets = [_value(argument, values) for argument in arguments]
            return reduce(lambda a, b: _chosen(EXTREMES[name](a.value, b.value), a, b), jets)
        case ast.Call(func=ast.Name(id="atan2"), args=[y, x]):
            return _angle(_value(y, values), _value(x, values))
        case ast.Call(func=ast.Name(id="Piecewise"), args=[_, *_] as pieces):
            return _first_piece(pieces, values)
        case ast.Tuple(elts=items):
            entries = [_value(item, values) for item in items]
            if all(isinstance(one, np.ndarray) for one in entries):
                return np.vstack(entries)
            column = np.empty((len(items), 1), dtype=object)
            column[:, 0] = [*map(_entry, entries)]
            return column
        case ast.List(elts=rows):
            lists = [row.elts for row in rows if isinstance(row, ast.List)]
            matrix = np.empty((len(lists), len(lists[0])), dtype=object)
            for i, row in enumerate(lists):
                for j, entry in enumerate(row):
                    matrix[i, j] = _entry(_value(entry, values))
            return matrix
    raise UnknownNameError(ast.unparse(node)[:80])


def _entry(value: Value) -> Jet:
    """A value as an entry of a matrix, whose entries are no matrices."""
    if isinstance(value, np.ndarray):
        raise UnknownNameError("a matrix of matrices")
    return value


def _of_matrices(a: Value, b: Value) -> Value:
    """A product of matrices; that of two columns is their scalar product."""
    is_scalar = a.shape == b.shape in ((2, 1), (3, 1))
    return (a.T @ b)[0, 0] if is_scalar else a @ b


def _product(value: Value, factor: Jet) -> Value:
    """A jet, or each entry of a matrix of them, times a factor."""
    if not isinstance(value, np.ndarray):
        return value * factor
    return np.vectorize(lambda entry: entry * factor, otypes=[object])(value)


@cache
def _constant(number: float) -> Jet:
    return Jet.of(np.array([number]))


def _raised(base: Jet, exponent: Jet) -> Jet:
    value = exponent.value
    if np.any(value != value.flat[0]) or np.any(exponent.coefficients[1:]):
        return (exponent * base.function(FUNCTIONS["log"])).function(FUNCTIONS["exp"])
    return base.power(float(value.flat[0]))


def _chosen(condition: Any, a: Jet, b: Jet) -> Jet:
    first, second = a._common(b)
    return Jet(np.where(condition, first, second))


def _angle(y: Jet, x: Jet) -> Jet:
    value = np.arctan2(y.value, x.value)
    if len(y._common(x)[0]) == 1:
        return Jet(value[np.newaxis])
    rate = (x * y.rate - y * x.rate) / (x * x + y * y)
    return Jet.of(value, rate.value, rate.coefficients[1])


def _first_piece(pieces: Sequence[ast.expr], values: Mapping[str, Value]) -> Jet:
    """The value of the first piece whose condition holds."""
    match pieces:
        case [ast.Tuple(elts=[value, ast.Name(id="True")])]:
            return _value(value, values)
        case [ast.Tuple(elts=[value, ast.Compare(left, [relation], [right])]), *rest]:
            a, b = (_value(side, values).value for side in (left, right))
            condition = COMPARISONS[type(relation)](a, b)
            return _chosen(condition, _value(value, values), _first_piece(rest, values))
    raise UnknownNameError("a choice without a last piece")
