"""The cheapest integration whose error is below an accuracy: doubles, longer numbers, series.

Longer numbers are compiled ones, before Taylor series in decimals.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from math import exp, log
from time import perf_counter

import numpy as np

from solvers.equations.forms import fastest_form
from solvers.equations.module import named, operations_on_state
from solvers.integration.accuracy.checked_motion import Array, Motion, golden_points
from solvers.integration.accuracy.checked_run import (
    CheckedRun,
    check_length,
    checked_run,
    difference,
)
from solvers.integration.accuracy.double_precision import MARGIN
from solvers.integration.accuracy.integration_run import (
    IntegrationRun,
    NotAccurateError,
    TooLongError,
)
from solvers.integration.accuracy.method_choice import SERIES, MethodChoice, usual_form
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.extended import PRECISIONS, kernel
from solvers.references.taylor import SeriesError

#: Most turns, and most products of a run, which take up to a minute.
MOST_TURNS, MOST_PRODUCTS = 20_000.0, 2e8
#: The tolerances of runs that check a run, as multiples of its own; the coarsest of its own;
#: attempts in one precision, the share of the requested accuracy to aim at, and the largest factor
#: between the tolerances of attempts.
MULTIPLES, COARSEST, TRIES, RESERVE, LEAST_CHANGE = (2.0, 5.0, 10.0), 1e-18, 4, 0.1, 0.01
#: Most samples, and most ends of steps, at which runs are compared.
MOST_SAMPLES = 256
#: Difference of two runs below which it grows as small changes do, and the largest exponent.
SMALL, MOST_EXPONENT = 1e-3, 700.0
WHY = "the motion loses more digits than double precision has"


def by_longer_numbers(
    motion: Motion,
    accuracy: float,
    times: Array,
    declined: dict[str, str],
    report: Callable[[str], None],
) -> CheckedRun | None:
    """The run in the shortest numbers that are sufficient; None if none are.

    The reasons against insufficient ones are added to `declined`.
    """
    check_length(motion, MOST_TURNS)
    finest = shortest = COARSEST
    for precision in PRECISIONS:
        try:
            limit = kernel(motion.module, precision).epsilon
        except NoCompilerError as failure:
            declined[precision] = str(failure)
            continue
        if limit >= shortest:  # another one has as many digits
            continue
        shortest = limit
        for _ in range(TRIES):
            finest = min(max(finest, limit), COARSEST)
            try:
                model, growth = _checked(motion, precision, finest, times, report)
            except (NotAccurateError, TooLongError) as failure:
                declined[precision], growth = str(failure), 1.0
                break
            error = model.error_estimate
            if error <= accuracy:
                declined.pop(precision, None)
                return model
            declined[precision] = f"{precision} numbers reach {error:.1g}"
            if finest == limit:
                break
            finest *= min(RESERVE * accuracy / error, LEAST_CHANGE)
        # errors are `growth` times as large as tolerances
        finest = RESERVE * accuracy / (MARGIN * MULTIPLES[-1] * growth)
    return None


def _checked(
    motion: Motion, precision: str, finest: float, times: Array, report: Callable[[str], None]
) -> tuple[CheckedRun, float]:
    """The run with the finest tolerance, checked by others; and the growth of its errors.

    The others are perturbed by a few rounding errors: those of constants are the same in all runs.
    """
    stages, form = PRECISIONS[precision].stages, fastest_form(motion.module)
    choice = MethodChoice(f"gauss{stages}", form, WHY, precision=precision)
    operations = operations_on_state(motion.module, named("rhs", form))
    most = int(MOST_PRODUCTS / (stages * (operations + 2 * stages * len(motion.y0))))

    def progress(t: float) -> None:
        report(f"{choice.method}, {precision}, at {t:.3g} of {motion.span[1]:g} s")

    run, before = IntegrationRun(motion, choice, finest, most), perf_counter()
    compared = _compared_times(run, times)
    together = motion.ordered([*times, *compared])
    states = run.states(together, progress)
    seconds, distances = perf_counter() - before, list[Array]()
    direction = np.sign(motion.duration)
    places = (np.searchsorted(direction * together, direction * t) for t in (times, compared))
    computed, fine = (states[k] for k in places)
    for k, multiple in enumerate(MULTIPLES, 1):
        other = replace(run, setting=multiple * finest).extended_states(compared, progress, k)
        distances.append(np.abs(fine - other)[:, list(motion.requested)].max(axis=1))
    error = MARGIN * float(np.max(distances)) + float(np.spacing(np.abs(fine).max()))
    model = replace(CheckedRun(run, error), computed=(times, computed), computing_seconds=seconds)
    elapsed = np.abs(compared - motion.begin)
    return model, _growth(elapsed, distances[-1], MULTIPLES[-1] * finest)


def _compared_times(run: IntegrationRun, times: Array) -> Array:
    """Some of the samples, and of the ends of a method's steps, which are dense at fast motions."""
    parts = [times, run.motion.sample_times]
    with suppress(NotAccurateError, TooLongError):
        parts.append(run.step_times())
    spread = golden_points(MOST_SAMPLES)
    some = (part[np.unique((len(part) * spread).astype(int))] for part in parts)
    return run.motion.ordered([*np.concatenate([*some]), times[-1]])


