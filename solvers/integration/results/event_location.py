"""States within a step, and the times of events there.

The polynomial over the step has zeros between which an event occurs at most once. In each such part
two or three shorter steps near the estimate of the polynomial make the bracket so narrow that a
cubic gives all other states. The compiled loop does the same in ``compiled/c/event_polynomials.h``,
``roots.h`` and ``event_location.h``.
"""

from collections.abc import Callable, Iterable
from itertools import pairwise
from typing import NamedTuple, Protocol

import numpy as np
import scipy
from numpy.polynomial.chebyshev import (
    chebder,
    chebfit,
    chebpts1,
    chebpts2,
    chebroots,
    chebtrim,
    chebval,
    chebvander,
)

from solvers.equations.forms import Form
from solvers.runge_kutta.continuous_extension import bernstein_values
from solvers.runge_kutta.stepper import Array

#: States at several times, in columns.
Curve = Callable[[Array], Array]
Event = Callable[[float, Array], float]


class StepStates(Protocol):
    """States within a step; they raise `ArithmeticError` where they cannot be computed."""

    def state(self, t: float, /) -> Array:
        """The state at a time."""

    def states(self, times: Array, /) -> Array:
        """The states at several times, in columns."""

    def between(self, begin: float, y0: Array, end: float, y1: Array, /) -> Curve:
        """States between those at two near times."""

    def curves(self) -> Iterable[Curve]:
        """Approximations of the states, each better than the one before."""


class OrdinaryStates:
    """Ordinary states within a step from time `t` and state `y`; states are computed once."""

    def __init__(self, form: Form, t: float, y: Array, step: StepStates) -> None:
        self._form, self._t, self._y, self._step = form, t, y, step
        self._known: dict[float, Array] = {}

    def _state(self, time: float) -> Array:
        if time not in self._known:
            self._known[time] = self._step.state(time)
        return self._known[time]

    def at(self, time: float) -> Array:
        """The state at a time."""
        if time == self._t:
            return self._y.copy()
        return self._form.to_ordinary(time, self._state(time), self._y, time - self._t)

    def between(self, begin: float, end: float) -> Callable[[float], Array]:
        """The state at a time between two near times."""
        curve = self._step.between(begin, self._state(begin), end, self._state(end))

        def at(time: float) -> Array:
            if time not in self._known:
                self._known[time] = curve(np.array([time]))[:, 0]
            return self.at(time)

        return at

    def along(self, curve: Curve, times: Array) -> Array:
        """The states at several times of a curve, in columns."""
        return self._form.to_ordinary(times, curve(times), self._y, times - self._t)


class EventCourse:
    """Values of an event within a step."""

    def __init__(self, event: Event, states: OrdinaryStates) -> None:
        self._event, self._states = event, states

    def at(self, time: float) -> float:
        """The value at a time."""
        return self._event(time, self._states.at(time))

    def between(self, begin: float, end: float) -> Callable[[float], float]:
        """The value at a time between two near times."""
        state = self._states.between(begin, end)
        return lambda time: self._event(time, state(time))


#: In a bracket that is this part of a step, the cubic by the states and derivatives at its ends is
#: exact but for rounding errors.
NARROW = 2e-4
#: Shorter steps aim this part of a step beyond the event, so that two of them may suffice.
BEYOND = 2e-5
#: Most evaluations, and most of them that are aimed by slopes.
MOST, MOST_AIMED = 100, 6
#: Error of the estimate, in parts of a step.
CLOSE = 2.0**-24


class TimeEstimate(NamedTuple):
    """The estimated time of an event, and the rate at which its value changes there."""

    time: float = np.nan
    rate: float = 0.0


class Bracket(NamedTuple):
    """Two times of a step of size h, the first before an event and the other not, with values."""

    near: float
    near_value: float
    far: float
    far_value: float
    h: float

    @property
    def is_narrow(self) -> bool:
        """Whether a cubic is exact within it."""
        return abs(self.far - self.near) <= NARROW * abs(self.h)

    @property
    def resolution(self) -> float:
        """Times that differ by less are equal."""
        return 4 * float(np.spacing(max(abs(self.near), abs(self.far))))

    def next_time(self, aim: float, count: int) -> float:
        """The time to evaluate: the aim if it is inside, else by regula falsi or bisection."""
        x, u, y, v, _ = self
        if not (aim - x) * (y - aim) > 0:
            aim = (x * v - y * u) / (v - u) if count < MOST / 2 and v else (x + y) / 2
        low, high = sorted((x, y))
        return min(max(aim, low + self.resolution), high - self.resolution)


def estimate(polynomial: Array, begin: float, bracket: Bracket) -> TimeEstimate:
    """The zero in a bracket of a polynomial, by Chebyshev coefficients over the step."""
    h = bracket.h
    near, far = (2 * (time - begin) / h - 1 for time in (bracket.near, bracket.far))
    if not chebval(near, polynomial) * chebval(far, polynomial) < 0:
        return TimeEstimate()
    x = scipy.optimize.brentq(chebval, near, far, args=(polynomial,), xtol=CLOSE)
    rate = 2 * float(chebval(x, chebder(polynomial))) / h
    return TimeEstimate(begin + h * (x + 1) / 2, rate)


