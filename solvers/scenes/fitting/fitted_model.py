"""A fitted model: values with intervals, noise, residuals and predictions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solvers.equations.number_checks import Array
from solvers.io.suggestion import counted
from solvers.scenes.fitting.estimate import Estimate, estimate
from solvers.scenes.fitting.experiment import Experiment
from solvers.scenes.fitting.least_squares import NotConvergedError
from solvers.scenes.fitting.measurement import Measurement, Outputs, wrapped
from solvers.scenes.fitting.statistics import ConfidenceInterval, autocorrelation

#: Autocorrelation at lag 1, in standard errors of that of white noise, from which a note warns.
NOTABLE = 4.0
#: Ratio of residuals to the scatter from sample to sample from which a note warns.
LARGE = 5.0
#: Most segments of a run with which a fit is tried first.
FEW_SEGMENTS = 25


@dataclass(frozen=True, repr=False)
class Fit:
    """Parameters of a system from measured runs.

    Attributes
    ----------
    outputs : Outputs
        The measured quantities.
    runs : tuple of Measurement
        The runs that were fitted.
    unknown : tuple of str
        Names of the fitted parameters.
    estimate : Estimate
        Numbers as arrays: all parameters, starts, noise, covariance, degrees of freedom.
    fitted : tuple of ndarray of shape (outputs, times)
        Measured quantities of the fitted motion of each run.
    residuals : tuple of ndarray of shape (outputs, times)
        Measured minus fitted values; NaN in gaps.
    held : mapping of str to str
        Parameters that could not be unknown, too, with the reasons.

    Examples
    --------
    >>> import numpy as np
    >>> import generated.single_pendulum as sp
    >>> from solvers import fit, integrate
    >>> t = np.linspace(0, 4, 60)
    >>> motion = integrate(sp, (0, 4), {"theta": 2.0}, {"l": 0.5}, t_eval=t)
    >>> noise = 0.01 * np.random.default_rng(2).normal(size=len(t))
    >>> result = fit(sp, {"t": t, "theta": motion.y[0] + noise})
    >>> interval = result.intervals["l"]
    >>> bool(interval.low < 0.5 < interval.high)
    True
    >>> result.held
    {'m': 'no output depends on it', 'g': 'only as g/l'}
    """

    outputs: Outputs
    runs: tuple[Measurement, ...]
    unknown: tuple[str, ...]
    estimate: Estimate
    fitted: tuple[Array, ...]
    residuals: tuple[Array, ...]
    held: Mapping[str, str]

    @property
    def params(self) -> dict[str, float]:
        """All parameters by name, as `solvers.integrate` takes them."""
        values = self.estimate.params.tolist()
        return dict(zip(self.outputs.module.PARAMETERS, values, strict=True))

    @property
    def starts(self) -> list[dict[str, float]]:
        """The fitted state at the first time of each run, by name."""
        state = self.outputs.module.STATE
        return [dict(zip(state, y.tolist(), strict=True)) for y in self.estimate.starts]

    @property
    def errors(self) -> Array:
        """Standard errors of the unknown parameters."""
        count = len(self.unknown)
        variances = np.diag(self.estimate.covariance)
        return np.sqrt(variances[len(variances) - count :])

    @property
    def intervals(self) -> dict[str, ConfidenceInterval]:
        """Values of the unknown parameters with 95 % confidence intervals."""
        params, degrees = self.params, self.estimate.degrees
        pairs = zip(self.unknown, self.errors.tolist(), strict=True)
        return {name: ConfidenceInterval.of(params[name], error, degrees) for name, error in pairs}

    @property
    def correlations(self) -> Array:
        """Correlations of the unknown parameters, shape (unknown, unknown)."""
        count = len(self.estimate.covariance) - len(self.unknown)
        own = self.estimate.covariance[count:, count:]
        return np.asarray(own / np.outer(self.errors, self.errors))

    @property
    def noise(self) -> dict[str, float]:
        """Standard deviation of the noise of each measured quantity, in its unit."""
        return dict(zip(self.outputs.names, self.estimate.noise.tolist(), strict=True))

    @cached_property
    def notes(self) -> tuple[str, ...]:
        """Reasons to doubt the model or the intervals."""
        notes = []
        for k, name in enumerate(self.outputs.names):
            own = [residuals[k] for residuals in self.residuals]
            count = sum(int(np.isfinite(values).sum()) for values in own)
            first = float(autocorrelation(own, 2)[1]) if count else 0.0
            if abs(first) * np.sqrt(count) > NOTABLE:
                notes.append(
                    f"residuals of {name} are correlated from sample to sample ({first:.2f}): the "
                    "model lacks a force, or the noise is not independent, and the intervals are "
                    "too narrow"
                )
            ratio = self.estimate.noise[k] / self.estimate.rough[k]
            if ratio > LARGE:
                notes.append(
                    f"residuals of {name} are {ratio:.0f} "
                    "times as large as the scatter from sample to sample: the model is wrong, or a "
                    "better first guess leads to a better fit"
                )
        for name, interval in self.intervals.items():
            if interval.low <= 0 <= interval.high:
                notes.append(
                    f"{name} does not differ from 0 by more than its error: a model without it may "
                    "suffice"
                )
        return tuple(notes)

    def __repr__(self) -> str:
        values = ", ".join(
            f"{k} = {v.value:.6g} ± {v.error:.2g}" for k, v in self.intervals.items()
        )
        runs = counted(len(self.runs), "run")
        return f"Fit of {self.outputs.module.SYSTEM} to {runs}: {values}"


def fitted(
    outputs: Outputs,
    runs: Sequence[Measurement],
    unknown: Sequence[str],
    params: Mapping[str, float],
    start: Array,
    held: Mapping[str, str],
) -> Fit:
    """The fit of `unknown` parameters; `params` and `start`, of every run, are first guesses."""
    module = outputs.module
    values = np.array([params[name] for name in module.PARAMETERS], float)
    arguments = outputs, runs, unknown, values
    experiment = Experiment(*arguments, most=FEW_SEGMENTS)
    guess = values[experiment.indices]
    try:
        result = estimate(experiment, start, guess, relaxes=False)
    except NotConvergedError:  # shorter segments tolerate a worse guess, and take longer
        experiment = Experiment(*arguments)
        result = estimate(experiment, start, guess)
    arcs = experiment.shooting(result.nodes, result.params)
    angles = outputs.angles
    motions, turns = [list[Array]() for _ in runs], np.zeros(len(start))
    for k, segment in enumerate(experiment.segments):
        if k in experiment.firsts:
            turns = np.zeros(len(start))
        else:  # nodes are angles modulo whole turns
            ahead = arcs.ends[k - 1, angles] - result.nodes[k, angles]
            turns[angles] += 2 * np.pi * np.round(ahead / (2 * np.pi))
        y, own = arcs.y[k, :, : len(segment.times)], result.params.tolist()
        values = outputs.values(segment.times, y + turns[:, np.newaxis], own)
        motions[segment.run].append(values)
    curves = [np.concatenate(parts, axis=1) for parts in motions]
    tables = zip(experiment.tables, curves, strict=True)
    residuals = tuple(wrapped(table - curve, outputs.turns) for table, curve in tables)
    return Fit(outputs, tuple(runs), tuple(unknown), result, tuple(curves), residuals, held)
