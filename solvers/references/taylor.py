"""Motions by Taylor series in decimal numbers of any length.

A generated module's right-hand side accepts power series: sums, products and quotients are theirs,
and elementary functions are replaced by those of series. Nothing numerical is shared with
Runge–Kutta methods. States with constraints are projected onto their manifold.
"""

from collections.abc import Callable, Sequence
from decimal import Decimal, localcontext
from functools import partial, reduce
from math import inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.forms import Form, fastest_form
from solvers.equations.module import GeneratedModule, function, integrals, named, with_functions
from solvers.references.decimal_numbers import decimal_state, with_exact_literals
from solvers.references.power_series import PowerSeries, series_functions

#: Steps of Newton's method: from a start in doubles, residuals have 16, 32, 64 ... digits.
STEPS = 4


class DecimalProjection:
    """Steps onto the constraints of a form, whose correction is evaluated as series of order 0."""

    def __init__(self, form: Form, params: Sequence[float]) -> None:
        self._form, self._tape = form, list[PowerSeries]()
        self._time = PowerSeries(self._tape, [])
        self._state = [PowerSeries(self._tape, []) for _ in form.state]
        constants = [*map(partial(PowerSeries.number, self._tape), params)]
        self._kept = [PowerSeries(self._tape, []) for _ in integrals(form.module)]
        self._integrals = []
        if self._kept:
            self._integrals = self._series(named("integrals", form.name), constants)
        self._changes = self._series(form.correction, [*constants, *self._kept])

    def _series(self, name: str, params: Sequence[PowerSeries]) -> list[PowerSeries]:
        """The results of a function of the module."""
        number = partial(PowerSeries.number, self._tape)
        exact = with_exact_literals(function(self._form.module, name), number)
        results = with_functions(exact, series_functions(self._tape, []))(
            self._time, self._state, params
        )
        return [one if isinstance(one, PowerSeries) else number(one) for one in results]

    def keep_integrals(self, t: Decimal, state: Sequence[Decimal]) -> None:
        """Keep the values of integrals at this state of the form."""
        for one in self._kept:
            one.coefficients[:] = [Decimal(0)]
        values = self._at(t, state[: len(self._form.state)], self._integrals)
        for one, value in zip(self._kept, values, strict=True):
            one.coefficients[:] = [value]

    def __call__(self, t: Decimal, state: Sequence[Decimal]) -> list[Decimal]:
        """The state of the form, followed by its angles, moved onto the constraints."""
        result, size = [*state], len(self._form.state)
        for _ in range(STEPS):
            changes = self._at(t, result[:size], self._changes)
            for k, i in self._form.shared_columns:
                result[i] += changes[k]
            for a, (k, i) in enumerate(self._form.angle_columns):
                sine = result[i] + changes[k] * result[i + 1]
                cosine = result[i + 1] - changes[k] * result[i]
                length = (sine * sine + cosine * cosine).sqrt()
                result[i], result[i + 1] = sine / length, cosine / length
                result[size + a] += changes[k]
        return result

    def _at(
        self, t: Decimal, state: Sequence[Decimal], results: Sequence[PowerSeries]
    ) -> list[Decimal]:
        for series in self._tape:
            series.coefficients.clear()
        self._time.coefficients[:] = [t]
        for one, value in zip(self._state, state, strict=True):
            one.coefficients[:] = [value]
        for series in self._tape:
            series.extend(0)
        return [one.at(0) for one in results]


Array = NDArray[np.float64]

#: Digits computed in addition to those requested.
GUARD = 6
#: The shortest step, in units of the spacing of floating-point times.
SHORTEST = 10


class SeriesError(ArithmeticError):
    """A motion cannot be continued by series; the message states time, state and reason."""


def taylor(
    module: GeneratedModule,
    params: Sequence[float],
    y0: Sequence[float],
    times: ArrayLike,
    digits: int = 32,
    max_products: float = inf,
    progress: Callable[[float], None] = lambda t: None,
) -> Array:
    """States (q, q̇) at `times` by Taylor series; the state at the first of them is `y0`.

    Parameters
    ----------
    module : module
        A generated module.
    params, y0 : sequence of float
        In the order of ``module.PARAMETERS`` and ``module.STATE``, taken as exact, as are the
        digits of literals in the module.
    times : array_like of shape (n,)
        Increasing or decreasing, in s.
    digits : int
        A step neglects terms beyond this many digits of the state; rounding errors are smaller.
    max_products : float
        Most products of coefficients, of which a second computes some ten million.
    progress : callable
        Called with the time in s after every step; an exception that it raises ends the series.

    Returns
    -------
    ndarray of shape (n, state)
        The states, rounded to floats at the end. Those of systems with constraints, the first one
        too, are moved onto these.

    Raises
    ------
    SeriesError
        When the equations are not finite at a state, such as the logarithm of a negative number;
        at a kink or a jump, such as that of ``abs(x)`` at 0, beyond which a series is not valid;
        when steps are below the resolution of time, as before a collision; when `max_products`
        do not suffice.

    Notes
    -----
    Order and step follow À. Jorba and M. Zou, A software package for the numerical
    integration of ODEs by means of high-order Taylor methods, Experimental Mathematics 14
    (2005): order -ln(ε)/2 + 1, and 1/e² of the distance to the nearest singularity.
    """
    states = decimal_motion(module, params, y0, times, digits, max_products, progress)
    return np.array(states, dtype=float)


