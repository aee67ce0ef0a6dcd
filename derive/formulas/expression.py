"""Safe parsing of formulas: text is parsed and never executed.

Of the syntax tree that Python's parser builds, only the nodes listed here become SymPy
values, with names from the caller's scope. Sizes are limited before anything is computed.
"""

import ast
import operator
from collections.abc import Mapping, Sequence
from decimal import Decimal
from functools import reduce
from typing import Any, TypeAlias

import sympy as sp
from sympy.logic.boolalg import Boolean

from derive.formulas import functions
from derive.formulas.budget import INFINITE, MAX_BITS, MAX_EXPONENT, Budget, BudgetError
from derive.formulas.generic_values import check_value
from derive.formulas.numeric import NoValueError
from derive.formulas.syntax import ExpressionError, summands, syntax_tree
from solvers.io.suggestion import did_you_mean

Value: TypeAlias = sp.Expr | sp.MatrixBase
Namespace = Mapping[str, Any]

#: The functions and constants available in every formula.
FUNCTIONS: dict[str, Any] = functions.FUNCTIONS | {"pi": sp.pi}

#: The comparisons of conditions.
COMPARISONS = {ast.Lt: sp.Lt, ast.LtE: sp.Le, ast.Gt: sp.Gt, ast.GtE: sp.Ge}

#: Functions that have no value for some arguments.
PARTIAL = (sp.tan, sp.log)


def parse(text: str, namespace: Namespace, budget: Budget | None = None) -> Value:
    """Parse the formula `text`, whose names and functions are those of `namespace`.

    Its value is finite.

    Numbers are exact (``1/2`` is one half, ``9.81`` is 981/100), ``(a, b)`` is a
    column, also of columns below each other, and ``[[a, b], [c, d]]`` a matrix. The product of
    two columns with two or three entries is their scalar product. `budget` is that of all formulas
    of a file.
    """
    text, budget = text.strip(), budget or Budget()
    try:
        value = _Evaluator(namespace, budget).value(syntax_tree(text))
        budget.spend(value)
    except ExpressionError:
        raise
    except BudgetError as error:
        raise ExpressionError(f"{text[:80]!r} is out of bounds: {error}") from None
    except RecursionError:
        raise ExpressionError("the formula is nested too deeply: name its parts") from None
    except NoValueError as error:
        raise ExpressionError(f"{text[:80]!r} has no finite value: {error}") from None
    except Exception as error:  # SymPy raises many types for invalid operations
        raise ExpressionError(f"{text[:80]!r} cannot be computed: {error}") from None
    if value.has(*INFINITE):
        raise ExpressionError(f"{text[:80]!r} has no finite value: it divides by zero")
    return value


def number(text: str, namespace: Namespace, budget: Budget | None = None) -> sp.Expr:
    """Parse a formula whose value is a number: neither a column nor a matrix."""
    value = parse(text, namespace, budget)
    if isinstance(value, sp.MatrixBase):  # which is an expression, too, if it is immutable
        raise ExpressionError(f"{text.strip()[:50]!r} is a column or matrix, not a number")
    return value


