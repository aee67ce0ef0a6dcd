"""Chaos: growth of errors, the predictability horizon, and means beyond it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from math import inf, pi
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from solvers.equations.energy import energy_error
from solvers.equations.module import GeneratedModule
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.io.figures import panels
from solvers.io.text_table import text_table
from solvers.studies.failure_modes import horizon
from solvers.studies.failure_modes.largest_exponent import Mean, lyapunov
from solvers.studies.failure_modes.study import Load, Study

#: The report's motion of the double pendulum from rest, which is chaotic.
CHAOTIC = (pi / 2, pi, 0.0, 0.0)
#: Methods whose horizons are measured.
METHODS = ("bs32", "dp54", "tsit54", "dop853", "verner853", "verner98")
#: Runs beyond many horizons: three families of accurate methods, and one whose energy drifts.
LONG_RUNS: tuple[Mapping[str, Any], ...] = (
    {"method": "verner98", "rtol": 1e-11, "atol": 1e-11},
    {"method": "dop853", "rtol": 1e-10, "atol": 1e-10},
    {"method": "gauss3", "form": "hamiltonian", "h": 0.025},
    {"method": "rk4", "form": "lagrangian", "h": 0.02},
)


@dataclass(frozen=True)
class Statistics:
    """Means over a run that is many horizons long."""

    run: str  # method and tolerance or step
    energy_error: float  # at the end
    kinetic: Mean  # kinetic energy in J
    upright: Mean  # fraction of time with the second bob above its joint


@dataclass(frozen=True)
class ChaosResults:
    """Exponent in 1/s, separation, horizons and statistics of one motion."""

    exponent: Mean
    separation: horizon.Separation
    horizons: list[horizon.Horizon]
    statistics: list[Statistics]


@dataclass(frozen=True)
class Chaos(Study[ChaosResults]):
    """The report's motion: its exponent, its horizons, and means beyond them.

    Attributes
    ----------
    exponent_seconds, horizon_seconds, statistics_seconds : float
        Durations of the three parts in s.
    methods : tuple of str
        Methods whose horizons are measured.
    """

    SMALL = (1e4, 20.0, 5e3, ("dp54", "verner98"))

    exponent_seconds: float = 1e5
    horizon_seconds: float = 40.0
    statistics_seconds: float = 5e4
    methods: tuple[str, ...] = METHODS

    def run(self, load: Load) -> ChaosResults:
        double = load("double_pendulum")
        exponent = lyapunov(double, double.DEFAULTS, CHAOTIC, self.exponent_seconds)
        reference = horizon.reference_motion(double, CHAOTIC, self.horizon_seconds)
        horizons = [
            horizon.horizon(double, *reference, exponent.value, method, tolerance)
            for method in self.methods
            for tolerance in horizon.TOLERANCES
        ]
        means = [statistics(double, self.statistics_seconds, run) for run in LONG_RUNS]
        return ChaosResults(exponent, horizon.separation(double, *reference), horizons, means)

    def summary(self, results: ChaosResults) -> Iterator[str]:
        apart = results.separation
        close = apart.distance < horizon.CLOSE
        linear = abs(apart.distance[close] / apart.predicted[close] - 1).max()
        yield f"Chaos, the report's motion: largest Lyapunov exponent {results.exponent} per s"
        yield (
            f"a difference of {horizon.OFFSET:g} grows as e^({apart.rate:.3f} t) while it is "
            f"small, for {apart.t[close][-1]:.1f} s; "
            f"relative error of the variational equations {linear:.1g}"
        )
        yield "horizon ln(1/tolerance)/exponent, and the time at which the error reaches 1, in s:"
        rows: dict[float, list[object]] = {}
        for row in results.horizons:
            cells = rows.setdefault(row.tolerance, [row.tolerance, row.predicted])
            cells.append(row.measured if row.measured < inf else "later")
        columns = {"tolerance": ".0e", "predicted": ".1f"}
        columns |= dict.fromkeys((row.method for row in results.horizons), ".1f")
        yield from text_table(columns, rows.values())
        yield "means over many horizons: final energy error, kinetic energy, time with bob 2 up"
        columns = {"run": "", "energy error": ".0e", "kinetic/J": "", "bob 2 up": ""}
        means = ((s.run, s.energy_error, s.kinetic, s.upright) for s in results.statistics)
        yield from text_table(columns, means)

    def plot(self, results: ChaosResults) -> Figure:
        figure, (growth, horizons) = panels("Chaos in the report's motion", columns=2)
        horizon.plot_separation(growth, results.separation, results.exponent.value)
        horizon.plot_horizons(horizons, results.horizons)
        return figure


def statistics(module: GeneratedModule, duration: float, options: Mapping[str, Any]) -> Statistics:
    """Means over a run whose trajectory agrees with no other."""
    t = np.linspace(0, duration, int(2 * duration) + 1)
    solve = partial(integrate, t_eval=t, energy=True, max_steps=10**8)
    with ignore_predictability():
        run = solve(module, (0, duration), CHAOTIC, module.DEFAULTS, **options)
    assert run.energy is not None
    at_rest = run.y.copy()
    at_rest[len(CHAOTIC) // 2 :] = 0.0
    kinetic = run.energy - module.energy_many(0.0, at_rest, module.DEFAULTS)
    error = float(energy_error(module, module.DEFAULTS, run.energy)[-1])
    is_up = (np.cos(run.y[1]) < 0).astype(float)
    name = run.run.rpartition(", ")[0]
    return Statistics(name, error, Mean.of(kinetic, duration), Mean.of(is_up, duration))
