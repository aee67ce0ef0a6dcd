"""Models compared by their predictions of measurements that were kept back."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from solvers.equations.number_checks import Array
from solvers.integration.integrate import integrate
from solvers.integration.problem.inputs import Held
from solvers.io.suggestion import counted
from solvers.scenes.fitting.estimate import estimate
from solvers.scenes.fitting.experiment import Experiment, unwrapped
from solvers.scenes.fitting.fitted_model import Fit
from solvers.scenes.fitting.least_squares import NotConvergedError
from solvers.scenes.fitting.measurement import Measurement, check_inputs, wrapped

#: Part of a run that is kept back, from which a prediction's start is estimated, and blocks whose
#: means give the standard error of a difference between models.
START, BLOCKS = 0.5, 20
#: Standard errors by which a model must predict better to be preferred to one with fewer unknowns.
SIGNIFICANT = 2.0


@dataclass(frozen=True)
class Prediction:
    """A run that was kept back, predicted by a fitted model.

    Attributes
    ----------
    run : Measurement
        The whole run.
    begin : float
        Time in s from which values are predicted; those before give the run's start.
    predicted : ndarray of shape (outputs, times)
        Measured quantities of the motion.
    residuals : ndarray of shape (outputs, times)
        Measured minus predicted values; NaN in gaps.
    """

    run: Measurement
    begin: float
    predicted: Array
    residuals: Array

    def errors(self, noise: Array) -> Array:
        """Squares of the residuals of predicted values in units of the noise, in order of time."""
        later = self.residuals[:, self.run.t >= self.begin] / noise[:, np.newaxis]
        values = later.T.ravel()
        return np.asarray(values[np.isfinite(values)] ** 2)


def predicted(fit: Fit, run: Measurement, begin: float | None = None) -> Prediction:
    """The prediction of a run by a fit: its start from the values before `begin`, the middle.

    `ValueError` where the run has no values later, `NotConvergedError` where the motion has none.
    """
    check_inputs([fit.runs[0], run])
    module, t, table = fit.outputs.module, run.t, unwrapped(fit.outputs, run)
    begin = float(t[0] + START * (t[-1] - t[0])) if begin is None else begin
    if not np.isfinite(table[:, t >= begin]).any():
        raise ValueError(
            f"{run.name} has no measured values from t = {begin:.6g} s on, where they are "
            "predicted: keep back another run"
        )
    known = run.between(-np.inf, begin)
    experiment = Experiment(fit.outputs, [known], (), fit.estimate.params)
    start = estimate(experiment, fit.estimate.starts[0], np.empty(0)).starts[0]
    span = (float(t[0]), float(t[-1]))
    held = run.held(module, fit.estimate.params)
    inputs = None if held is None else Held(t, held)
    motion = integrate(
        module, span, start, fit.params, inputs=inputs, t_eval=t, rtol=1e-10, atol=1e-10
    )
    y = np.full((len(module.STATE), len(t)), np.nan)
    y[:, : motion.y.shape[1]] = motion.y
    values = fit.outputs.values(t, y, fit.estimate.params.tolist())
    if (without := np.isfinite(table) & ~np.isfinite(values)).any():
        row, sample = np.argwhere(without)[0]
        raise NotConvergedError(
            f"{run.name}: the predicted motion has no value of {fit.outputs.names[row]} at "
            f"t = {t[sample]:.6g} s: compare models that predict all of the run"
        )
    return Prediction(run, begin, values, wrapped(table - values, fit.outputs.turns))


@dataclass(frozen=True)
class ModelCandidate:
    """A model among others: its fit and how well it predicts.

    `error` is the root mean square of predicted residuals in units of the noise; `excess` is the
    difference of mean squares from the best model, with its standard error.
    """

    name: str
    fit: Fit
    predictions: tuple[Prediction, ...]
    error: float
    excess: float = 0.0
    excess_error: float = 0.0


@dataclass(frozen=True)
class ModelComparison:
    """Candidates, and the one with the fewest unknowns that predicts as well as the best."""

    candidates: tuple[ModelCandidate, ...]
    selected: ModelCandidate

    @property
    def reason(self) -> str:
        """Why this model was selected, in a sentence."""
        best = min(self.candidates, key=lambda one: one.error)
        own, count = self.selected, counted(len(self.selected.fit.unknown), "unknown parameter")
        if own is best:
            fewer = [c for c in self.candidates if len(c.fit.unknown) < len(own.fit.unknown)]
            detail = "; simpler models predict significantly worse" if fewer else ""
            return f"{own.name}, with {count}, predicts best{detail}"
        return f"{own.name}, with {count}, predicts as well as {best.name}, within the error"


def compared(
    fits: Mapping[str, Fit], kept: Sequence[tuple[Measurement, float | None]]
) -> ModelComparison:
    """The comparison of fits by runs, each kept back from a time on, or from its middle."""
    noise = np.min([fit.estimate.noise for fit in fits.values()], axis=0)
    candidates, squares = [], {}
    for name, fit in fits.items():
        predictions = tuple(predicted(fit, *one) for one in kept)
        squares[name] = np.concatenate([one.errors(noise) for one in predictions])
        error = float(np.sqrt(squares[name].mean()))
        candidates.append(ModelCandidate(name, fit, predictions, error))
    best = min(candidates, key=lambda one: one.error)
    results = []
    for one in candidates:
        excess = squares[one.name] - squares[best.name]
        means = [block.mean() for block in np.array_split(excess, min(BLOCKS, len(excess)))]
        error = float(np.std(means, ddof=1) / np.sqrt(len(means))) if len(means) > 1 else np.inf
        results.append(replace(one, excess=float(excess.mean()), excess_error=error))
    good = [one for one in results if one.excess <= SIGNIFICANT * one.excess_error]
    selected = min(good, key=lambda one: (len(one.fit.unknown), one.error))
    return ModelComparison(tuple(results), selected)
