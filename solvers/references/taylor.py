"""Motions by Taylor series in decimal numbers of any length.

The equations are a generated module's rational form: sums, products and quotients only, so
that the generated function itself can be called with power series. Nothing here is shared with
Runge–Kutta methods: neither the numbers, nor the steps, nor the coefficients.
"""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal, localcontext

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.forms import Form, fastest_form
from solvers.equations.module import GeneratedModule
from solvers.references.series import Series, Tape

Array = NDArray[np.float64]

#: Digits that are calculated beyond those that are wanted.
GUARD = 6


def taylor(
    module: GeneratedModule,
    params: Sequence[float],
    y0: Sequence[float],
    times: ArrayLike,
    digits: int = 32,
) -> Array:
    """States (q, q̇) at `times`, the first of which is where `y0` is, by Taylor series.

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
        A step neglects terms that are smaller than this many digits of the state; rounding
        is finer still.

    Returns
    -------
    ndarray of shape (n, state)
        The states, rounded to floats at the very end.

    Raises
    ------
    NoSeriesError
        When the equations call a function, be it of parameters only, or depend on time.

    Notes
    -----
    Order and step follow À. Jorba and M. Zou, A software package for the numerical
    integration of ODEs by means of high-order Taylor methods, Experimental Mathematics 14
    (2005): order -ln(ε)/2 + 1, and 1/e² of the distance to the nearest singularity.
    """
    wanted = [Decimal(float(t)) for t in np.asarray(times, dtype=float)]
    with localcontext() as context:
        context.prec = digits + GUARD
        motion = _Motion(module, params, y0)
        order = int(digits * 2.302585 / 2) + 2
        states, t = [], wanted[0]
        for until in wanted:
            while t != until:
                h = motion.reach(order)
                left = until - t
                if abs(left) <= h:
                    states_left = motion.moved(left)
                    t = until
                else:
                    states_left = motion.moved(h if left > 0 else -h)
                    t += h if left > 0 else -h
                motion.begin(states_left)
            states.append([float(x) for x in motion.ordinary])
    return np.array(states)


class NoSeriesError(ArithmeticError):
    """Equations that are more than sums, products and quotients of the state."""


class _Motion:
    """A motion as series of its state about where it is.

    The state is that of the fastest form, followed by the angles, whose slopes are
    velocities that the form holds.

    Parameters
    ----------
    module : module
        A generated module.
    params, y0 : sequence of float
        In the order of ``module.PARAMETERS`` and ``module.STATE``, taken as exact.
    """

    def __init__(
        self, module: GeneratedModule, params: Sequence[float], y0: Sequence[float]
    ) -> None:
        form = Form(module, fastest_form(module), (0.0,) * len(module.PARAMETERS))
        self._half = len(module.COORDINATES)
        self._tape: Tape = []
        self._state = [Series(self._tape, []) for _ in form.state]
        constants = [Series.number(self._tape, p) for p in params]
        name = "rhs" if form.name == "lagrangian" else f"rhs_{form.name}"
        if name in module.TIMED:
            raise self._refusal(module, "depend on time")
        try:
            rates = getattr(module, name)(0.0, self._state, constants)
        except TypeError:  # of the function, which takes numbers only
            raise self._refusal(module, "call a function") from None
        self._rates = [r if isinstance(r, Series) else Series.number(self._tape, r) for r in rates]
        self._places = dict(form.shared_columns)
        start = [Decimal(0)] * len(form.state)
        for k, i in form.shared_columns:
            start[i] = Decimal(float(y0[k]))
        for angle, (k, i) in enumerate(form.angle_columns):
            start[i], start[i + 1] = sine_and_cosine(Decimal(float(y0[k])))
            start.append(Decimal(float(y0[k])))
            self._places[k] = len(form.state) + angle
            self._rates.append(self._state[self._places[self._half + k]])
            self._state.append(Series(self._tape, []))
        self.begin(start)

    @staticmethod
    def _refusal(module: GeneratedModule, why: str) -> NoSeriesError:
        system = module.SYSTEM
        return NoSeriesError(
            f"{system} has no Taylor series, since its equations {why}: ordinary numbers have to "
            "do; ask for less accuracy or a shorter duration"
        )

    def begin(self, state: Sequence[Decimal]) -> None:
        """Series that begin anew at this state."""
        for series in self._tape:
            series.coefficients.clear()
        for series, value in zip(self._state, state, strict=True):
            series.coefficients[:] = [value]

    @property
    def ordinary(self) -> list[Decimal]:
        """Coordinates and velocities where the motion is."""
        return [self._state[self._places[k]].at(0) for k in range(2 * self._half)]

    def reach(self, order: int) -> Decimal:
        """Find the series up to `order`, and the length of a step within which they serve."""
        for k in range(order):
            for series in self._tape:
                series.extend(k)
            for series, rate in zip(self._state, self._rates, strict=True):
                series.coefficients.append(rate.at(k) / (k + 1))
        size = max(abs(series.at(0)) for series in self._state)
        radius = min(
            ((size / last).ln() / k).exp() if last else Decimal(1)
            for k in (order - 1, order)
            for last in [max(abs(series.at(k)) for series in self._state)]
        )
        return radius / Decimal(2).exp()

    def moved(self, h: Decimal) -> list[Decimal]:
        """The state after `h`."""
        state = []
        for series in self._state:
            value = Decimal(0)
            for coefficient in reversed(series.coefficients):
                value = value * h + coefficient
            state.append(value)
        return state


def sine_and_cosine(x: Decimal) -> tuple[Decimal, Decimal]:
    """Sine and cosine to the digits of the current context, by the exponential series."""
    with localcontext() as context:
        # terms grow up to eˣ before they fall
        context.prec += int(abs(x) * Decimal("0.4343")) + 5
        smallest = Decimal(10) ** -context.prec
        sums, term, k = [Decimal(0), Decimal(0)], Decimal(1), 0
        while abs(term) > smallest or k < abs(x):
            sums[k % 2] += term if k % 4 < 2 else -term
            k += 1
            term *= x / k
    cosine, sine = sums
    return +sine, +cosine
