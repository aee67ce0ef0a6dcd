"""Initial states in decimal numbers of any length, with sine and cosine of their angles."""

from collections.abc import Sequence
from decimal import Decimal, localcontext
from functools import cache

from solvers.equations.forms import Form


def decimal_state(form: Form, y0: Sequence[float]) -> list[Decimal]:
    """The state of a form, followed by the angles that it knows by sine and cosine.

    `y0` is an ordinary state, taken as exact; digits are those of the current context.
    """
    ordinary = [Decimal(float(y)) for y in y0]
    state = [Decimal(0)] * len(form.state)
    for k, i in form.shared_columns:
        state[i] = ordinary[k]
    for k, i in form.angle_columns:
        state[i], state[i + 1] = sine_and_cosine(ordinary[k])
    return [*state, *(ordinary[k] for k, _ in form.angle_columns)]


def sine_and_cosine(x: Decimal) -> tuple[Decimal, Decimal]:
    """Sine and cosine to the digits of the current context, by the exponential series."""
    with localcontext() as context:
        # digits that the reduction takes, and that terms up to exp π take
        context.prec += max(x.adjusted(), 0) + 5
        turn = 2 * _pi(context.prec)
        x = x - turn * (x / turn).to_integral_value()
        smallest = Decimal(10) ** -context.prec
        sums, term, k = [Decimal(0), Decimal(0)], Decimal(1), 0
        while abs(term) > smallest or k < abs(x):
            sums[k % 2] += term if k % 4 < 2 else -term
            k += 1
            term *= x / k
    cosine, sine = sums
    return +sine, +cosine


@cache
def _pi(digits: int) -> Decimal:
    """π by the arithmetic-geometric mean (R. P. Brent, E. Salamin, 1976)."""
    with localcontext(prec=digits + 5):
        a, b, t, power = Decimal(1), Decimal("0.5").sqrt(), Decimal("0.25"), 1
        while a - b > Decimal(10) ** -digits:
            mean = (a + b) / 2
            b, t, power = (a * b).sqrt(), t - power * (a - mean) ** 2, 2 * power
            a = mean
        return (a + b) ** 2 / (4 * t)
