"""The time of an event within a step, between two times of which one is before it.

Two or three shorter steps near the estimate of a polynomial make the bracket so narrow that a cubic
gives all other states. The compiled loop does the same in ``compiled/c/brackets.h``.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy
from numpy.polynomial.chebyshev import chebder, chebval

from solvers.integration.results.step_states import EventCourse
from solvers.runge_kutta.stepper import Array

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
