"""Power series whose coefficients are known up to some order, and grow by one order at a time.

A function of plain sums, products and quotients, called once with series, leaves a tape of
operations; each order of all of them then follows from the lower ones (A. Griewank, A. Walther,
Evaluating Derivatives, section 13.2).
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from operator import mul
from typing import TypeAlias

#: The operations of a tape: series in the order in which they were made.
Tape: TypeAlias = "list[Series]"
ZERO = Decimal(0)


class Series:
    """Σ coefficients[k] xᵏ, known so far.

    Parameters
    ----------
    tape : list
        Where operations on this series are written; constants are not.
    coefficients : list of Decimal
        Those known so far.
    coefficient : callable, optional
        Gives the next one, of this order; None for a series that is extended by hand.
    constant : bool
        Whether all coefficients but the first are zero.
    """

    def __init__(
        self,
        tape: Tape,
        coefficients: list[Decimal],
        coefficient: Callable[[int], Decimal] | None = None,
        constant: bool = False,
    ) -> None:
        self.tape, self.coefficients, self.constant = tape, coefficients, constant
        self._coefficient = coefficient
        if coefficient:
            tape.append(self)

    @classmethod
    def number(cls, tape: Tape, value: Decimal | float) -> Series:
        """A constant."""
        return cls(tape, [Decimal(value)], constant=True)

    def extend(self, order: int) -> None:
        """Find the coefficient of this order; those below are known."""
        assert self._coefficient
        self.coefficients.append(self._coefficient(order))

    def at(self, order: int) -> Decimal:
        """A coefficient that is known."""
        if self.constant and order:
            return ZERO
        return self.coefficients[order]

    def _of(self, other: Series | float) -> Series:
        return other if isinstance(other, Series) else Series.number(self.tape, other)

    def __add__(self, other: Series | float) -> Series:
        return self._combined(self._of(other), 1)

    def __sub__(self, other: Series | float) -> Series:
        return self._combined(self._of(other), -1)

    def _combined(self, other: Series, sign: int) -> Series:
        if self.constant and other.constant:
            return Series.number(self.tape, self.at(0) + sign * other.at(0))
        return Series(self.tape, [], lambda k: self.at(k) + sign * other.at(k))

    __radd__ = __add__

    def __rsub__(self, other: float) -> Series:
        return self._of(other) - self

    def __neg__(self) -> Series:
        return 0 - self

    def __mul__(self, other: Series | float) -> Series:
        other = self._of(other)
        if self.constant and other.constant:
            return Series.number(self.tape, self.at(0) * other.at(0))
        if other.constant:
            return other * self
        if self.constant:
            factor = self.at(0)
            return Series(self.tape, [], lambda k: factor * other.at(k))
        a, b = self.coefficients, other.coefficients
        return Series(self.tape, [], lambda k: sum(map(mul, a[: k + 1], b[k::-1]), ZERO))

    __rmul__ = __mul__

    def __truediv__(self, other: Series | float) -> Series:
        other = self._of(other)
        if other.constant:
            return self * Series.number(self.tape, 1 / other.at(0))
        a, b, quotient = self, other.coefficients, Series(self.tape, [])

        def coefficient(k: int) -> Decimal:
            return (a.at(k) - sum(map(mul, b[1 : k + 1], quotient.coefficients[::-1]), ZERO)) / b[0]

        quotient._coefficient = coefficient
        self.tape.append(quotient)
        return quotient

    def __rtruediv__(self, other: float) -> Series:
        return self._of(other) / self
