"""Energy over a million periods: splittings beside Gauss methods and others, at their cost."""

from collections.abc import Iterator
from dataclasses import dataclass
from operator import attrgetter

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from solvers.io.figures import coloured, legend_beside, panels
from solvers.io.terminal import text_table
from solvers.studies.failure_modes.drift import Case, Drift, drift
from solvers.studies.failure_modes.study import Load, Study

#: Start of a regular motion of Hénon and Heiles' system: x, y in m, and velocities in m/s.
START = (0.1, 0.2, 0.3, 0.2)
CASES: tuple[Case, ...] = (
    *(("rk4", "lagrangian", steps) for steps in (30, 60, 120, 240)),
    *(("leapfrog", "lagrangian", steps) for steps in (30, 60, 120, 240)),
    *(("leapfrog4", "lagrangian", steps) for steps in (5, 8, 12, 20, 32)),
    *(("leapfrog6", "lagrangian", steps) for steps in (4, 6, 8, 12, 16)),
    *(("leapfrog8", "lagrangian", steps) for steps in (5, 8, 12, 16)),
    *(("gauss4", "lagrangian", steps) for steps in (5, 8, 12)),
    *(("gauss8", "lagrangian", steps) for steps in (3, 4, 5)),
)
#: Errors at which costs are compared.
COMPARED = (1e-3, 1e-6, 1e-9)


@dataclass(frozen=True)
class Conservation(Study[list[Drift]]):
    """Energy errors of Hénon and Heiles' system in very long runs, and their cost.

    Its accelerations depend on positions alone, so that splittings integrate it.

    Attributes
    ----------
    periods : float
        Length of each run in periods of small oscillations, more than 4.
    cases : tuple of tuple
        Method, form and steps per period of each run, by rising number of steps of each method.
    """

    SMALL = (1e3,)

    periods: float = 1e6
    cases: tuple[Case, ...] = CASES

    def run(self, load: Load) -> list[Drift]:
        system = load("henon_heiles")
        return [drift(system, START, self.periods, case) for case in self.cases]

    def summary(self, results: list[Drift]) -> Iterator[str]:
        periods = max(row.periods[-1] for row in results)
        yield f"Relative energy error of Hénon and Heiles' system over {periods:.3g} periods"
        columns = {"method": "", "steps/period": "d", "calls/period": ".1f", "µs/period": ".2f"}
        columns |= {"first 1 %": ".1e", "whole run": ".1e"}
        shown = "method", "steps_per_period", "calls", "microseconds", "early_error"
        yield from text_table(columns, map(attrgetter(*shown, "largest_error"), results))
        for error in COMPARED:
            costs = {name: cost(rows, error) for name, rows in by_method(results).items()}
            known = {name: value for name, value in costs.items() if np.isfinite(value)}
            if known:
                least = min(known.values())
                ratios = ", ".join(f"{name} {value / least:.2g} x" for name, value in known.items())
                yield f"Time for an energy error of {error:.0e}: {ratios}"

    def plot(self, results: list[Drift]) -> Figure:
        title = f"Energy of Hénon and Heiles' system over {self.periods:.0e} periods"
        figure, panel_pair = panels(title, size=(10, 4.5), columns=2)
        colours = dict(coloured(d.method for d in results))
        for method, rows in by_method(results).items():
            drifts = rows[-1].exponent > 0.5  # while it has lost little energy
            style = {"color": colours[method], "linestyle": "--" if drifts else "-"}
            errors = [row.largest_error for row in rows]
            for axes, name in zip(panel_pair, ("calls", "microseconds"), strict=True):
                costs = [getattr(row, name) for row in rows]
                axes.loglog(costs, errors, marker=".", label=method, **style)
        panel_pair[0].set(
            xlabel="calls of the right-hand side per period",
            ylabel="largest energy error, relative",
        )
        panel_pair[1].set(xlabel="µs per period")
        for axes in panel_pair:  # without labels of minor ticks, which overlap on a short axis
            axes.xaxis.set_minor_formatter(NullFormatter())
            axes.xaxis.set_major_locator(LogLocator(subs=(1, 3)))
            axes.xaxis.set_major_formatter("{x:g}")
        legend_beside(panel_pair[1], fontsize="small")
        return figure


def by_method(results: list[Drift]) -> dict[str, list[Drift]]:
    """The runs of each method."""
    methods = dict.fromkeys(row.method for row in results)
    return {method: [row for row in results if row.method == method] for method in methods}


def cost(rows: list[Drift], error: float) -> float:
    """Microseconds per period of a method for an energy error, interpolated; NaN outside."""
    errors = np.log([row.largest_error for row in rows])[::-1]
    times = np.log([row.microseconds for row in rows])[::-1]
    return float(np.exp(np.interp(np.log(error), errors, times, left=np.nan, right=np.nan)))
