"""Elementary functions of power series.

Each coefficient follows from the lower ones (A. Griewank, A. Walther, Evaluating Derivatives,
table 13.2).
"""

from collections.abc import Callable
from decimal import Decimal
from operator import mul

from solvers.equations.decimal_state import sine_and_cosine
from solvers.references.series import ZERO, Series, Tape

#: A function of a series or a number.
SeriesFunction = Callable[[Series | float], Series]


def series_functions(tape: Tape) -> dict[str, SeriesFunction]:
    """The functions that generated code calls, by name; they record their operations on `tape`."""
    circular: dict[Series, tuple[Series, Series]] = {}

    def sine_cosine(x: Series | float) -> tuple[Series, Series]:
        x = as_series(x)
        if x not in circular:
            circular[x] = _sine_and_cosine(x)
        return circular[x]

    def as_series(x: Series | float) -> Series:
        return x if isinstance(x, Series) else Series.number(tape, x)

    def tan(x: Series | float) -> Series:
        sine, cosine = sine_cosine(x)
        return sine / cosine

    return {
        "sin": lambda x: sine_cosine(x)[0],
        "cos": lambda x: sine_cosine(x)[1],
        "tan": tan,
        "exp": lambda x: _exp(as_series(x)),
        "log": lambda x: _log(as_series(x)),
        "sqrt": lambda x: _sqrt(as_series(x)),
    }


def _sine_and_cosine(x: Series) -> tuple[Series, Series]:
    """From (sin x)' = x' cos x and (cos x)' = -x' sin x."""
    tape = x.tape
    if x.constant:
        first, second = sine_and_cosine(x.at(0))
        return Series.number(tape, first), Series.number(tape, second)
    rate, sine, cosine = _rate(x), Series(tape, []), Series(tape, [])

    def coefficient_of_sine(k: int) -> Decimal:
        return _integrated(rate, cosine, k) if k else sine_and_cosine(x.at(0))[0]

    def coefficient_of_cosine(k: int) -> Decimal:
        return -_integrated(rate, sine, k) if k else sine_and_cosine(x.at(0))[1]

    return _recorded(sine, coefficient_of_sine), _recorded(cosine, coefficient_of_cosine)


def _exp(x: Series) -> Series:
    """From (exp x)' = x' exp x."""
    if x.constant:
        return Series.number(x.tape, x.at(0).exp())
    rate, power = _rate(x), Series(x.tape, [])
    return _recorded(power, lambda k: _integrated(rate, power, k) if k else x.at(0).exp())


def _log(x: Series) -> Series:
    """From x (log x)' = x'."""
    if x.constant:
        return Series.number(x.tape, x.at(0).ln())
    logarithm = Series(x.tape, [])

    def coefficient(k: int) -> Decimal:
        if not k:
            return x.at(0).ln()
        lower = map(mul, rate.coefficients[1:k], x.coefficients[k - 1 : 0 : -1])
        return (x.at(k) - sum(lower, ZERO) / k) / x.at(0)

    _recorded(logarithm, coefficient)
    rate = _rate(logarithm)
    return logarithm


def _sqrt(x: Series) -> Series:
    """From (√x)² = x."""
    if x.constant:
        return Series.number(x.tape, x.at(0).sqrt())
    root = Series(x.tape, [])

    def coefficient(k: int) -> Decimal:
        if not k:
            return x.at(0).sqrt()
        lower = root.coefficients[1:k]
        return (x.at(k) - sum(map(mul, lower, reversed(lower)), ZERO)) / (2 * root.at(0))

    return _recorded(root, coefficient)


def _rate(x: Series) -> Series:
    """The derivative of a series times its variable."""
    return Series(x.tape, [], lambda k: k * x.at(k))


def _integrated(rate: Series, other: Series, k: int) -> Decimal:
    """Coefficient k > 0 of the integral of a derivative times `other`, from lower ones of that."""
    return sum(map(mul, rate.coefficients[1 : k + 1], other.coefficients[k - 1 :: -1]), ZERO) / k


def _recorded(series: Series, next_coefficient: Callable[[int], Decimal]) -> Series:
    series.next_coefficient = next_coefficient
    series.tape.append(series)
    return series
