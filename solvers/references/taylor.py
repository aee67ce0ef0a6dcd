"""Motions by Taylor series in decimal numbers of any length.

The equations are a generated module's rational form, of sums, products and quotients, so that its
function accepts power series. Nothing numerical is shared with Runge–Kutta methods.
"""

from collections.abc import Sequence
from decimal import Decimal, localcontext
from functools import reduce

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.forms import Form, fastest_form
from solvers.equations.module import GeneratedModule, named
from solvers.references.series import Series

Array = NDArray[np.float64]

#: Digits computed in addition to those requested.
GUARD = 6
NO_SERIES = (
    "{} has no Taylor series, since its equations {}: ordinary numbers have to do; ask for less "
    "accuracy or a shorter duration"
)


def taylor(
    module: GeneratedModule,
    params: Sequence[float],
    y0: Sequence[float],
    times: ArrayLike,
    digits: int = 32,
) -> Array:
    """States (q, q̇) at `times` by Taylor series; the state at the first of them is `y0`.

    Parameters
    ----------
    module : module
        A generated module whose equations are rational in sines, cosines and other
        coordinates, and free of time.
    params, y0 : sequence of float
        In the order of ``module.PARAMETERS`` and ``module.STATE``, taken as exact.
    times : array_like of shape (n,)
        Increasing or decreasing, in s.
    digits : int
        A step neglects terms beyond this many digits of the state; rounding errors are smaller.

    Returns
    -------
    ndarray of shape (n, state)
        The states, rounded to floats at the end.

    Raises
    ------
    NoSeriesError
        When the equations call a function, even of parameters only, or depend on time.

    Notes
    -----
    Order and step follow À. Jorba and M. Zou, A software package for the numerical
    integration of ODEs by means of high-order Taylor methods, Experimental Mathematics 14
    (2005): order -ln(ε)/2 + 1, and 1/e² of the distance to the nearest singularity.
    """
    samples = [Decimal(float(t)) for t in np.asarray(times, dtype=float)]
    with localcontext(prec=digits + GUARD):
        motion = _Motion(module, params, y0)
        order = int(digits * 2.302585 / 2) + 2
        states, t = [], samples[0]
        for sample in samples:
            while t != sample:
                h = motion.expand(order)
                left = sample - t
                is_last = abs(left) <= h
                step = left if is_last else h if left > 0 else -h
                t = sample if is_last else t + step
                motion.restart(motion.state_after(step))
            states.append([float(x) for x in motion.ordinary])
    return np.array(states)


class NoSeriesError(ArithmeticError):
    """The equations are not sums, products and quotients of the state alone."""


class _Motion:
    """A motion as power series of its state about the current time.

    The state is that of the fastest form, followed by the angles, whose derivatives are velocities
    in that state.
    """

    def __init__(
        self, module: GeneratedModule, params: Sequence[float], y0: Sequence[float]
    ) -> None:
        form = Form(module, fastest_form(module), (0.0,) * len(module.PARAMETERS))
        half, self._tape = len(module.COORDINATES), list[Series]()
        self._state = [Series(self._tape, []) for _ in form.state]
        constants = [Series.number(self._tape, p) for p in params]
        if named("rhs", form.name) in module.TIMED:
            raise NoSeriesError(NO_SERIES.format(module.SYSTEM, "depend on time"))
        try:
            rates = form.function(0.0, self._state, constants)
        except TypeError:  # of the function, which takes numbers only
            raise NoSeriesError(NO_SERIES.format(module.SYSTEM, "call a function")) from None
        self._rates = [r if isinstance(r, Series) else Series.number(self._tape, r) for r in rates]
        columns = dict(form.shared_columns)
        ordinary = [Decimal(float(y)) for y in y0]
        start = [Decimal(0)] * len(form.state)
        for k, i in form.shared_columns:
            start[i] = ordinary[k]
        for k, i in form.angle_columns:
            start[i], start[i + 1] = sine_and_cosine(ordinary[k])
            columns[k] = len(start)
            start.append(ordinary[k])
            self._rates.append(self._state[columns[half + k]])
            self._state.append(Series(self._tape, []))
        self._columns = [columns[k] for k in range(2 * half)]
        self.restart(start)

    def restart(self, state: Sequence[Decimal]) -> None:
        """Discard all coefficients and continue from this state."""
        for series in self._tape:
            series.coefficients.clear()
        for series, value in zip(self._state, state, strict=True):
            series.coefficients[:] = [value]

    @property
    def ordinary(self) -> list[Decimal]:
        """Coordinates and velocities at the current time."""
        return [self._state[k].at(0) for k in self._columns]

    def expand(self, order: int) -> Decimal:
        """Compute the series up to `order`; return the length of a step."""
        for k in range(order):
            for series in self._tape:
                series.extend(k)
            for series, rate in zip(self._state, self._rates, strict=True):
                series.coefficients.append(rate.at(k) / (k + 1))

        def largest(k: int) -> Decimal:
            return max(abs(series.at(k)) for series in self._state)

        radii = [
            ((largest(0) / last).ln() / k).exp() if (last := largest(k)) else Decimal(1)
            for k in (order - 1, order)
        ]
        return min(radii) / Decimal(2).exp()

    def state_after(self, h: Decimal) -> list[Decimal]:
        """The state after `h`, by Horner's rule."""
        zero = Decimal(0)
        coefficients = (reversed(series.coefficients) for series in self._state)
        return [reduce(lambda value, c: value * h + c, each, zero) for each in coefficients]


def sine_and_cosine(x: Decimal) -> tuple[Decimal, Decimal]:
    """Sine and cosine to the digits of the current context, by the exponential series."""
    with localcontext() as context:
        # terms grow up to eˣ before they decrease
        context.prec += int(abs(x) * Decimal("0.4343")) + 5
        smallest = Decimal(10) ** -context.prec
        sums, term, k = [Decimal(0), Decimal(0)], Decimal(1), 0
        while abs(term) > smallest or k < abs(x):
            sums[k % 2] += term if k % 4 < 2 else -term
            k += 1
            term *= x / k
    cosine, sine = sums
    return +sine, +cosine
