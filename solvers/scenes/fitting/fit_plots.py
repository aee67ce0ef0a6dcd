"""Plots of a fit: data over the fitted motion, and residuals over time and by size."""

from collections.abc import Sequence

import numpy as np
import scipy
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solvers.equations.number_checks import Array
from solvers.io.figure_names import axis_label, symbol
from solvers.io.figures import COLOURS, colours, panels
from solvers.scenes.fitting.fitted_model import Fit
from solvers.scenes.fitting.prediction import ModelComparison, Prediction
from solvers.scenes.fitting.statistics import autocorrelation

#: Most lags of autocorrelations, and bins of histograms.
LAGS, BINS = 40, 30
GREY = "#999999"


def figure(fit: Fit, title: str) -> Figure:
    """A row for each measured quantity: data and motion, residuals, histogram, autocorrelation."""
    count = len(fit.outputs.names)
    chart, axes = panels(title, rows=count, columns=4, size=(16, 0.6 + 2.9 * count))
    for k in range(count):
        motion, over_time, histogram, correlation = axes[4 * k : 4 * k + 4]
        _draw_motion(motion, fit, k)
        _draw_residuals(over_time, fit, k)
        values = np.concatenate([residuals[k] for residuals in fit.residuals])
        values = values[np.isfinite(values)] / fit.estimate.noise[k]
        _draw_histogram(histogram, values)
        _draw_autocorrelation(
            correlation, [residuals[k] for residuals in fit.residuals], len(values)
        )
    return chart


def prediction_figure(comparison: ModelComparison, title: str) -> Figure:
    """A row for each run that was kept back: the selected model's prediction and all residuals."""
    own = comparison.selected
    count = len(own.predictions)
    names = own.fit.outputs.names
    chart, axes = panels(
        title, rows=count * len(names), columns=2, size=(12, 0.6 + 2.9 * count * len(names))
    )
    pairs = [(run, k) for run in range(count) for k in range(len(names))]
    for row, (run, k) in enumerate(pairs):
        _draw_prediction(axes[2 * row], own.predictions[run], own.fit, k)
        panel = axes[2 * row + 1]
        for one, colour in zip(comparison.candidates, COLOURS, strict=False):
            prediction = one.predictions[run]
            panel.plot(prediction.run.t, prediction.residuals[k], ".", ms=3, color=colour,
                label=one.name)  # fmt: skip
        panel.axvspan(own.predictions[run].run.t[0], own.predictions[run].begin, color="#eeeeee")
        panel.set(xlabel="t / s", ylabel=f"residual of {_label(own.fit, k)}")
        if not row:
            panel.legend(frameon=False, fontsize="small")
    return chart


def _draw_motion(panel: Axes, fit: Fit, k: int) -> None:
    for run, curve, residuals, colour in zip(
        fit.runs, fit.fitted, fit.residuals, colours(len(fit.runs)), strict=True
    ):
        panel.plot(run.t, curve[k] + residuals[k], ".", ms=4, color=GREY)
        panel.plot(run.t, curve[k], "-", lw=1, color=colour, label=run.name)
    panel.set(xlabel="t / s", ylabel=_label(fit, k))
    if len(fit.runs) > 1 and k == 0:
        panel.legend(frameon=False, fontsize="small")


def _draw_prediction(panel: Axes, prediction: Prediction, fit: Fit, k: int) -> None:
    t, begin = prediction.run.t, prediction.begin
    panel.plot(t, prediction.predicted[k] + prediction.residuals[k], ".", ms=3, color=GREY)
    panel.plot(t, prediction.predicted[k], "-", lw=1, color=COLOURS[0])
    panel.axvspan(t[0], begin, color="#eeeeee", zorder=0)
    panel.set(xlabel="t / s", ylabel=_label(fit, k), title=f"{prediction.run.name}: kept back")


def _draw_residuals(panel: Axes, fit: Fit, k: int) -> None:
    for run, residuals, colour in zip(fit.runs, fit.residuals, colours(len(fit.runs)), strict=True):
        panel.plot(run.t, residuals[k], ".", ms=3, color=colour)
    for side in (-2, 2):
        panel.axhline(side * fit.estimate.noise[k], color=GREY, lw=0.8, ls="--")
    panel.axhline(0, color=GREY, lw=0.8)
    panel.set(xlabel="t / s", ylabel=f"residual of {_label(fit, k)}")


def _draw_histogram(panel: Axes, values: Array) -> None:
    panel.hist(values, bins=BINS, density=True, color=COLOURS[5], alpha=0.7)
    x = np.linspace(scipy.special.ndtri(1e-4), -scipy.special.ndtri(1e-4), 200)
    panel.plot(x, np.exp(-(x**2) / 2) / np.sqrt(2 * np.pi), color=COLOURS[6], lw=1)
    panel.set(xlabel="residual / noise", ylabel="density")


def _draw_autocorrelation(panel: Axes, residuals: Sequence[Array], count: int) -> None:
    lags = min(LAGS, *(len(values) - 1 for values in residuals))
    values = autocorrelation(residuals, lags + 1)[1:]
    panel.vlines(np.arange(1, lags + 1), 0, values, color=COLOURS[0], lw=2)
    for side in (-2, 2):
        panel.axhline(side / np.sqrt(count), color=GREY, lw=0.8, ls="--")
    panel.axhline(0, color=GREY, lw=0.8)
    panel.set(xlabel="lag / samples", ylabel="autocorrelation", ylim=(-1, 1))


def _label(fit: Fit, k: int) -> str:
    name, unit = fit.outputs.names[k], fit.outputs.units[k]
    text = symbol(name) if name in fit.outputs.module.STATE else name
    return axis_label(text, unit) if unit else text
