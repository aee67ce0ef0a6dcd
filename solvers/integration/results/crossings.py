"""Parts of a step between which an event occurs at most once, by its polynomial over the step.

The compiled loop does the same in ``compiled/c/extension.h`` and ``roots.h``.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

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

from solvers.runge_kutta.continuous_extension import bernstein_values
from solvers.runge_kutta.stepper import Array

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
ROUNDING, CLOSE = 1e-13, 1e-6
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
    real = np.sort(roots[(np.abs(roots.imag) < CLOSE) & (np.abs(roots.real) < 1)].real)
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
