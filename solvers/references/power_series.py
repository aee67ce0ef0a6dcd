"""Power series whose coefficients are computed one order at a time, and their functions.

A function of sums, products and quotients, called once with series, records a tape of operations;
each order follows from the lower ones (A. Griewank, A. Walther, Evaluating Derivatives, 13.2 and
table 13.2).
"""

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from math import atan2
from operator import mul
from typing import TypeAlias

from solvers.references.decimal_numbers import sine_and_cosine

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


#: A function of series and numbers.
SeriesFunction = Callable[..., PowerSeries]


def series_functions(tape: Tape, switches: "Tape | None" = None) -> dict[str, SeriesFunction]:
    """The functions that generated code calls, by name; they record their operations on `tape`.

    Series on whose signs choices depend are appended to `switches`; they are valid as long as the
    signs stay as they are at 0.
    """
    circular: dict[PowerSeries, tuple[PowerSeries, PowerSeries]] = {}

    def sine_cosine(x: PowerSeries | float) -> tuple[PowerSeries, PowerSeries]:
        x = as_series(x)
        if x not in circular:
            circular[x] = _sine_and_cosine(x)
        return circular[x]

    def as_series(x: PowerSeries | float) -> PowerSeries:
        return x if isinstance(x, PowerSeries) else PowerSeries.number(tape, x)

    def tan(x: PowerSeries | float) -> PowerSeries:
        sine, cosine = sine_cosine(x)
        return sine / cosine

    def hyperbolic(x: PowerSeries | float) -> tuple[PowerSeries, PowerSeries]:
        power = _exp(as_series(x))
        return (power - 1 / power) / 2, (power + 1 / power) / 2

    def tanh(x: PowerSeries | float) -> PowerSeries:
        sine, cosine = hyperbolic(x)
        return sine / cosine

    def power(base: PowerSeries | float, exponent: PowerSeries | float) -> PowerSeries:
        base, exponent = as_series(base), as_series(exponent)
        if base.constant and exponent.constant:
            return PowerSeries.number(tape, base.at(0) ** exponent.at(0))
        return _exp(exponent * _log(base))

    def select(
        s: PowerSeries | float, a: PowerSeries | float, b: PowerSeries | float
    ) -> PowerSeries:
        s, a, b = map(as_series, (s, a, b))
        if s.constant:
            return a if s.at(0) > 0 else b
        if switches is not None:
            switches.append(s)
        return PowerSeries(tape, [], lambda k: (a if s.at(0) > 0 else b).at(k))

    return {
        "sin": lambda x: sine_cosine(x)[0],
        "cos": lambda x: sine_cosine(x)[1],
        "tan": tan,
        "exp": lambda x: _exp(as_series(x)),
        "log": lambda x: _log(as_series(x)),
        "sqrt": lambda x: _sqrt(as_series(x)),
        "sinh": lambda x: hyperbolic(x)[0],
        "cosh": lambda x: hyperbolic(x)[1],
        "tanh": tanh,
        "atan": lambda x: _angle(as_series(x), as_series(1.0)),
        "atan2": lambda y, x: _angle(as_series(y), as_series(x)),
        "pow": power,
        "select": select,
    }


def _sine_and_cosine(x: PowerSeries) -> tuple[PowerSeries, PowerSeries]:
    """From (sin x)' = x' cos x and (cos x)' = -x' sin x."""
    tape = x.tape
    if x.constant:
        first, second = sine_and_cosine(x.at(0))
        return PowerSeries.number(tape, first), PowerSeries.number(tape, second)
    rate, sine, cosine = _rate(x), PowerSeries(tape, []), PowerSeries(tape, [])

    def coefficient_of_sine(k: int) -> Decimal:
        return _integrated(rate, cosine, k) if k else sine_and_cosine(x.at(0))[0]

    def coefficient_of_cosine(k: int) -> Decimal:
        return -_integrated(rate, sine, k) if k else sine_and_cosine(x.at(0))[1]

    return _recorded(sine, coefficient_of_sine), _recorded(cosine, coefficient_of_cosine)


def _exp(x: PowerSeries) -> PowerSeries:
    """From (exp x)' = x' exp x."""
    if x.constant:
        return PowerSeries.number(x.tape, x.at(0).exp())
    rate, power = _rate(x), PowerSeries(x.tape, [])
    return _recorded(power, lambda k: _integrated(rate, power, k) if k else x.at(0).exp())


def _log(x: PowerSeries) -> PowerSeries:
    """From x (log x)' = x'."""
    if x.constant:
        return PowerSeries.number(x.tape, x.at(0).ln())
    return _quotient_integrated(_rate(x), x, lambda: x.at(0).ln())


def _angle(y: PowerSeries, x: PowerSeries) -> PowerSeries:
    """From (x² + y²) a' = x y' - y x'."""
    if x.constant and y.constant:
        return PowerSeries.number(x.tape, _atan2(y.at(0), x.at(0)))
    rate = (x * _rate(y)) - (y * _rate(x))
    return _quotient_integrated(rate, x * x + y * y, lambda: _atan2(y.at(0), x.at(0)))


def _atan2(y: Decimal, x: Decimal) -> Decimal:
    """The angle of (x, y): each correction leaves the cube of its error."""
    angle = Decimal(atan2(y, x))
    for _ in range(4):
        sine, cosine = sine_and_cosine(angle)
        angle += (y * cosine - x * sine) / (x * cosine + y * sine)
    return angle


def _quotient_integrated(
    rate: PowerSeries, other: PowerSeries, first: Callable[[], Decimal]
) -> PowerSeries:
    """The integral of the quotient of `rate` times 1/x and `other`, from `first` on."""
    integral = PowerSeries(other.tape, [])

    def coefficient(k: int) -> Decimal:
        if not k:
            return first()
        lower = map(mul, own.coefficients[1:k], other.coefficients[k - 1 : 0 : -1])
        return (rate.at(k) - sum(lower, ZERO)) / (k * other.at(0))

    _recorded(integral, coefficient)
    own = _rate(integral)
    return integral


def _sqrt(x: PowerSeries) -> PowerSeries:
    """From (√x)² = x."""
    if x.constant:
        return PowerSeries.number(x.tape, x.at(0).sqrt())
    root = PowerSeries(x.tape, [])

    def coefficient(k: int) -> Decimal:
        if not k:
            return x.at(0).sqrt()
        lower = root.coefficients[1:k]
        return (x.at(k) - sum(map(mul, lower, reversed(lower)), ZERO)) / (2 * root.at(0))

    return _recorded(root, coefficient)


def _rate(x: PowerSeries) -> PowerSeries:
    """The derivative of a series times its variable."""
    return PowerSeries(x.tape, [], lambda k: k * x.at(k))


def _integrated(rate: PowerSeries, other: PowerSeries, k: int) -> Decimal:
    """Coefficient k > 0 of the integral of a derivative times `other`, from lower ones of that."""
    return sum(map(mul, rate.coefficients[1 : k + 1], other.coefficients[k - 1 :: -1]), ZERO) / k


def _recorded(series: PowerSeries, next_coefficient: Callable[[int], Decimal]) -> PowerSeries:
    series.next_coefficient = next_coefficient
    series.tape.append(series)
    return series
