"""Times of one motion from many starts of several systems, at equal measured error.

For each start the fastest explicit method, the fastest method with parallel stages and heyoka, with
our equations, are compared at the same global error, interpolated on each program's own curve.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from benchmarks import heyoka
from benchmarks.median_times import median_times
from benchmarks.motions import Array, Curves, Runs, tolerances
from solvers.equations.forms import Form, fastest_form
from solvers.equations.module import GeneratedModule
from solvers.integration.prepare import NotFinishedError, prepare
from solvers.io.terminal import text_table
from solvers.studies.work_precision.cost_curve import work_at

#: Systems, and the largest coordinates and velocities of their random starts.
SYSTEMS = {
    "double_pendulum": (2.0, 1.0),
    "double_bar_pendulum": (2.0, 1.0),
    "cart_3": (0.5, 0.5),
    "swinging_atwood": (0.3, 0.3),
}
STARTS, DURATION, ERRORS = 20, 5.0, (1e-3, 1e-6, 1e-9, 1e-12)
RATIOS, COLUMNS = ("parallel", "heyoka"), ("median", "smallest")
METHODS = {"explicit": ("verner853", "verner98"), "parallel": ("gauss4", "gauss8")}


def random_starts(module: GeneratedModule, largest: tuple[float, float]) -> Array:
    """States near the defaults' rest, shape (`STARTS`, state)."""
    n = len(module.COORDINATES)
    scale = np.repeat(largest, (n, len(module.STATE) - n))
    starts = np.random.default_rng(7).uniform(-scale, scale, (STARTS, len(module.STATE)))
    positive = [k for k, name in enumerate(module.STATE) if name in module.POSITIVE]
    starts[:, positive] = 1.0 + np.abs(starts[:, positive])
    return starts


def figures(modules: Mapping[str, GeneratedModule], hy: Any) -> list[dict[str, Any]]:
    """Ratios of times to the fastest explicit method, for each system and error."""
    rows = []
    for name, module in modules.items():
        starts = random_starts(module, SYSTEMS[name])
        curves = [_curves(module, start, hy) for start in starts]
        rows += [_row(name, error, curves) for error in ERRORS]
    return rows


def _curves(module: GeneratedModule, start: Array, hy: Any) -> Curves:
    form = Form(module, fastest_form(module), module.DEFAULTS)
    system, state = heyoka.generated(hy, module), form.from_ordinary(0.0, start)
    exact = heyoka.reference(hy, system, state[np.newaxis], module.DEFAULTS, DURATION)[0]
    curves: Curves = {}
    for tol in map(float, tolerances(-1, -15)):
        ready = partial(prepare, module, module.DEFAULTS, rtol=tol, atol=tol)
        methods = [method for group in METHODS.values() for method in group]
        runs: Runs = {m: partial(_end, ready(method=m), start, form) for m in methods}
        runs["heyoka"] = heyoka.single(hy, system, state.tolist(), module.DEFAULTS, DURATION, tol)
        errors = {m: float(np.abs(run() - exact).max()) for m, run in runs.items()}
        valid = {m: run for m, run in runs.items() if errors[m] < 1}
        for m, time in median_times(valid, 0.0).items() if valid else ():
            curves.setdefault(m, []).append((time, errors[m]))
    return curves


def _end(run: Callable[..., Sequence[float]], start: Array, form: Form) -> Array:
    """The final state in the form's own variables, without whole turns of angles."""
    try:
        return form.from_ordinary(DURATION, np.array(run((0.0, DURATION), start.tolist())))
    except NotFinishedError:  # the tolerance is too loose for this method
        return np.full(len(form.state), np.nan)


def _row(system: str, error: float, curves: Sequence[Curves]) -> dict[str, Any]:
    ratios: dict[str, list[float]] = {name: [] for name in RATIOS}
    for curve in curves:
        times = {m: work_at(error, [e for _, e in p], [t for t, _ in p]) for m, p in curve.items()}
        best = {
            group: min((times[m] for m in members if times.get(m, 0) > 0), default=np.nan)
            for group, members in METHODS.items()
        }
        ratios["parallel"].append(best["explicit"] / best["parallel"])
        ratios["heyoka"].append(times.get("heyoka", np.nan) / min(best.values()))
    row: dict[str, Any] = {"system": system, "global_error": error}
    for name, values in ratios.items():
        known = [value for value in values if np.isfinite(value) and value > 0]
        low, middle, high = np.percentile(known, [0, 50, 100]) if known else [np.nan] * 3
        row[name] = {"smallest": low, "median": middle, "largest": high, "starts": len(known)}
    return row


def summary(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """A table of the ratios."""
    head = {"system": "", "error": ".0e"}
    head |= {f"{a}, {b}": ".2f" for a in ("explicit / parallel", "heyoka / ours") for b in COLUMNS}
    cells = [
        [row["system"], row["global_error"], *(row[k][n] for k in RATIOS for n in COLUMNS)]
        for row in rows
    ]
    return [*text_table(head, cells), ""]
