"""Residues modulo a prime: series with derivatives, linear equations, and values of expressions.

A rational function that is not zero vanishes at a random point with a probability of its degree
divided by the prime. Values of transcendental functions are random residues that obey their
functional equations: sin² + cos² = 1, sums of angles, and exp(a + b) = exp(a) exp(b); their series
follow from their differential equations.
"""

from collections.abc import Iterable, Iterator, Mapping
from random import Random
from typing import TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import NDArray

#: The largest prime below 2**31 modulo which -1 is no square, and all numbers are odd powers.
PRIME = 2147483579
Residues: TypeAlias = NDArray[np.int64]
Rows: TypeAlias = list[list[int]]


class NoRootError(ArithmeticError):
    """A number is not a square modulo the prime, or a divisor is zero: choose another point."""


def inverse(number: int) -> int:
    """1/number."""
    if number % PRIME == 0:
        raise NoRootError("a divisor is zero")
    return pow(int(number), -1, PRIME)


def product(series: Residues, factor: Residues) -> Residues:
    """The products of series in rows with one series `factor`."""
    n = len(factor)
    index = np.subtract.outer(np.arange(n), np.arange(n)).T
    toeplitz = np.where(index >= 0, factor[index], 0)
    high, low = series >> 16, series & 0xFFFF  # so that no sum of products exceeds 63 bits
    return ((high @ toeplitz % PRIME << 16) + low @ toeplitz) % PRIME


class ResidueSeries:
    """A power series in time and its derivatives by unknowns, the rows of `rows`."""

    def __init__(self, rows: Residues) -> None:
        self.rows = rows

    def __add__(self, other: "ResidueSeries") -> "ResidueSeries":
        return ResidueSeries((self.rows + other.rows) % PRIME)

    def __mul__(self, other: "ResidueSeries") -> "ResidueSeries":
        rows = product(self.rows, other.rows[0])
        rows[1:] += product(other.rows[1:], self.rows[0])
        return ResidueSeries(rows % PRIME)

    def scaled(self, number: int) -> "ResidueSeries":
        """A multiple."""
        return ResidueSeries(self.rows * (number % PRIME) % PRIME)

    def composed(self, values: Residues, slopes: Residues) -> "ResidueSeries":
        """A function of this series, from its own series and that of its derivative."""
        return ResidueSeries(np.vstack([values, product(self.rows[1:], slopes)]))

    def power(self, numerator: int, denominator: int = 1) -> "ResidueSeries":
        """A rational power; `NoRootError` where there is none."""
        x, exponent = self.rows[0].tolist(), numerator * inverse(denominator) % PRIME
        own, values = inverse(x[0]), [pow(_root(x[0], denominator), numerator, PRIME)]
        for k in range(1, len(x)):  # x f' = a x' f
            terms = ((exponent * j - (k - j)) * x[j] * values[k - j] for j in range(1, k + 1))
            values.append(sum(terms) * own * inverse(k) % PRIME)
        result = np.array(values)
        reciprocal = (
            result if exponent == PRIME - 1 else ResidueSeries(self.rows[:1]).power(-1).rows[0]
        )
        return self.composed(result, product(result[np.newaxis], reciprocal)[0] * exponent % PRIME)