def decimal_motion(
    module: GeneratedModule,
    params: Sequence[float],
    y0: Sequence[float],
    times: ArrayLike,
    digits: int = 32,
    max_products: float = inf,
    progress: Callable[[float], None] = lambda t: None,
) -> list[list[Decimal]]:
    """The states of `taylor` with all their digits."""
    samples = [Decimal(float(t)) for t in np.asarray(times, dtype=float)]
    with localcontext(prec=digits + GUARD):
        motion = _TaylorMotion(module, params, y0, samples[0])
        order = int(digits * 2.302585 / 2) + 2
        t, h, states, products = samples[0], Decimal(0), [], 0
        shortest = SHORTEST * float(np.spacing(max(abs(float(t)) for t in samples)))
        for sample in samples:
            while abs(sample - t) > h:
                if h:
                    step = h.copy_sign(sample - t)
                    motion.check_choices(step)
                    t += step
                    motion.restart(t, motion.state_after(step))
                    progress(float(t))
                products += motion.size * order * order // 2
                if products > max_products:
                    reason = f"series of {digits} digits take more than {max_products:g} products"
                    raise motion.error(reason)
                try:
                    h = motion.expand(order)
                except ArithmeticError as error:
                    raise motion.error("the equations are not finite") from error
                if h < shortest and abs(sample - t) > h:
                    raise motion.error("a step is below the resolution of time, at a singularity")
            motion.check_choices(sample - t)
            states.append(motion.ordinary_after(sample - t))
    return states


class _TaylorMotion:
    """A motion as power series of its state about the current time.

    The state is that of the fastest form, followed by the angles, whose derivatives are velocities
    in that state. Time is a series, too: t₀ + x.
    """

    def __init__(
        self, module: GeneratedModule, params: Sequence[float], y0: Sequence[float], start: Decimal
    ) -> None:
        form = Form(module, fastest_form(module), (0.0,) * len(module.PARAMETERS))
        half, self._tape = len(module.COORDINATES), list[PowerSeries]()
        self._time = PowerSeries(self._tape, [])
        self._state = [PowerSeries(self._tape, []) for _ in form.state]
        constants = [PowerSeries.number(self._tape, p) for p in params]
        exact = with_exact_literals(form.function, partial(PowerSeries.number, self._tape))
        self._switches = list[PowerSeries]()
        function = with_functions(exact, series_functions(self._tape, self._switches))
        rates = function(self._time, self._state, constants)
        self._rates = [
            r if isinstance(r, PowerSeries) else PowerSeries.number(self._tape, r) for r in rates
        ]
        columns = dict(form.shared_columns)
        for k, _ in form.angle_columns:
            columns[k] = len(self._state)
            self._rates.append(self._state[columns[half + k]])
            self._state.append(PowerSeries(self._tape, []))
        self._columns = [columns[k] for k in range(2 * half)]
        self._project = DecimalProjection(form, params) if form.has_constraints else None
        state = decimal_state(form, y0)
        if self._project:
            self._project.keep_integrals(start, state)
        self.restart(start, state)

    def restart(self, t: Decimal, state: Sequence[Decimal]) -> None:
        """Discard all coefficients and continue from this time and state, on the constraints."""
        state = self._project(t, state) if self._project else state
        for series in self._tape:
            series.coefficients.clear()
        self._time.coefficients[:] = [t]
        for series, value in zip(self._state, state, strict=True):
            series.coefficients[:] = [value]

    @property
    def size(self) -> int:
        """Number of series."""
        return len(self._tape)

    def error(self, reason: str) -> SeriesError:
        """The error for a motion that stops at the current time for a reason."""
        state = ", ".join(f"{self._state[k].at(0):.6g}" for k in self._columns)
        return SeriesError(f"{reason} (t = {self._time.at(0):.10g}, y = {state})")

    def ordinary_after(self, h: Decimal) -> list[Decimal]:
        """Coordinates and velocities after `h`, at most a step."""
        state = self.state_after(h)
        state = self._project(self._time.at(0) + h, state) if self._project else state
        return [state[k] for k in self._columns]

    def expand(self, order: int) -> Decimal:
        """Compute the series up to `order`; return the length of a step."""
        for k in range(order):
            for series in self._tape:
                series.extend(k)
            self._time.coefficients.append(Decimal(0 if k else 1))
            for series, rate in zip(self._state, self._rates, strict=True):
                series.coefficients.append(rate.at(k) / (k + 1))

        sizes = [max(abs(s.at(k)) for s in self._state) for k in range(order + 1)]
        # a state of zeros may leave it: the first coefficient that is not zero counts
        first = next((k for k, size in enumerate(sizes) if size), order)
        radii = [
            ((sizes[first] / sizes[k]).ln() / (k - first)).exp()
            if first < k and sizes[k]
            else Decimal(1)
            for k in (order - 1, order)
        ]
        return min(radii) / Decimal(2).exp()

    def state_after(self, h: Decimal) -> list[Decimal]:
        """The state after `h`."""
        return [_sum(series, h) for series in self._state]

    def check_choices(self, h: Decimal) -> None:
        """Raise `SeriesError` if a choice in the equations is another one after `h`."""
        if any((_sum(s, h) > 0) != (s.at(0) > 0) for s in self._switches):
            raise self.error("the equations have a kink or a jump in the next step")


def _sum(series: PowerSeries, h: Decimal) -> Decimal:
    """The sum of a series at `h`, by Horner's rule."""
    return reduce(lambda value, c: value * h + c, reversed(series.coefficients), Decimal(0))
