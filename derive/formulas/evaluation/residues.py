"""Residues modulo a prime: power series with derivatives, and rows of linear equations."""

from typing import TypeAlias

import numpy as np
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
        # of both roots, the one that is a square has roots of its own
        number = root if pow(root, (PRIME - 1) // 2, PRIME) == 1 else PRIME - root
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
