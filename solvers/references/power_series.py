"""Power series whose coefficients are computed one order at a time.

A function of sums, products and quotients, called once with series, records a tape of operations;
each order follows from the lower ones (A. Griewank, A. Walther, Evaluating Derivatives, 13.2).
"""

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from operator import mul
from typing import TypeAlias

#: The operations of a function: series in the order of their evaluation.
Tape: TypeAlias = "list[PowerSeries]"
ZERO = Decimal(0)


@dataclass(eq=False, repr=False)
class PowerSeries:
    """Σ coefficients[k] xᵏ, up to the order computed so far."""

    tape: Tape
    coefficients: list[Decimal]
    next_coefficient: Callable[[int], Decimal] | None = None  # None: extended from outside
    constant: bool = False

    def __post_init__(self) -> None:
        if self.next_coefficient:
            self.tape.append(self)

    @classmethod
    def number(cls, tape: Tape, value: Decimal | float) -> "PowerSeries":
        """A constant."""
        return cls(tape, [Decimal(value)], constant=True)

    def extend(self, order: int) -> None:
        """Compute the coefficient of this order from those below."""
        assert self.next_coefficient
        self.coefficients.append(self.next_coefficient(order))

    def at(self, order: int) -> Decimal:
        """A computed coefficient."""
        return ZERO if self.constant and order else self.coefficients[order]

    def _series(self, other: "PowerSeries | float") -> "PowerSeries":
        return other if isinstance(other, PowerSeries) else PowerSeries.number(self.tape, other)

    def __add__(self, other: "PowerSeries | float") -> "PowerSeries":
        return self._combined(self._series(other), 1)

    def __sub__(self, other: "PowerSeries | float") -> "PowerSeries":
        return self._combined(self._series(other), -1)

    def _combined(self, other: "PowerSeries", sign: int) -> "PowerSeries":
        if self.constant and other.constant:
            return PowerSeries.number(self.tape, self.at(0) + sign * other.at(0))
        return PowerSeries(self.tape, [], lambda k: self.at(k) + sign * other.at(k))

    __radd__ = __add__

    def __rsub__(self, other: float) -> "PowerSeries":
        return self._series(other) - self

    def __neg__(self) -> "PowerSeries":
        return 0 - self

    def __mul__(self, other: "PowerSeries | float") -> "PowerSeries":
        other = self._series(other)
        if self.constant and other.constant:
            return PowerSeries.number(self.tape, self.at(0) * other.at(0))
        if other.constant:
            return other * self
        if self.constant:
            factor = self.at(0)
            return PowerSeries(self.tape, [], lambda k: factor * other.at(k))
        a, b = self.coefficients, other.coefficients
        return PowerSeries(self.tape, [], lambda k: sum(map(mul, a[: k + 1], b[k::-1]), ZERO))

    __rmul__ = __mul__

    def __truediv__(self, other: "PowerSeries | float") -> "PowerSeries":
        other = self._series(other)
        if other.constant:
            return self * PowerSeries.number(self.tape, 1 / other.at(0))
        a, b, quotient = self, other.coefficients, PowerSeries(self.tape, [])

        def coefficient(k: int) -> Decimal:
            return (a.at(k) - sum(map(mul, b[1 : k + 1], quotient.coefficients[::-1]), ZERO)) / b[0]

        quotient.next_coefficient = coefficient
        self.tape.append(quotient)
        return quotient

    def __rtruediv__(self, other: float) -> "PowerSeries":
        return self._series(other) / self
