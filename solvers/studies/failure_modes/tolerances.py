"""Tolerances and errors: the achieved error relative to the requested error."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from math import pi

import numpy as np
from matplotlib.figure import Figure

from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.ensemble import ensemble
from solvers.io.figures import coloured, columns, legend_beside, panels
from solvers.io.terminal import text_table
from solvers.references.taylor import taylor
from solvers.runge_kutta.method_catalogue import SCIPY
from solvers.studies.failure_modes.study import Load, Study

METHODS = ("bs32", "dp54", "tsit54", "dop853", "verner853", "verner98", *SCIPY)
TOLERANCES = (1e-4, 1e-7, 1e-10)
#: Number of motions from rest at random angles with random parameters, and their duration in s.
MOTIONS, DURATION = 24, 3.0


@dataclass(frozen=True)
class ToleranceAccuracy:
    """Global error over tolerance of a method, for many motions."""

    method: str
    tolerance: float  # relative and absolute
    median: float
    worst: float
    relative_to_growth: float  # median of the same over the growth of small errors in the motion


@dataclass(frozen=True)
class Tolerances(Study[list[ToleranceAccuracy]]):
    """Global errors of double pendulums, compared with Taylor series."""

    SMALL = (("dp54", "verner98", "RK45"), 6)

    methods: tuple[str, ...] = METHODS
    motions: int = MOTIONS

    @ignore_predictability()
    def run(self, load: Load) -> list[ToleranceAccuracy]:
        pendulum = load("double_pendulum")
        generator = np.random.default_rng(3)
        count, n, span = self.motions, len(pendulum.STATE), (0.0, DURATION)
        starts = np.zeros((count, n))
        starts[:, : n // 2] = generator.uniform(-pi, pi, (count, n // 2))
        params = np.array(pendulum.DEFAULTS) * generator.uniform(0.5, 1.5, (count, 5))
        motions = zip(starts.tolist(), params.tolist(), strict=True)
        exact = np.array([taylor(pendulum, p, y0, span, digits=18)[-1] for y0, p in motions])
        solve = partial(ensemble, pendulum, span)
        carry = partial(solve, params=params.T, form="variational")
        changed = (np.hstack([starts, np.tile(unit, (count, 1))]) for unit in np.eye(n))
        carried = [carry(y0.T).y[n:].T for y0 in changed]
        growth = np.max([np.linalg.norm(change, axis=1) for change in carried], axis=0)
        results = []
        for method in self.methods:
            for tol in TOLERANCES:
                y = solve(starts.T, params.T, method=method, rtol=tol, atol=tol).y.T
                ratio = np.abs(y - exact).max(axis=1) / tol
                figures = np.median(ratio), ratio.max(), np.median(ratio / growth)
                results.append(ToleranceAccuracy(method, tol, *map(float, figures)))
        return results

    def summary(self, results: list[ToleranceAccuracy]) -> Iterator[str]:
        yield f"Achieved over requested error of double pendulums, {DURATION:g} s: median, worst"
        specs = dict.fromkeys((f"tolerance {row.tolerance:.0e}" for row in results), ">")
        cells: dict[str, list[str]] = {}
        for row in results:
            cells.setdefault(row.method, []).append(f"{row.median:.3g}, {row.worst:.3g}")
        yield from text_table({"method": ""} | specs, ((m, *c) for m, c in cells.items()))

    def plot(self, results: list[ToleranceAccuracy]) -> Figure:
        title = "Achieved over requested error: medians (dots) and worst of many motions"
        figure, (axes,) = panels(title, size=(9, 4.5))
        methods = list(dict.fromkeys(row.method for row in results))
        for k, (tolerance, colour) in enumerate(coloured(row.tolerance for row in results)):
            rows = [row for row in results if row.tolerance == tolerance]
            x = [methods.index(row.method) + 0.15 * (k - 1) for row in rows]
            medians, worst = columns(rows, "median", "worst")
            axes.vlines(x, medians, worst, colour)
            axes.plot(x, medians, "o", color=colour, label=f"tolerance {tolerance:.0e}")
        axes.axhline(1, color="#888888")
        axes.set(yscale="log", ylabel="error / tolerance", xticks=range(len(methods)))
        axes.set_xticklabels(methods, rotation=45)
        legend_beside(axes)
        return figure
