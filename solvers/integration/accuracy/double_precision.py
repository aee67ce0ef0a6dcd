"""Runs that are as accurate as double precision permits, checked by their agreement.

Where rounding errors grow to the requested accuracy, no run is accurate enough to check another:
two of them may agree by chance, or the check may be the worse one. Several methods in several
forms have few roundings in common, and compensated sums make their errors as small as possible.
"""

from dataclasses import replace
from itertools import product

import numpy as np

from solvers.equations.forms import fastest_form
from solvers.integration.accuracy.checked_motion import Array, Motion, golden_points
from solvers.integration.accuracy.integration_run import (
    IntegrationRun,
    NotAccurateError,
    TooLongError,
)
from solvers.integration.accuracy.method_choice import MethodChoice

#: The fastest method, run in every form, and others, run in one.
BEST, OTHERS = "verner98", ("tsit54", "dop853")
#: Tolerances, of which the first is used that takes no more than this number of steps.
TOLERANCES, MOST_STEPS = (2e-15, 2e-14, 2e-13), 300_000
#: Runs that are necessary, and the safety factor of their differences.
FEWEST, MARGIN = 3, 4.0
#: Most steps at which errors are estimated.
MOST_SAMPLES = 100_000


def sufficient(
    motion: Motion, accuracy: float, named: MethodChoice | None = None
) -> tuple[IntegrationRun, float]:
    """The first run whose error is below the accuracy, else the best, or `named`; and its error.

    The farthest of three or more others counts for nothing, so that one inaccurate run does not
    make the others suspicious. `NotAccurateError` where fewer than three reach the end.
    """
    choices = _choices(motion)
    if named:
        others = [c for c in choices if (c.method, c.form) != (named.method, named.form)]
        choices = [replace(named, compensated=True), *others]
    times, results = None, list[tuple[IntegrationRun, Array]]()
    for choice in choices:
        try:
            run = _finished(motion, choice)
            times = check_times(run) if times is None else times
            results.append((run, run.states(times)))
        except (NotAccurateError, TooLongError):
            if choice.is_named:
                raise
    if len(results) < FEWEST:
        raise NotAccurateError(f"{len(results)} of {len(choices)} runs reach the end")
    states = np.array([states[:, list(motion.requested)] for _, states in results])
    errors = [MARGIN * _distance(states, k) for k in range(len(states))]
    candidates = errors[:1] if named else errors
    best = min(candidates)
    k = next(k for k, error in enumerate(candidates) if error <= max(accuracy, best))
    return results[k][0], errors[k]


def _finished(motion: Motion, choice: MethodChoice) -> IntegrationRun:
    """A run that reaches the end: its error estimates may round to more than a fine tolerance."""
    *finer, coarsest = (IntegrationRun(motion, choice, x, MOST_STEPS) for x in TOLERANCES)
    for run in finer:
        try:
            run.integrate(np.array([motion.span[1]]))
        except TooLongError:
            continue
        return run
    return coarsest


def check_times(run: IntegrationRun) -> Array:
    """Times at which a run is compared: samples, ends and middles of steps, evenly spread ones."""
    times, _ = run.integrate(None)
    if len(times) > MOST_SAMPLES:
        times = times[np.unique((len(times) * golden_points(MOST_SAMPLES)).astype(int))]
    # steps are dense where the motion is fast; between two of them it may be faster
    middles, motion = (times[1:] + times[:-1]) / 2, run.motion
    return motion.ordered([*times, *middles, *motion.sample_times, *motion.times])


def _choices(motion: Motion) -> list[MethodChoice]:
    fastest = fastest_form(motion.module)
    forms = motion.forms
    forms.sort(key=lambda form: form != fastest)
    # in the fastest form and the one that differs most from it
    pairs = [*product([BEST], forms), *zip(OTHERS, (forms[0], forms[-1]), strict=True)]
    why = "the most accurate in double precision: compensated sums, checked by other methods"
    return [MethodChoice(method, form, why, compensated=True) for method, form in pairs]


def _distance(states: Array, k: int) -> float:
    """The largest difference of run `k` from the others, without the farthest of them."""
    distances = np.sort([np.abs(states[k] - x).max() for j, x in enumerate(states) if j != k])
    return float(distances[-1] if len(distances) < FEWEST else distances[-2])