def _root(number: int, degree: int) -> int:
    """A root modulo the prime."""
    while degree % 2 == 0:
        root = pow(number, (PRIME + 1) // 4, PRIME)
        if root * root % PRIME != number % PRIME:
            raise NoRootError("no square root")
        number = root  # the one of both that is a square, and has roots of its own
        degree //= 2
    return pow(number, pow(degree, -1, PRIME - 1), PRIME)


def solved(matrix: list[list[ResidueSeries]], right: list[ResidueSeries]) -> list[ResidueSeries]:
    """The solution of a linear system of series by elimination."""
    n = len(right)
    for k in range(n):
        over = matrix[k][k].power(-1)
        for i in range(n):
            if i != k:
                ratio = (matrix[i][k] * over).scaled(-1)
                matrix[i] = [a + ratio * b for a, b in zip(matrix[i], matrix[k], strict=True)]
                right[i] = right[i] + ratio * right[k]
    return [right[k] * matrix[k][k].power(-1) for k in range(n)]


def without(row: list[int], pivot: list[int], k: int) -> list[int]:
    """A row minus the multiple of the pivot's row that makes its entry `k` vanish."""
    ratio = row[k] * inverse(pivot[k]) % PRIME
    return [(a - ratio * b) % PRIME for a, b in zip(row, pivot, strict=True)]


def echelon(rows: Rows) -> Rows:
    """The reduced echelon form without rows of zeros, modulo the prime."""
    rows, result = [row for row in rows if any(row)], Rows()
    for k in range(len(rows[0]) if rows else 0):
        pivot = next((row for row in rows if row[k]), None)
        if pivot is not None:
            own = inverse(pivot[k])
            pivot = [value * own % PRIME for value in pivot]
            rows = [reduced for row in rows if any(reduced := without(row, pivot, k))]
            result = [*(without(row, pivot, k) for row in result), pivot]
    return result


def null_space(rows: Rows, columns: int) -> Rows:
    """A basis of the solutions of rows · x = 0 in reduced echelon form, modulo the prime."""
    reduced = echelon(rows)
    pivots = [next(k for k, value in enumerate(row) if value) for row in reduced]
    basis: Rows = []
    for free in (k for k in range(columns) if k not in pivots):
        vector = [int(k == free) for k in range(columns)]
        for pivot, row in zip(pivots, reduced, strict=True):
            vector[pivot] = -row[free] % PRIME
        basis.append(vector)
    return echelon(basis)


#: Functions with kinks or jumps.
KINKED = (sp.Abs, sp.sign, sp.Max, sp.Min, sp.Piecewise)


class Evaluation:
    """Series of SymPy expressions at one random point; equal subexpressions are evaluated once.

    `known` are the series of symbols; `point` has the values of transcendental functions, which an
    evaluation with longer series takes over.
    """

    def __init__(self, known: Mapping[sp.Basic, ResidueSeries], point: "RandomResidues") -> None:
        self._known, self._point = dict(known), point
        self._shape = next(iter(self._known.values())).rows.shape

    def __call__(self, expression: sp.Basic) -> ResidueSeries:
        """The series of an expression; `NotImplementedError` for an unknown function."""
        if expression not in self._known:
            self._known[expression] = self._value(expression)
        return self._known[expression]

    def constant(self, number: int) -> ResidueSeries:
        """The series of a number."""
        rows = np.zeros(self._shape, np.int64)
        rows[0, 0] = number % PRIME
        return ResidueSeries(rows)

    def _value(self, expression: sp.Basic) -> ResidueSeries:
        match expression:
            case sp.Add() | sp.Mul():
                first, *others = map(self, expression.args)
                for other in others:
                    first = first + other if expression.is_Add else first * other
                return first
            case sp.NumberSymbol() | sp.Pow(base=sp.Rational()):  # a root of a number
                return self.constant(self._point.residue(expression))
            case sp.Pow(base=base, exp=sp.Float() | sp.Rational() as exponent):
                exponent = sp.Rational(str(exponent))
                return self(base).power(exponent.p, exponent.q)
            case sp.Pow(base=base, exp=exponent):
                return self._exponential(exponent * sp.log(base))
            case sp.Float() | sp.Rational():
                number = sp.Rational(str(expression))
                return self.constant(number.p * inverse(number.q))
            case sp.exp():
                return self._exponential(expression.args[0])
            case sp.sin() | sp.cos():
                waves = self._waves(expression.args[0])
                return waves[isinstance(expression, sp.cos)]
            case sp.tan():
                sine, cosine = self._waves(expression.args[0])
                return sine * cosine.power(-1)
            case sp.sinh() | sp.cosh() | sp.tanh():
                return self(expression.rewrite(sp.exp))
            case sp.log() | sp.atan():
                return self._integral(expression)
            case sp.atan2():
                return self(sp.atan(expression.args[0] / expression.args[1]))
            case sp.Abs():
                return self(expression.args[0]).scaled(self._point.sign(expression.args[0]))
            case sp.sign():
                return self.constant(self._point.sign(expression.args[0]))
            case sp.Max() | sp.Min() | sp.Piecewise():
                return self(self._point.choice(expression))
        raise NotImplementedError(f"{type(expression).__name__} has no series of residues")

    def _exponential(self, exponent: sp.Expr) -> ResidueSeries:
        result = self.constant(1)
        for term in sp.Add.make_args(sp.expand_mul(exponent)):
            number, rest = term.as_coeff_Mul()
            number = sp.Rational(str(number))
            base = sp.exp(rest / number.q, evaluate=False)
            if base not in self._known:
                u = self(rest / number.q).rows[0].tolist()
                values = [self._point.residue(base)]
                for k in range(1, len(u)):  # f' = u' f
                    terms = (j * u[j] * values[k - j] for j in range(1, k + 1))
                    values.append(sum(terms) * inverse(k) % PRIME)
                array = np.array(values)
                self._known[base] = self(rest / number.q).composed(array, array)
            result = result * self._known[base].power(number.p)
        return result

    def _waves(self, angle: sp.Expr) -> tuple[ResidueSeries, ResidueSeries]:
        """Sine and cosine."""
        sine, cosine = self.constant(0), self.constant(1)
        for term in sp.Add.make_args(sp.expand_mul(angle)):
            number, rest = term.as_coeff_Mul()
            half = sp.Rational(str(number)) * 2
            one = self._half_waves(rest / (2 * half.q))
            if half.p < 0:
                one = one[0].scaled(-1), one[1]
            for _ in range(abs(half.p)):
                sine, cosine = (
                    sine * one[1] + cosine * one[0],
                    cosine * one[1] + (sine * one[0]).scaled(-1),
                )
        return sine, cosine

    def _half_waves(self, angle: sp.Expr) -> tuple[ResidueSeries, ResidueSeries]:
        key = sp.sin(angle, evaluate=False), sp.cos(angle, evaluate=False)
        if key[0] not in self._known:
            argument, parameter = self(angle), self._point.residue(key[0])
            over = inverse(1 + parameter * parameter)
            s, c = [2 * parameter * over % PRIME], [(1 - parameter * parameter) * over % PRIME]
            u = argument.rows[0].tolist()
            for k in range(1, len(u)):  # s' = u' c, c' = -u' s
                own = inverse(k)
                pairs = [(j * u[j], k - j) for j in range(1, k + 1)]
                s.append(sum(slope * c[i] for slope, i in pairs) * own % PRIME)
                c.append(-sum(slope * s[i] for slope, i in pairs) * own % PRIME)
            sine, cosine = np.array(s), np.array(c)
            self._known[key[0]] = argument.composed(sine, cosine)
            self._known[key[1]] = argument.composed(cosine, -sine % PRIME)
        return self._known[key[0]], self._known[key[1]]

    def _integral(self, expression: sp.Expr) -> ResidueSeries:
        """A function whose derivative is a rational function of its argument."""
        u = expression.args[0]
        slope = self(1 / u if isinstance(expression, sp.log) else 1 / (1 + u**2)).rows[0]
        argument = self(u)
        n = np.arange(len(slope))
        rate = product((argument.rows[:1] * n % PRIME)[:, 1:], slope[:-1])[0]
        orders = [inverse(int(k)) for k in n[1:]]
        values = np.array([self._point.residue(expression), *(rate * orders % PRIME)])
        return argument.composed(values, slope)


class RandomResidues:
    """Random residues, the same for equal keys, and the `branches` of functions with kinks.

    A function that is not in `branches` has its first branch: the first argument, or a positive
    sign of the argument.
    """

    def __init__(self, seed: int, branches: Mapping[sp.Basic, int] | None = None) -> None:
        self._random, self._branches = Random(seed), branches or {}
        self._residues: dict[object, int] = {}

    def residue(self, key: object) -> int:
        """A residue."""
        return self._residues.setdefault(key, self._random.randint(2, PRIME - 2))

    def sign(self, argument: sp.Expr) -> int:
        """1 or -1, opposite for opposite arguments."""
        if argument.could_extract_minus_sign():
            return -self.sign(-argument)
        return 1 - 2 * self._branches.get(argument, 0)

    def choice(self, function: sp.Basic) -> sp.Basic:
        """One of the arguments."""
        chosen = function.args[self._branches.get(function, 0)]
        return chosen[0] if isinstance(function, sp.Piecewise) else chosen


def branches(expressions: Iterable[sp.Basic]) -> Iterator[dict[sp.Basic, int]]:
    """Choices of branches: the first of all functions, then each other branch of one of them."""
    whole = sp.Tuple(*expressions)
    yield {}
    for function in sorted(whole.atoms(*KINKED), key=sp.default_sort_key):
        if isinstance(function, sp.Abs | sp.sign):
            argument = function.args[0]
            yield {-argument if argument.could_extract_minus_sign() else argument: 1}
        else:
            yield from ({function: k} for k in range(1, len(function.args)))
