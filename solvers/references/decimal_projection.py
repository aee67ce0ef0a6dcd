"""States on the manifold of constraints, in decimal numbers of any length."""

from collections.abc import Sequence
from decimal import Decimal
from functools import partial

from solvers.equations.forms import Form
from solvers.equations.module import function, integrals, named, with_functions
from solvers.references.exact_literals import with_exact_literals
from solvers.references.power_series import PowerSeries
from solvers.references.series_functions import series_functions

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
