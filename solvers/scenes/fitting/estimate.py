"""The fit of an experiment: values of parameters and starts, noise and covariance."""

from dataclasses import dataclass

import numpy as np

from solvers.equations.number_checks import Array
from solvers.scenes.fitting.experiment import Experiment
from solvers.scenes.fitting.least_squares import (
    LinearisedResiduals,
    Minimum,
    NotConvergedError,
    minimise,
)
from solvers.scenes.fitting.relaxation import relaxed
from solvers.scenes.fitting.starts import first_nodes
from solvers.scenes.fitting.statistics import autocorrelation, covariance, leverages

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
