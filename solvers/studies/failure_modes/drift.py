"""Energy in long runs: Runge–Kutta methods lose it, symplectic methods keep it bounded."""

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from math import pi
from operator import attrgetter
from time import perf_counter

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from solvers.equations.energy import energy_error
from solvers.equations.linearisation.normal_modes import Modes
from solvers.equations.module import GeneratedModule
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.io.figures import coloured, legend_beside, panels
from solvers.io.terminal import text_table
from solvers.studies.failure_modes.study import Load, Study

Array = NDArray[np.float64]
#: A method, a form, and steps per period of the slow mode.
Case = tuple[str, str, int]

#: Start of a regular, nonlinear motion of the double pendulum: angles in rad, at rest.
START = (0.5, 0.6, 0.0, 0.0)
CASES: tuple[Case, ...] = (
    ("rk4", "lagrangian", 60),
    ("dp54", "lagrangian", 40),
    ("verner853", "lagrangian", 15),
    ("radau3", "lagrangian", 20),
    ("gauss1", "hamiltonian", 60),
    ("gauss2", "hamiltonian", 30),
    ("gauss3", "hamiltonian", 20),
    ("gauss2", "lagrangian", 30),
)
#: Energy is sampled in this many blocks, spaced logarithmically; and their length in periods.
BLOCKS, LENGTH = 40, 3


@dataclass(frozen=True)
class Drift:
    """Energy error and cost of a long run; times are in periods of the slow mode."""

    method: str
    form: str
    steps_per_period: int
    periods: Array  # times
    energy_error: Array  # at these times, relative
    exponent: float  # the largest error grows with this power: 1 for a steady drift, 0 for none
    rate: float  # drift per period, from a straight line fitted to the whole run
    early_error: float  # the largest in the first hundredth of the run
    largest_error: float  # the largest in the whole run
    calls: float  # of the right-hand side, per period
    microseconds: float  # of a period, once the loop is compiled


@ignore_predictability()
def drift(module: GeneratedModule, start: Sequence[float], periods: float, case: Case) -> Drift:
    """Energy error of a system over a number of periods of its slow mode."""
    params, (method, form, steps) = module.DEFAULTS, case
    period = 2 * pi / Modes.at_rest(module, params).frequencies[0]
    h = period / steps
    # blocks hold whole periods, so that oscillations of the error are sampled completely
    blocks = np.logspace(0, np.log10(periods - LENGTH), BLOCKS) * steps
    ends = np.unique(blocks.astype(np.int64)[:, None] + np.arange(LENGTH * steps))
    solve = partial(integrate, method=method, form=form, h=h, energy=True, max_steps=10**9)
    solve(module, (0, h), start, params)  # compiles the loop
    before = perf_counter()
    run = solve(module, (0, periods * period), start, params, t_eval=h * np.array([0, *ends]))
    costs = run.nfev / periods, 1e6 * (perf_counter() - before) / periods
    assert run.energy is not None
    error = energy_error(module, params, run.energy)
    t = run.t / period
    largest = np.maximum.accumulate(np.abs(error))
    late = t >= periods / 100
    exponent = float(np.polyfit(np.log(t[late]), np.log(largest[late]), 1)[0])
    rate = float(np.polyfit(t, error, 1)[0])
    errors = float(largest[~late][-1]), float(largest[-1])
    return Drift(method, form, steps, t, error, exponent, rate, *errors, *costs)


@dataclass(frozen=True)
class EnergyDrift(Study[list[Drift]]):
    """Energy errors of the double pendulum in long runs.

    Attributes
    ----------
    periods : float
        Length of each run in periods of the slow mode, more than 4.
    cases : tuple of tuple
        Method, form and steps per period of each run; at most seven methods.
    """

    SMALL = (1e3,)

    periods: float = 1e5
    cases: tuple[Case, ...] = CASES

    def run(self, load: Load) -> list[Drift]:
        pendulum = load("double_pendulum")
        with ThreadPoolExecutor() as pool:
            try:
                return list(pool.map(partial(drift, pendulum, START, self.periods), self.cases))
            except KeyboardInterrupt:
                pool.shutdown(wait=False, cancel_futures=True)
                raise

    def summary(self, results: list[Drift]) -> Iterator[str]:
        periods = max(row.periods[-1] for row in results)
        yield f"Relative energy error of the double pendulum over {periods:.3g} periods"
        columns = {"method": "", "form": "", "steps/period": "d"}
        columns |= {"first 1 %": ".1e", "whole run": ".1e", "drift/period": ".1e"}
        columns |= {"exponent": ".2f"}
        shown = "method", "form", "steps_per_period", "early_error", "largest_error"
        yield from text_table(columns, map(attrgetter(*shown, "rate", "exponent"), results))

    def plot(self, results: list[Drift]) -> Figure:
        title = "Energy in long runs: lost by Runge-Kutta methods, kept by symplectic methods"
        figure, (axes,) = panels(title, size=(8, 5))
        colours = dict(coloured(d.method for d in results))
        for d in results:
            largest = np.maximum.accumulate(np.abs(d.energy_error))[1:]
            label = f"{d.method}, {d.form}, {d.steps_per_period} steps per period"
            style = "-" if d.form == "hamiltonian" else "--"
            axes.loglog(d.periods[1:], largest, style, color=colours[d.method], label=label)
        axes.set(xlabel="periods of the slow mode", ylabel="largest energy error so far, relative")
        legend_beside(axes, fontsize="small")
        return figure
