"""A fit and a comparison of models as text, as values for JSON, and as tables."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from solvers.io.quantity import with_unit
from solvers.io.suggestion import counted
from solvers.io.terminal import text_table
from solvers.scenes.fitting.fitted_model import Fit
from solvers.scenes.fitting.prediction import ModelComparison

#: Correlations that are mentioned.
STRONG = 0.9


def summary(fit: Fit) -> Iterator[str]:
    """Lines on the values, their intervals, the noise and reasons for doubt."""
    units, module = fit.outputs.module.UNITS, fit.outputs.module
    values = sum(run.count for run in fit.runs)
    names = ", ".join(fit.outputs.names)
    yield (
        f"{counted(values, 'value')} of {names} in {counted(len(fit.runs), 'run')}, "
        f"{counted(len(fit.unknown), 'unknown parameter')}"
    )
    if inputs := ", ".join(fit.runs[0].inputs):
        yield f"inputs: {inputs}"
    for name, reason in fit.held.items():
        yield f"held: {name} = {with_unit(fit.params[name], units[name])}: {reason}"
    rows = []
    for name, interval in fit.intervals.items():
        digits = _decimals(interval.error)
        ends = f"{interval.low:.{digits}f} to {interval.high:.{digits}f}"
        rows.append(
            (
                name,
                f"{interval.value:.{digits}f}",
                f"{interval.error:.{digits}f}",
                ends,
                units[name],
            )
        )
    heads = ("parameter", "value", "error", "95 % interval", "unit")
    if rows:
        yield ""
        yield from text_table(dict.fromkeys(heads, ""), rows)
        yield ""
    strong = [
        f"{a} and {b} {fit.correlations[i, j]:+.3f}"
        for i, a in enumerate(fit.unknown)
        for j, b in enumerate(fit.unknown[:i])
        if abs(fit.correlations[i, j]) > STRONG
    ]
    if strong:
        yield f"strong correlations: {', '.join(strong)}"
    all_units = zip(fit.outputs.names, fit.outputs.units, strict=True)
    noise = [f"{name} {with_unit(fit.noise[name], unit, 2)}" for name, unit in all_units]
    yield f"noise (standard deviation): {', '.join(noise)}"
    for run, start in zip(fit.runs, fit.starts, strict=True):
        state = ", ".join(f"{q} = {with_unit(start[q], units[q], 4)}" for q in module.STATE)
        yield f"start of {run.name} at t = {run.t[0]:g} s: {state}"
    for note in fit.notes:
        yield f"note: {note}"


def comparison_lines(comparison: ModelComparison) -> Iterator[str]:
    """Lines on models and their predictions."""
    heads = {"model": "", "unknown": "d", "error of prediction / noise": ".3f", "selected": ""}
    rows = [
        (one.name, len(one.fit.unknown), one.error, "yes" if one is comparison.selected else "")
        for one in comparison.candidates
    ]
    yield from text_table(heads, rows)
    yield f"selected: {comparison.reason}"


def figures(fit: Fit) -> dict[str, Any]:
    """The same as values for JSON."""
    units = fit.outputs.module.UNITS
    parameters = {
        name: {
            "value": one.value,
            "error": one.error,
            "interval_95": [one.low, one.high],
            "unit": units[name],
        }
        for name, one in fit.intervals.items()
    }
    return {
        "system": fit.outputs.module.SYSTEM,
        "inputs": [*fit.runs[0].inputs],
        "parameters": parameters,
        "held": {
            name: {"value": fit.params[name], "reason": why} for name, why in fit.held.items()
        },
        "correlations": fit.correlations,
        "noise": fit.noise,
        "degrees_of_freedom": fit.estimate.degrees,
        "runs": {run.name: start for run, start in zip(fit.runs, fit.starts, strict=True)},
        "notes": fit.notes,
    }


def comparison_figures(comparison: ModelComparison) -> dict[str, Any]:
    """A comparison as values for JSON."""
    models = {
        one.name: {"unknown": len(one.fit.unknown), "prediction_error_over_noise": one.error}
        for one in comparison.candidates
    }
    return {"models": models, "selected": comparison.selected.name, "reason": comparison.reason}


def table(fit: Fit) -> str:
    """Measured and fitted values and residuals of all runs as comma-separated text."""
    kinds = ("measured", "fitted", "residual")
    heads = ["run", "t", *(f"{name} {kind}" for name in fit.outputs.names for kind in kinds)]
    lines = [",".join(f'"{head}"' if "," in head else head for head in heads)]
    for run, curve, residuals in zip(fit.runs, fit.fitted, fit.residuals, strict=True):
        columns = [
            part for pair in zip(curve + residuals, curve, residuals, strict=True) for part in pair
        ]
        for t, *row in np.column_stack([run.t, *columns]):
            cells = (f"{value:.9g}" if np.isfinite(value) else "" for value in row)
            lines.append(",".join([f'"{run.name}"', f"{t:.9g}", *cells]))
    return "\n".join(lines) + "\n"


def scene_text(fit: Fit, system: str, comments: Sequence[str]) -> str:
    """A scene file with the fitted parameters and the start of the first run."""
    run, start = fit.runs[0], fit.starts[0]
    lines = [f"# {line}" for line in comments]
    lines += [f'system = "{system}"', f"duration = {float(run.t[-1] - run.t[0])!r}  # s"]
    lines += ["", "[parameters]", *(f"{name} = {value!r}" for name, value in fit.params.items())]
    lines += ["", "[initial]", *(f"{name} = {value!r}" for name, value in start.items())]
    return "\n".join(lines) + "\n"


def _decimals(error: float) -> int:
    """Digits behind the point so that an error has two of its own."""
    return int(np.clip(1 - np.floor(np.log10(error)), 0, 12)) if 0 < error < np.inf else 6