def locate(bracket: Bracket, guess: TimeEstimate, course: EventCourse) -> float:
    """The first time not before the event, but for rounding errors."""
    (aim, rate), side, last = guess, 0, None
    value: Callable[[float], float] = course.at
    is_narrow = False
    for count in range(MOST):
        if abs(bracket.far - bracket.near) <= 2 * bracket.resolution:
            break
        if bracket.is_narrow and not is_narrow:
            value, aim, side = course.between(bracket.near, bracket.far), np.nan, 0
            is_narrow = True
        time = bracket.next_time(aim, count)
        new = value(time)
        is_before = new != 0 and np.sign(new) == np.sign(bracket.near_value)
        # the value at an end that stays is halved (M. Dowell, P. Jarratt, BIT 11 (1971) 168-174)
        if is_before:
            factor = 0.5 if side < 0 else 1.0
            bracket = bracket._replace(
                near=time, near_value=new, far_value=factor * bracket.far_value
            )
        else:
            factor = 0.5 if side > 0 else 1.0
            bracket = bracket._replace(
                far=time, far_value=new, near_value=factor * bracket.near_value
            )
        side = -1 if is_before else 1
        rate = (new - last[1]) / (time - last[0]) if last else rate
        last = time, new
        aim = np.nan
        if rate and count < MOST_AIMED and not is_narrow:
            other_side = np.sign(bracket.h) * (1 if is_before else -1)
            shift = -new / rate
            aim = time + shift + other_side * (BEYOND * abs(bracket.h) + 0.1 * abs(shift))
    return bracket.far


#: Degrees of the polynomials that decide whether an event may recur in a step, and where.
ROUGH_DEGREE, DEGREE = 8, 24
#: Parts of a step at which the first one is known.
ROUGH_NODES = (chebpts2(ROUGH_DEGREE + 1) + 1) / 2
TO_BERNSTEIN = np.linalg.inv(bernstein_values(ROUGH_DEGREE, ROUGH_NODES))
TO_CHEBYSHEV = np.linalg.inv(chebvander(2 * ROUGH_NODES - 1, ROUGH_DEGREE))
#: Parts at which the second one is known.
NODES = (chebpts1(DEGREE + 1) + 1) / 2
#: Slopes err by less than this factor; extrema by less than this part of the bend.
SLACK, MARGIN = 1.5, 0.5
#: Relative rounding errors of values, and the distance from the real axis, in halves of a step, of
#: a root that counts as real.
ROUNDING, REAL = 1e-13, 1e-6
#: An extremum is sought where its value is below this multiple of the polynomial's error there.
UNCERTAIN = 10


class PolynomialExtremum(NamedTuple):
    """An extremum of a polynomial over a step, and the part of the step where the next one is."""

    part: float
    value: float
    end: float


class Shape(NamedTuple):
    """The course of an event in a step, by Chebyshev coefficients.

    It occurs at most once between its `extrema`, unless it may recur and these are unknown.
    """

    polynomial: Array
    extrema: list[PolynomialExtremum]
    recurs: bool = False


def rough_polynomial(values: Array) -> Array:
    """Chebyshev coefficients of the event with these values at `ROUGH_NODES`."""
    return np.asarray(TO_CHEBYSHEV @ values)


def may_recur(values: Array) -> bool:
    """Whether an event, with these values at `ROUGH_NODES`, may occur several times in a step.

    Slopes of the polynomial differ by at most the sum of their changes. If these are smaller than
    the slopes, the value is monotonic; it differs from the chord by less than a quarter of that sum
    times the degree.
    """
    if not np.isfinite(values).all():
        return False
    if values[0] == 0:
        return True
    c = TO_BERNSTEIN @ values
    slopes = np.diff(c)
    bend = float(np.abs(np.diff(slopes)).sum())
    if abs(slopes[0] + slopes[-1]) > SLACK * bend:
        return False
    nearest = (abs(values[0] + values[-1]) - abs(values[-1] - values[0])) / 2
    return bool(nearest <= ROUGH_DEGREE / 4 * bend)


def separate_crossings(before: float, values: Array, after: float) -> Shape:
    """The course of an event with these values at `NODES`.

    Its extrema are those at which it may have another sign than before: extrema near 0, and the
    first of successive ones with the same sign, unless `before` or `after`, the values at the ends,
    have it, too.
    """
    fitted = chebfit(2 * NODES - 1, values, DEGREE)
    c = np.asarray(chebtrim(fitted, ROUNDING * np.abs(values).max()), float)
    if len(c) < 3:
        return Shape(c, [])
    margin = MARGIN * float(np.abs(values - before - NODES * (after - before)).max())
    roots = chebroots(chebder(c))
    real = np.sort(roots[(np.abs(roots.imag) < REAL) & (np.abs(roots.real) < 1)].real)
    parts = [*((real + 1) / 2).tolist(), 1.0]
    kept, last = [], before
    for part, end in pairwise(parts):
        value = float(chebval(2 * part - 1, c))
        is_near = abs(value) <= margin
        if is_near or not value * last > 0:
            kept.append(PolynomialExtremum(part, value, end))
            last = 0.0 if is_near else value
    return Shape(c, kept[:-1] if kept and last * after > 0 else kept)


def approach(
    extremum: PolynomialExtremum, begin: float, before: float, value: Callable[[float], float]
) -> tuple[float, float]:
    """A part of the step, and the value there, with another sign than `before` if there is one.

    `value` gives exact values, which differ from those of the polynomial; that at the part `begin`
    has the sign of `before`.
    """
    there = value(extremum.part)
    tried = [(there, extremum.part)]
    if np.sign(there) == np.sign(before) and abs(there) < UNCERTAIN * abs(there - extremum.value):
        sign = np.sign(before)

        def size(part: float) -> float:
            if tried[-1][0] * sign > 0:
                tried.append((value(part), part))
            return float(tried[-1][0] * sign)

        limits = begin, extremum.end
        scipy.optimize.minimize_scalar(
            size, bounds=limits, method="bounded", options={"xatol": 1e-8}
        )
    there, part = min(tried, key=lambda pair: pair[0] * np.sign(before))
    return part, there