class _Evaluator:
    def __init__(self, namespace: Namespace, budget: Budget) -> None:
        self._namespace, self._budget = namespace, budget

    def value(self, node: ast.expr) -> Any:
        value = self._value(node)
        if isinstance(value, sp.Expr | sp.MatrixBase):
            self._budget.check(value)
        return value

    def _value(self, node: ast.expr) -> Any:
        match node:
            case ast.Constant(value=int() | float(), kind=str() as digits):
                return _exact_number(digits)
            case ast.Name(id=name):
                return self._lookup(name, function=False)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.value(operand)
            case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
                return self._power(self.value(base), self.value(exponent))
            case ast.BinOp(op=ast.Add() | ast.Sub()):
                terms = [sign * self.value(term) for term, sign in summands(node)]
                if not all(isinstance(term, sp.MatrixBase) for term in terms):
                    # a quadratic form beside numbers is one
                    terms = [t[0] if getattr(t, "shape", ()) == (1, 1) else t for t in terms]
                has_matrix = any(isinstance(term, sp.MatrixBase) for term in terms)
                return reduce(operator.add, terms) if has_matrix else sp.Add(*terms)
            case ast.BinOp(left=left, op=ast.Mult(), right=right):
                return self._product(self.value(left), self.value(right))
            case ast.BinOp(left=left, op=ast.Div(), right=right):
                return self.value(left) / _divisor(self.value(right))
            case ast.Call(func=ast.Name(id="Piecewise"), args=[_, *_] as pieces, keywords=[]):
                return self._choice(node, pieces)
            case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
                return self._call(name, [*map(self.value, arguments)])
            case ast.Tuple(elts=[_, *_] as items):
                values = [*map(self.value, items)]
                if all(getattr(one, "shape", (0, 0))[1] == 1 for one in values):
                    return sp.ImmutableDenseMatrix(sp.Matrix.vstack(*values))
                return sp.ImmutableDenseMatrix(list(map(self._entry, items)))
            case ast.List(elts=[ast.List(elts=[_, *_]), *_] as lists):
                rows = [row.elts for row in lists if isinstance(row, ast.List)]
                if len(rows) == len(lists) and len(set(map(len, rows))) == 1:
                    return sp.ImmutableDenseMatrix([list(map(self._entry, row)) for row in rows])
            case ast.BinOp(op=ast.BitXor()):
                raise ExpressionError(f"{_quoted(node)}: write powers with **, not ^")
        raise ExpressionError(
            f"{_quoted(node)} is not allowed in a formula: use numbers, names, + - * / **, known "
            "functions, (a, b) for a column and [[a, b], [c, d]] for a matrix"
        )

    def _choice(self, node: ast.expr, pieces: Sequence[ast.expr]) -> sp.Expr:
        """The first of several numbers whose condition holds."""
        pairs = []
        for piece in pieces:
            match piece:
                case ast.Tuple(elts=[value, condition]):
                    pairs.append((self._entry(value), self._condition(condition)))
        if len(pairs) != len(pieces) or pairs[-1][1] != sp.true:
            raise ExpressionError(
                f"{_quoted(node)}: write Piecewise((a, x < 1), (b, x < 2), (c, True)), pairs of "
                "a value and its condition, of which the last one is True"
            )
        self._lookup("Piecewise", function=True)
        return sp.Piecewise(*pairs)

    def _condition(self, node: ast.expr) -> Boolean:
        match node:
            case ast.Name(id="True"):
                return sp.true
            case ast.Compare(left=left, ops=[relation], comparators=[right]):
                if type(relation) in COMPARISONS:
                    return COMPARISONS[type(relation)](self._entry(left), self._entry(right))
        raise ExpressionError(
            f"{_quoted(node)} is not a condition: compare two numbers by <, <=, > or >=, or write "
            "True"
        )

    def _entry(self, node: ast.expr) -> sp.Expr:
        value = self.value(node)
        if isinstance(value, sp.MatrixBase):
            raise ExpressionError(f"{_quoted(node)} cannot be an entry: entries are numbers")
        return value

    def _call(self, name: str, arguments: Sequence[Value]) -> Value:
        function = self._lookup(name, function=True)
        for value in arguments:
            if function is FUNCTIONS.get(name) and isinstance(value, sp.MatrixBase):
                raise ExpressionError(f"{name} of a column or matrix: it is a function of numbers")
        self._budget.check_arguments(function, arguments)
        for value in arguments:
            if function is sp.exp:
                self._budget.check_exponential(value)
            if isinstance(value, sp.Expr):
                self._budget.check_real(value)  # SymPy evaluates functions of them slowly
        result = function(*arguments)
        if isinstance(result, PARTIAL):
            check_value(result)
        return result

    def _product(self, a: Value, b: Value) -> Value:
        first_shape, shape = (getattr(one, "shape", ()) for one in (a, b))
        is_scalar = first_shape == shape and shape in ((2, 1), (3, 1))
        first = a.T if is_scalar else a
        self._budget.check_product(first, b)
        return (first * b)[0] if is_scalar else first * b

    def _power(self, base: Value, exponent: Value) -> Value:
        if isinstance(base, sp.MatrixBase) and base.cols == 1 and exponent == 2:
            return self._product(base, base)
        if isinstance(base, sp.MatrixBase) or isinstance(exponent, sp.MatrixBase):
            raise ExpressionError("powers of matrices are not supported: write out the product")
        self._budget.check_exponent(exponent)
        if not exponent.is_Rational:
            self._budget.check_real(base)
            return (_divisor(base) if exponent.could_extract_minus_sign() else base) ** exponent
        coefficient = base.as_coeff_Mul()[0]  # the power of a product is a product of powers
        bits = max(coefficient.p.bit_length(), coefficient.q.bit_length())
        if (bits - 1) * abs(exponent) > MAX_BITS:
            raise ExpressionError(f"{coefficient}**{exponent} has more than {MAX_BITS} bits")
        if not exponent.is_Integer:
            self._budget.check_real(base)
        return (_divisor(base) if exponent < 0 else base) ** exponent

    def _lookup(self, name: str, *, function: bool) -> Any:
        if name not in self._namespace:
            known = ", ".join(sorted(self._namespace))
            suggestion = did_you_mean(name, self._namespace)
            raise ExpressionError(f"unknown name {name[:50]!r}{suggestion}; known are: {known}")
        value = self._namespace[name]
        if isinstance(value, sp.Expr | sp.MatrixBase) == function:
            reason = "is not a function; write products with *" if function else "needs arguments"
            raise ExpressionError(f"{name!r} {reason}")
        return value


def _divisor(value: Value) -> Value:
    # SymPy cancels a divisor that is zero, unless it is zero in its automatic form
    if isinstance(value, sp.Expr) and value.has(sp.Add):
        check_value(1 / value)
    return value


def _quoted(node: ast.expr) -> str:
    return repr(ast.unparse(node)[:80])


def _exact_number(digits: str) -> sp.Rational:
    number = Decimal(digits)
    if abs(number.adjusted()) > MAX_EXPONENT:
        raise ExpressionError(f"{digits[:50]!r} is out of range: 1e-100 to 1e100")
    return sp.Rational(*number.as_integer_ratio())
