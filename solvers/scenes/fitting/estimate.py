"""The fit of an experiment: values of parameters and starts, noise and covariance.

First guesses of the states at nodes come from the samples around them.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from solvers.equations.number_checks import Array
from solvers.scenes.fitting.experiment import Experiment
from solvers.scenes.fitting.least_squares import (
    LinearisedResiduals,
    Minimum,
    NotConvergedError,
    minimise,
    relaxed,
)
from solvers.scenes.fitting.multiple_shooting import NoResidualsError
from solvers.scenes.fitting.statistics import autocorrelation, covariance, leverages

#: Samples of the parabola whose value and slope are those of a coordinate at a node.
SAMPLES = 7
#: Attempts from random first guesses of runs' starts, and their spread.
ATTEMPTS, SPREAD = 10, 1.5


def first_nodes(
    experiment: Experiment, start: Array, params: Array, noise: Array
) -> Iterator[Array]:
    """States for all segments: by parabolas if all coordinates are measured, else by fits.

    `start` is the first guess of every run's start, `params` those of the unknown parameters.
    Fits may find another configuration that is measured alike; then there are several guesses.
    """
    outputs, module = experiment.outputs, experiment.module
    rows = {name: k for k, name in enumerate(outputs.names)}
    if all(q in rows and experiment.counts[rows[q]] for q in module.COORDINATES):
        yield _from_coordinates(experiment, rows)
        return
    random = np.random.default_rng(0)
    yield _from_fits(experiment, start, params, noise)
    for _ in range(ATTEMPTS):
        guess = start + SPREAD * random.normal(size=len(start))
        yield _from_fits(experiment, guess, params, noise)


def _from_coordinates(experiment: Experiment, rows: dict[str, int]) -> Array:
    module, n = experiment.module, len(experiment.module.COORDINATES)
    nodes = np.zeros((len(experiment.segments), 2 * n))
    for run, (measurement, table) in enumerate(
        zip(experiment.runs, experiment.tables, strict=True)
    ):
        own = [k for k, segment in enumerate(experiment.segments) if segment.run == run]
        begins = np.array([experiment.segments[k].begin for k in own])
        for k, name in enumerate(module.STATE):
            finite = np.isfinite(table[rows[name]]) if name in rows else np.array([False])
            if finite.any():
                t, values = measurement.t[finite], table[rows[name], finite]
                value, slope = _parabolas(t, values, begins)
                nodes[own, k] = value
                if k < n:
                    nodes[own, n + k] = slope
    return nodes


def _parabolas(t: Array, values: Array, begins: Array) -> tuple[Array, Array]:
    """Values and slopes, at some times, of parabolas through the samples around them."""
    count = min(SAMPLES, len(t))
    # a window that is near and has no gap, beyond which angles may be wrong by whole turns
    starts = np.searchsorted(t, begins)[:, np.newaxis] - np.arange(count + 1)
    starts = np.clip(starts, 0, len(t) - count)
    begins = begins[:, np.newaxis]
    left, right = t[starts], t[starts + count - 1]
    extents = right - left + np.maximum(abs(left - begins), abs(right - begins))
    first = np.take_along_axis(starts, extents.argmin(axis=1)[:, np.newaxis], axis=1)
    near = first + np.arange(count)
    times = t[near] - begins
    span = np.ptp(times, axis=1)
    span[span == 0] = 1.0
    powers = (times / span[:, np.newaxis])[:, :, np.newaxis] ** np.arange(min(3, count))
    fits = np.linalg.pinv(powers) @ values[near][:, :, np.newaxis]
    slopes = fits[:, 1, 0] / span if count > 1 else np.zeros(len(begins))
    return fits[:, 0, 0], slopes


def _from_fits(experiment: Experiment, start: Array, params: Array, noise: Array) -> Array:
    """One segment after the other, each from the end of the one before."""
    nodes, end = list[Array](), start
    for k in range(len(experiment.segments)):
        guess = start if k in experiment.firsts else end
        node, end = _fitted(experiment.alone(k, params), guess, noise)
        nodes.append(node)
    return np.array(nodes)


def _fitted(alone: Experiment, guess: Array, noise: Array) -> tuple[Array, Array]:
    """States at the node and at the end of a segment with known parameters."""
    linearise, none = alone.linearise(noise), np.empty(0)
    nodes = guess[np.newaxis]
    with suppress(NotConvergedError):
        nodes = minimise(linearise, nodes, none, alone.positive, np.ones(len(guess))).nodes
    try:
        return nodes[0], alone.shooting(nodes, alone.params).ends[0]
    except NoResidualsError:
        return guess, guess


#: Estimates of the noise of several outputs, each with the fit weighted by the one before.
MOST_WEIGHTINGS, SUFFICIENT = 10, 0.01
#: Gauss-Newton steps before gaps are relaxed.
FEW = 6
#: Mean squares of residuals, in units of their rough noise, of a minimum that needs no relaxation,
#: and of one after which no other guess is tried.
SMALL, GOOD = 2.0, 9.0
#: Largest autocorrelation of noise, in standard errors.
INDEPENDENT = 4.0
#: Largest standard error of a value that counts as determined, in units of the value.
LARGEST_ERROR = 1e3


@dataclass(frozen=True)
class Estimate:
    """Values that fit an experiment best.

    Attributes
    ----------
    params : ndarray of shape (params,)
        All parameters.
    starts : ndarray of shape (runs, state)
        States at the first time of each run.
    nodes : ndarray of shape (segments, state)
        States at the beginnings of all segments.
    noise : ndarray of shape (outputs,)
        Standard deviations of the noise; NaN where an output has no values to spare.
    covariance : ndarray of shape (starts + unknown, starts + unknown)
        Of all starts, then of the unknown parameters.
    degrees : int
        Number of values minus number of unknowns.
    rough : ndarray of shape (outputs,)
        Standard deviations of the noise from differences of successive values, without a model.
    iterations : int
        Gauss-Newton steps after relaxation.
    """

    params: Array
    starts: Array
    nodes: Array
    noise: Array
    covariance: Array
    degrees: int
    rough: Array
    iterations: int


def estimate(
    experiment: Experiment, start: Array, guess: Array, *, relaxes: bool = True
) -> Estimate:
    """The fit from a first guess of the runs' starts and of the unknown parameters.

    `ValueError` where there are fewer values than unknowns, `NotConvergedError` where no fit is
    found, or where the values do not determine the unknowns. Without `relaxes` only a few steps
    from one guess are tried.
    """
    n, u = len(experiment.module.STATE), len(experiment.unknown)
    counts, unknowns = experiment.counts, n * len(experiment.runs) + u
    if counts.sum() <= unknowns:
        raise ValueError(
            f"{counts.sum()} measured values do not suffice for {unknowns} unknowns, which are "
            f"{', '.join(('the start of each run', *experiment.unknown))}: give more values, "
            "or let fewer parameters be unknown"
        )
    noise = experiment.first_noise()
    nodes, params, linear, scale = _near(experiment, start, guess, noise, relaxes)
    positive, iterations = experiment.positive, 0
    for _ in range(MOST_WEIGHTINGS):
        linearise = experiment.linearise(noise)
        minimum = minimise(linearise, nodes, params, positive, scale, linear)
        nodes, params = minimum.nodes, minimum.params
        iterations += minimum.iterations
        before, noise = noise, _noise(experiment, minimum, noise)
        measured = np.flatnonzero(counts)
        if len(measured) == 1 or (abs(noise / before - 1)[measured] < SUFFICIENT).all():
            break
        ratio = np.repeat(before / noise, experiment.masks.shape[2])
        linear = minimum.linear.weighted(np.tile(ratio, (len(nodes), 1)))
    # of residuals in units of the noise before, the variance is the ratio
    variance = float(minimum.linear.squares / (counts.sum() - unknowns))
    with np.errstate(invalid="ignore"):  # without noise, 0 times infinity is undetermined
        matrix = variance * covariance(minimum.step.triangle)
    largest = np.maximum(abs(guess), abs(params))
    sizes = np.concatenate([np.tile(scale, len(experiment.runs)), largest])
    _check(experiment, np.sqrt(np.diag(matrix)), np.maximum(sizes, 1e-6))
    return Estimate(
        experiment.all_params(params),
        nodes[experiment.firsts],
        nodes,
        noise,
        matrix,
        int(counts.sum()) - unknowns,
        experiment.first_noise(),
        iterations,
    )


def _near(
    experiment: Experiment, start: Array, guess: Array, noise: Array, relaxes: bool
) -> tuple[Array, Array, LinearisedResiduals | None, Array]:
    """Nodes and unknown parameters near the minimum, residuals there, and sizes of the state.

    Where a few steps from the first guess do not lead there, gaps are relaxed.
    """
    linearise, positive = experiment.linearise(noise), experiment.positive
    best, least = None, np.inf
    for nodes in first_nodes(experiment, start, guess, noise):
        scale = np.maximum(np.sqrt(np.mean(nodes**2, axis=0)), 1e-6)
        try:
            direct = minimise(linearise, nodes, guess, positive, scale, most=FEW)
            if _is_noise(experiment, direct.linear):
                return direct.nodes, direct.params, direct.linear, scale
        except NotConvergedError:
            pass
        if not relaxes:
            break
        trial = relaxed(linearise, nodes, guess, positive, scale)
        if best is None or trial.squares < least:
            best, least = (trial.nodes, trial.params, trial.linear, scale), trial.squares
        if least < GOOD * experiment.counts.sum():
            break
    if best is None:
        raise NotConvergedError(f"no fit after {FEW} iterations: give a better first guess")
    return best


def _is_noise(experiment: Experiment, linear: LinearisedResiduals) -> bool:
    """Whether residuals are as small as the rough noise, and independent of each other."""
    rows = np.moveaxis(linear.residuals.reshape(experiment.masks.shape), 1, 0)
    count = experiment.counts.sum()
    parts = [autocorrelation([row.ravel()], 2)[1] * np.sqrt(np.count_nonzero(row)) for row in rows]
    return linear.squares < SMALL * count and max(map(abs, parts)) < INDEPENDENT


def _noise(experiment: Experiment, minimum: Minimum, before: Array) -> Array:
    """Unbiased standard deviations: of each output's values, its share of unknowns is taken off."""
    jacobian = minimum.step.jacobian(minimum.linear)
    shares = leverages(jacobian.reshape(-1, jacobian.shape[2]), minimum.step.triangle)
    squares, own = (
        values.reshape(experiment.masks.shape).sum(axis=(0, 2))
        for values in (minimum.linear.residuals**2, shares)
    )
    spare = experiment.counts - own
    common = np.sqrt(squares.sum() / spare.sum())
    with np.errstate(invalid="ignore", divide="ignore"):
        deviations = np.sqrt(squares / spare)
    # an output with hardly more values than it determines unknowns shares the others' ratio
    return np.asarray(before * np.where(spare > 1, np.maximum(deviations, 1e-9), common))


def _check(experiment: Experiment, errors: Array, sizes: Array) -> None:
    """Refuse a fit that leaves a combination of unknowns undetermined."""
    runs, state = experiment.runs, experiment.module.STATE
    names = [f"{q} at the start of {run.name}" for run in runs for q in state]
    free = ~(errors < LARGEST_ERROR * sizes)
    if free.any():
        parts = [name for name, one in zip([*names, *experiment.unknown], free, strict=True) if one]
        raise NotConvergedError(
            f"the measured values do not determine {', '.join(parts)}: hold a parameter, or "
            "measure more"
        )
