"""Many motions whose returned states have errors below a requested accuracy."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.forms import fastest_form
from solvers.equations.module import GeneratedModule
from solvers.equations.number_checks import Values, positive
from solvers.equations.singularities import checked_before
from solvers.integration.accuracy.accurate_motion import accurate_motion, check_options
from solvers.integration.accuracy.checked_motion import Array
from solvers.integration.accuracy.checked_run import CHECKS, FINEST, MARGIN, RESERVE, TIGHTER, TRIES
from solvers.integration.accuracy.integration_run import (
    SMALL_STATE,
    EndsEarlyError,
    NotAccurateError,
    TooLongError,
)
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.given_tolerances import MotionBatch
from solvers.integration.problem.problem import Options
from solvers.integration.results.ensemble_solution import Ensemble
from solvers.io.suggestion import counted, warn_caller

#: Integrates many motions, from the arguments of `many_motions`.
Run = Callable[[GeneratedModule, tuple[float, ArrayLike], Values, Values, Options], Ensemble]


class AccuracyWarning(UserWarning):
    """Motions of an ensemble whose estimated errors exceed the requested accuracy."""


def accurate_ensemble(
    module: GeneratedModule,
    t_span: ArrayLike | tuple[float, ArrayLike],
    y0: Values,
    params: Values,
    options: Options,
    accuracy: float,
    run: Run,
) -> Ensemble:
    """The motions of `ensemble` with this accuracy, whose arguments it describes."""
    accuracy = positive("accuracy", accuracy)
    check_options(options)
    motions = MotionBatch.of(module, t_span, y0, params, options)
    rows, tolerance = np.arange(len(motions.states)), max(accuracy * RESERVE, FINEST * TIGHTER)
    result, estimates = None, np.full(len(rows), np.inf)
    with ignore_predictability(), checked_before():
        for _ in range(TRIES):
            part, errors = _checked(motions, rows, options, tolerance, run)
            if result is None:
                result = part
            else:
                _put(result, rows, part)
            estimates[rows] = errors
            rows = rows[~(errors <= accuracy) & part.success]
            if not len(rows) or tolerance <= FINEST * TIGHTER:
                break
            worst = float(np.median(estimates[rows]))
            factor = RESERVE * accuracy / worst if np.isfinite(worst) else 0.1
            tolerance = max(tolerance * min(max(factor, 1e-4), 0.5), FINEST * TIGHTER)
        assert result is not None
        for k in rows.tolist() if not motions.problem.events else ():
            _integrate_alone(result, estimates, motions, k, options, accuracy)
    if (above := estimates > accuracy).any():
        warn_caller(
            f"the estimated errors of {counted(int(above.sum()), 'motion')} of {len(above)} are "
            f"above {accuracy:g}, see error_estimate: request less accuracy, or leave out events",
            AccuracyWarning,
        )
    return replace(result, error_estimate=estimates)


def _checked(
    motions: MotionBatch, rows: NDArray[np.int64], options: Options, tolerance: float, run: Run
) -> tuple[Ensemble, Array]:
    """Some of the motions with a tolerance, and their errors by two methods in another form."""
    module = motions.problem.form.module
    first = _run(motions, rows, options, tolerance, run)
    main = options.form or fastest_form(module)
    form = fastest_form(module) if main == "lagrangian" else "lagrangian"
    fine = max(tolerance / TIGHTER, FINEST)
    checks = [
        _run(motions, rows, replace(options, method=method, form=form), fine, run)
        for method in CHECKS
    ]
    distances = np.max([_distances(first, check) for check in checks], axis=0)
    # errors of the checks themselves, as by roundings where the tolerance is near these
    rest = _distances(*checks) + fine * np.abs(checks[0].y).max(axis=0)
    return first, MARGIN * distances + rest


def _run(
    motions: MotionBatch, rows: NDArray[np.int64], options: Options, tolerance: float, run: Run
) -> Ensemble:
    """Some of the motions with a tolerance."""
    times, constants = motions.times, motions.constants
    ends = times.ends[rows] if times.differ else times.end(0)
    samples = times.samples[rows] if len(times.samples) > 1 else times.samples[0]
    params = constants[rows] if len(constants) > 1 else constants
    control = replace(options, t_eval=samples, rtol=tolerance, atol=SMALL_STATE * tolerance)
    columns = motions.states[rows].T, params.T if len(params) > 1 else params[0]
    return run(motions.problem.form.module, (times.begin, ends), *columns, control)


def _distances(one: Ensemble, other: Ensemble) -> Array:
    """The largest difference of the returned states of each motion; infinity if one lacks them."""
    differences = [np.abs(one.y - other.y), *np.moveaxis(np.abs(one.samples - other.samples), 2, 0)]
    known = [np.isnan(one.y) & np.isnan(other.y)]
    known += [*np.moveaxis(np.isnan(one.samples) & np.isnan(other.samples), 2, 0)]
    largest = np.zeros(one.y.shape[1])
    for difference, is_absent in zip(differences, known, strict=True):
        finite = np.where(np.isnan(difference), np.inf, difference)
        largest = np.maximum(largest, np.where(is_absent, 0.0, finite).max(axis=0))
    return np.where(one.success & other.success, largest, np.inf)


def _put(result: Ensemble, rows: NDArray[np.int64], part: Ensemble) -> None:
    """Replace some of the motions by others."""
    for name in ("t", "growth", "t_events", "occurred", "status", "steps", "rejected", "nfev"):
        getattr(result, name)[rows] = getattr(part, name)
    for name in ("y", "samples", "y_events"):
        getattr(result, name)[:, rows] = getattr(part, name)


def _integrate_alone(
    result: Ensemble,
    estimates: Array,
    motions: MotionBatch,
    k: int,
    options: Options,
    accuracy: float,
) -> None:
    """Replace a motion by that with other methods or longer numbers, where these suffice."""
    times, constants = motions.times, motions.constants
    span, samples = (times.begin, times.end(k)), times.samples_of(k)
    ends = samples if len(samples) and samples[-1] == span[1] else np.array([*samples, span[1]])
    alone = replace(options, form=None, t_eval=ends)
    start, params = motions.states[k], constants[k % len(constants)]
    try:
        solution = accurate_motion(
            motions.problem.form.module, span, start, params, alone, accuracy, is_named=False
        )
    except (EndsEarlyError, NotAccurateError, TooLongError):
        return
    result.y[:, k], result.samples[:, k] = solution.y[:, -1], solution.y[:, : len(samples)]
    result.t[k], result.status[k], estimates[k] = (
        *solution.t[-1:],
        solution.status,
        (solution.error_estimate),
    )
    result.steps[k], result.rejected[k] = solution.steps, solution.rejected
    result.nfev[k] = solution.nfev
