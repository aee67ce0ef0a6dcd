"""Motions by Taylor series with more digits than double precision has."""

from collections.abc import Callable
from dataclasses import replace
from time import perf_counter

import numpy as np

from solvers.integration.accuracy.checked_motion import Array, Motion
from solvers.integration.accuracy.checked_run import CheckedRun, check_length, difference
from solvers.integration.accuracy.integration_run import (
    IntegrationRun,
    NotAccurateError,
    TooLongError,
)
from solvers.integration.accuracy.method_choice import MethodChoice

#: Digits of Taylor series: fewest, increment, most.
DIGITS, MORE_DIGITS, MOST_DIGITS = 24, 12, 96
#: Largest angle in rad and number of turns for Taylor series.
LARGEST_ANGLE, MOST_TURNS = 1e6, 3000.0


def by_series(
    motion: Motion,
    choice: MethodChoice,
    accuracy: float,
    times: Array,
    report: Callable[[str], None],
) -> CheckedRun:
    """Taylor series with as many digits as are necessary.

    `NotAccurateError` where even the most digits are not sufficient, `SeriesError` where they take
    more than `MAX_PRODUCTS`. `report` receives the progress.
    """
    check_length(motion, MOST_TURNS)
    if max(map(abs, motion.y0)) > LARGEST_ANGLE:
        raise TooLongError(f"angles above {LARGEST_ANGLE:g} rad: reduce them by whole turns")
    coarse, error = None, np.inf
    for digits in range(DIGITS, MOST_DIGITS + 1, MORE_DIGITS):

        def progress(t: float, digits: int = digits) -> None:
            report(f"Taylor series of {digits} digits at {t:.3g} of {motion.span[1]:g} s")

        run, before = IntegrationRun(motion, choice, digits), perf_counter()
        fine = run.states(times, progress)
        seconds = perf_counter() - before
        if coarse is not None:
            # the result is rounded to double precision
            error = difference(motion, coarse, fine) + float(np.spacing(np.abs(fine).max()))
        if error <= accuracy:
            model = CheckedRun(run, error)
            return replace(model, computed=(times, fine), computing_seconds=seconds)
        coarse = fine
    text = f"{MOST_DIGITS} digits reach {error:.1g} where {accuracy:.1g} is requested"
    raise NotAccurateError(text)