def _growth(times: Array, errors: Array, tolerance: float) -> float:
    """The ratio of errors and tolerance at the end; extrapolated where errors are not small.

    It is 1 where nothing is known of it.
    """
    large = np.flatnonzero(errors > SMALL)
    k = int(large[0]) - 1 if large.size else len(times) - 1
    if k < 1:
        return 1.0
    exponent = log(max(float(errors[k]) / tolerance, 1.0)) * float(times[-1] / times[k])
    return exp(min(exponent, MOST_EXPONENT))


#: Digits of Taylor series: fewest, increment, most.
DIGITS, MORE_DIGITS, MOST_DIGITS = 24, 12, 96
#: Largest angle in rad and number of turns for Taylor series.
LARGEST_ANGLE, MOST_SERIES_TURNS = 1e6, 3000.0


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
    check_length(motion, MOST_SERIES_TURNS)
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
            apart = difference(motion, coarse, fine)
            rounding = float(np.spacing(np.abs(fine).max()))
            if apart <= rounding and accuracy < rounding:
                raise NotAccurateError(
                    f"results in double precision have an error of up to {rounding:.1g} where "
                    f"{accuracy:.1g} is requested: request less accuracy"
                )
            error = apart + rounding
        if error <= accuracy:
            model = CheckedRun(run, error)
            return replace(model, computed=(times, fine), computing_seconds=seconds)
        coarse = fine
    text = f"{MOST_DIGITS} digits reach {error:.1g} where {accuracy:.1g} is requested"
    raise NotAccurateError(text)


def sufficient_run(
    motion: Motion,
    choice: MethodChoice,
    accuracy: float,
    times: Array,
    report: Callable[[str], None] = lambda _: None,
    specialised: Motion | None = None,
) -> tuple[CheckedRun, dict[str, str]]:
    """The run, and the reason against each cheaper kind of numbers by its name.

    Longer numbers and series return the states at `times` only. Runs in doubles integrate
    `specialised`, the same motion with other code, if it is given. A method that is named is the
    only one. `report` receives the progress. `NotAccurateError` where nothing is sufficient,
    `TooLongError` above the limit of steps, `EndsEarlyError` where the motion cannot be continued.
    """
    report(f"full equations by {choice.method}")
    declined: dict[str, str] = {}
    try:
        return checked_run(specialised or motion, choice, accuracy, motion), declined
    except NotAccurateError as error:
        if choice.is_named:
            raise
        declined["double precision"] = str(error)
    if motion.inputs is not None:
        raise NotAccurateError(
            f"{declined['double precision']}; longer numbers have no inputs that vary: request "
            "less accuracy"
        )
    if longer := by_longer_numbers(motion, accuracy, times, declined, report):
        return longer, declined
    report("full equations by Taylor series")
    why = "the motion loses more digits than double precision has, and than compiled numbers have"
    choice = MethodChoice(SERIES, usual_form(motion.module, SERIES), why)
    try:
        return by_series(motion, choice, accuracy, times, report), declined
    except SeriesError as error:
        reasons = [declined[name] for name in ("double precision", *PRECISIONS) if name in declined]
        raise NotAccurateError(f"{'; '.join(reasons)}; by Taylor series {error}") from error
