"""Numeric values of expressions with many digits, and bounds of their errors.

Each operation adds its rounding error to the errors of its operands (N. J. Higham, Accuracy and
Stability of Numerical Algorithms, § 3.3). A value that does not exceed its error is zero as far as
the digits show; a divisor of this kind leaves no value.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
from mpmath import MPContext
from sympy.core.relational import Relational
from sympy.logic.boolalg import Boolean

#: Digits of the arithmetic, and of values that are converted to SymPy numbers.
WORKING_DIGITS, DIGITS = 120, 90

#: Largest logarithm of a value: the exponential function of more is refused.
MAX_LOGARITHM = 10**5

mp = MPContext()
mp.dps = WORKING_DIGITS
ROUNDING = mp.mpf(10) ** (1 - WORKING_DIGITS)

#: Largest error of the argument of a function, and largest ratio that counts as zero.
TINY = mp.mpf("1e-30")


class NoValueError(ArithmeticError):
    """An expression has no value, because it divides by zero, or none that is computable."""


@dataclass(frozen=True, slots=True)
class Approximation:
    """A real or complex number, and a bound of its error."""

    number: Any
    error: Any = mp.zero

    @property
    def is_zero(self) -> bool:
        """Whether the digits do not differ from zero."""
        return bool(abs(self.number) <= self.error)

    def rounded(self) -> sp.Expr:
        """The value as a SymPy number, with as many digits as its error leaves."""
        digits = DIGITS
        if self.number and self.error:
            known = -mp.log10(self.error / abs(self.number))
            digits = max(1, min(DIGITS, int(mp.floor(known)) - 1))
        parts = [sp.Float(str(part), digits) for part in (self.number.real, self.number.imag)]
        return parts[0] + sp.I * parts[1] if parts[1] else parts[0]


class Evaluator:
    """Values of expressions at one state; equal subexpressions are evaluated once."""

    def __init__(self, state: Mapping[sp.Symbol, sp.Expr]) -> None:
        self.state = state
        self._known: dict[sp.Basic, Approximation] = {}
        self._known |= {symbol: self(value) for symbol, value in state.items()}

    def __call__(self, expression: sp.Expr) -> Approximation:
        """Evaluate `expression`; a `NoValueError` states why it has no value."""
        if expression not in self._known:
            self._known[expression] = self._evaluate(expression)
        return self._known[expression]

    def _evaluate(self, expression: sp.Expr) -> Approximation:
        if expression.is_Rational:
            number = mp.mpf(expression.p) / expression.q
            return Approximation(number, ROUNDING * abs(number))
        if expression.is_Float:
            number = mp.make_mpf(expression._mpf_)
            return Approximation(number, mp.ldexp(abs(number), 1 - expression._prec))
        if expression.is_NumberSymbol:
            number = mp.make_mpf(expression.evalf(WORKING_DIGITS)._mpf_)
            return Approximation(number, ROUNDING * abs(number))
        if expression is sp.I:
            return Approximation(mp.j)
        if expression.is_Add:
            return _sum(map(self, expression.args))
        if expression.is_Mul:
            return _product(map(self, expression.args))
        if expression.is_Pow and expression.exp.is_Rational:
            return _power(self(expression.base), expression.exp)
        if expression.is_Pow:
            return _real_power(self(expression.base), self(expression.exp))
        if expression.func in FUNCTIONS:
            return FUNCTIONS[expression.func](self(expression.args[0]))
        if isinstance(expression, sp.Max | sp.Min):
            values = [*map(self, expression.args)]
            best = max if isinstance(expression, sp.Max) else min
            return best(values, key=lambda value: value.number.real)
        if isinstance(expression, sp.Piecewise):
            return self(
                next(value for value, condition in expression.args if self._holds(condition))
            )
        return self._by_sympy(expression)

    def _holds(self, condition: Boolean) -> bool:
        """Whether a condition of a choice holds; of numbers that are equal, to all digits."""
        if not isinstance(condition, Relational):
            parts = [*map(self._holds, condition.args)]
            if isinstance(condition, sp.Not):
                return not parts[0]
            if isinstance(condition, sp.And | sp.Or):
                return all(parts) if isinstance(condition, sp.And) else any(parts)
            return bool(condition == sp.true)
        difference = self(condition.lhs - condition.rhs)
        sign = 0 if difference.is_zero else int(mp.sign(difference.number.real))
        return bool(condition.func(sign, 0))

    def _by_sympy(self, expression: sp.Expr) -> Approximation:
        """The value of another function, such as sinh, whose error is assumed small."""
        value = expression.xreplace(dict(self.state)).evalf(DIGITS)
        if not value.is_number or not value.is_finite:
            raise NotImplementedError(f"cannot evaluate {str(expression)[:80]!r} in numbers")
        real, imaginary = (self(sp.Float(part, DIGITS)).number for part in value.as_real_imag())
        number = mp.mpc(real, imaginary) if imaginary else real
        return Approximation(number, TINY**2 * (1 + abs(number)))


def solved(
    matrix: sp.MatrixBase, column: sp.MatrixBase, evaluator: Evaluator
) -> tuple[sp.Expr, ...]:
    """Solve linear equations at a state; the coefficients are expressions.

    Their errors are those of the residuals, carried through the inverse (Higham, § 7.1). Values
    that do not exceed their errors are zero.
    """
    rows = [[evaluator(entry) for entry in matrix.row(i)] for i in range(matrix.rows)]
    right = [evaluator(entry) for entry in column]
    coefficients = mp.matrix([[entry.number for entry in row] for row in rows])
    solution = mp.lu_solve(coefficients, mp.matrix([entry.number for entry in right]))
    opposite = [Approximation(-entry) for entry in solution]
    residuals = [
        _sum([side, *(_product(pair) for pair in zip(row, opposite, strict=True))])
        for row, side in zip(rows, right, strict=True)
    ]
    inverse = coefficients**-1
    values = []
    for k, entry in enumerate(solution):
        sizes = (abs(one.number) + one.error for one in residuals)
        errors = (abs(inverse[k, i]) * size for i, size in enumerate(sizes))
        values.append(Approximation(entry, 2 * mp.fsum(errors)))
    return tuple(sp.S.Zero if one.is_zero else one.rounded() for one in values)


def independent(rows: Sequence[Sequence[sp.Expr]]) -> list[int]:
    """Return the indices of rows of numbers that are not combinations of rows before them."""
    indices: list[int] = []
    pivots: list[tuple[int, list[Any]]] = []
    for index, row in enumerate(rows):
        rest = [Evaluator({})(entry).number for entry in row]
        size = max(map(abs, rest))
        for column, pivot in pivots:
            factor = rest[column] / pivot[column]
            rest = [a - factor * b for a, b in zip(rest, pivot, strict=True)]
        column = max(range(len(rest)), key=lambda k: abs(rest[k]))
        if abs(rest[column]) > size * TINY:
            indices.append(index)
            pivots.append((column, rest))
    return indices


def _sum(operands: Iterable[Approximation]) -> Approximation:
    number = error = mp.zero
    for operand in operands:
        number += operand.number
        error += operand.error + ROUNDING * (abs(number) + abs(operand.number))
    return Approximation(number, error)


def _product(operands: Iterable[Approximation]) -> Approximation:
    number, error = mp.one, mp.zero
    for operand in operands:
        size = abs(operand.number)
        error = error * (size + operand.error) + abs(number) * operand.error
        number *= operand.number
        error += ROUNDING * abs(number)
    return Approximation(number, error)


def _power(base: Approximation, exponent: sp.Rational) -> Approximation:
    power = int(exponent) if exponent.is_Integer else mp.mpf(exponent.p) / exponent.q
    if base.is_zero:
        if power < 0:
            raise NoValueError("it divides by zero")
        return Approximation(mp.zero, mp.power(2 * base.error, power))
    number = mp.power(base.number, power)
    relative = 2 * abs(power) * (base.error / abs(base.number) + ROUNDING)
    return Approximation(number, abs(number) * (relative + ROUNDING))


def _real_power(base: Approximation, exponent: Approximation) -> Approximation:
    if base.is_zero:
        if exponent.number.real <= 0:
            raise NoValueError("it divides by zero")
        return Approximation(mp.zero, mp.power(2 * base.error, exponent.number.real))
    return _exponential(_product([exponent, _logarithm(base)]))


def _argument(operand: Approximation, name: str) -> Any:
    if operand.error > TINY or abs(mp.im(operand.number)) > MAX_LOGARITHM:
        raise NoValueError(f"the argument of {name} is too large")
    return operand.number


def _wave(name: str) -> Any:
    def wave(operand: Approximation) -> Approximation:
        number = getattr(mp, name)(_argument(operand, name))
        slope = mp.cosh(mp.im(operand.number))
        return Approximation(number, 2 * operand.error * slope + ROUNDING * (abs(number) + slope))

    return wave


def _tangent(operand: Approximation) -> Approximation:
    sine, cosine = _wave("sin")(operand), _wave("cos")(operand)
    return _product([sine, _power(cosine, sp.S.NegativeOne)])


def _exponential(operand: Approximation) -> Approximation:
    argument = _argument(operand, "exp")
    if abs(argument) > MAX_LOGARITHM:
        raise NoValueError("the argument of exp is too large")
    number = mp.exp(argument)
    return Approximation(number, abs(number) * (2 * operand.error + ROUNDING))


def _logarithm(operand: Approximation) -> Approximation:
    if operand.is_zero:
        raise NoValueError("it contains the logarithm of zero")
    number = mp.log(operand.number)
    error = 2 * operand.error / abs(operand.number)
    return Approximation(number, error + ROUNDING * (1 + abs(number)))


def _absolute(operand: Approximation) -> Approximation:
    return Approximation(abs(operand.number), operand.error)


def _sign(operand: Approximation) -> Approximation:
    return Approximation(mp.zero if operand.is_zero else mp.sign(operand.number), ROUNDING)


def _impulse(operand: Approximation) -> Approximation:
    if operand.is_zero:
        raise NoValueError("it contains the derivative of a step at the step")
    return Approximation(mp.zero)


#: Functions by their SymPy class.
FUNCTIONS = {
    sp.sin: _wave("sin"),
    sp.cos: _wave("cos"),
    sp.tan: _tangent,
    sp.exp: _exponential,
    sp.log: _logarithm,
    sp.Abs: _absolute,
    sp.sign: _sign,
    sp.DiracDelta: _impulse,
}
