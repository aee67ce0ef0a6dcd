"""Chaos: the largest Lyapunov exponent, growth of errors, the horizon, and means beyond it."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf, log, pi
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from solvers.equations.energy import energy_error
from solvers.equations.module import GeneratedModule
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.integrate import integrate
from solvers.integration.prepare import prepare
from solvers.io.figures import COLOURS, coloured, columns, panels
from solvers.io.terminal import text_table
from solvers.references.taylor import taylor
from solvers.studies.failure_modes.study import Load, Study

#: Time in s after which a perturbation is scaled back to length 1; intervals left out at first.
INTERVAL, TRANSIENT = 1.0, 100
TOLERANCE = 1e-9
Array = NDArray[np.float64]

#: Parts of a run of this duration in s count as independent; the least and largest number of parts.
INDEPENDENT, FEWEST, MOST = 150.0, 8, 40


@dataclass(frozen=True)
class Mean:
    """A mean over time, with its standard error."""

    value: float
    error: float

    def __str__(self) -> str:
        return f"{self.value:.4g} ± {self.error:.1g}"

    @classmethod
    def of(cls, values: Array, duration: float) -> "Mean":
        """The mean of correlated values, with the error from the means of blocks."""
        count = int(np.clip(duration / INDEPENDENT, FEWEST, MOST))
        blocks = np.array([part.mean() for part in np.array_split(values, count)])
        return cls(float(blocks.mean()), float(blocks.std(ddof=1) / np.sqrt(count)))


def lyapunov(
    module: GeneratedModule, params: Sequence[float], y0: Sequence[float], duration: float
) -> "Mean":
    """The largest Lyapunov exponent in 1/s, along the motion from `y0`.

    The variational equations carry a linear perturbation along, which is scaled back to length 1
    every second. The exponent is the mean of the logarithms of its growth (G. Benettin,
    L. Galgani, J.-M. Strelcyn, Physical Review A 14, 2338, 1976).

    Parameters
    ----------
    module : module
        A generated module.
    params : sequence of float
        In the order of ``module.PARAMETERS``.
    y0 : sequence of float
        Initial coordinates and velocities, in the order of ``module.STATE``.
    duration : float
        Length of the mean in s, `FEWEST` at least, rounded down to whole seconds. The first
        `TRANSIENT` seconds of the motion precede it.

    Returns
    -------
    Mean
        The exponent and its standard error, both in 1/s.

    Raises
    ------
    ValueError
        When an argument is invalid.
    solvers.integration.prepare.NotFinishedError
        When the motion does not last that long.
    """
    advance = _advance(module, params)
    n = len(module.STATE)
    state = np.array([*y0, *np.ones(n) / np.sqrt(n)])
    growth = []
    for _ in range(TRANSIENT + int(duration / INTERVAL)):
        state = np.array(advance(state.tolist()))
        length = float(np.linalg.norm(state[n:]))
        state[n:] /= length
        growth.append(log(length) / INTERVAL)
    return Mean.of(np.array(growth[TRANSIENT:]), duration)


def _advance(
    module: GeneratedModule, params: Sequence[float]
) -> Callable[[list[float]], ArrayLike]:
    """A function that advances a motion and a linear perturbation by one interval."""
    span, tol = (0.0, INTERVAL), TOLERANCE
    try:
        return partial(prepare(module, params, form="variational", rtol=tol, atol=tol), span)
    except NoCompilerError:
        solve = partial(integrate, form="variational", backend="python", t_eval=[INTERVAL])
        run = ignore_predictability()(solve)
        return lambda y: run(module, span, y, params, rtol=tol, atol=tol).y[:, -1]


#: Tolerances of the runs.
TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
#: Initial difference of two motions, and the distance up to which they are close.
OFFSET, CLOSE = 1e-12, 1e-2
#: Digits of references (double precision is lost within 40 s), and samples per second.
DIGITS, SAMPLES = 30, 10
#: Error in rad or rad/s at which a trajectory is lost.
LOST = 1.0


@dataclass(frozen=True)
class Separation:
    """Growth of a small difference of two motions."""

    t: Array  # in s
    distance: Array  # length of the difference of states, from two references
    predicted: Array  # the same to first order, from the variational equations
    rate: float  # growth rate in 1/s while the difference is small


@dataclass(frozen=True)
class Horizon:
    """Time until which a trajectory is right."""

    method: str
    tolerance: float  # relative and absolute
    predicted: float  # ln(1/tolerance)/exponent in s
    measured: float  # time in s at which the error reaches `LOST`
    energy_error: float  # the largest of the run


def reference_motion(
    module: GeneratedModule, y0: Sequence[float], duration: float
) -> tuple[Array, Array]:
    """Times, and states at these times with more digits than chaos loses."""
    t = np.linspace(0, duration, round(SAMPLES * duration) + 1)
    return t, taylor(module, module.DEFAULTS, y0, t, DIGITS)


def separation(module: GeneratedModule, t: Array, reference: Array) -> Separation:
    """Growth of `OFFSET` in the first coordinate, compared with a reference."""
    params, n = module.DEFAULTS, reference.shape[1]
    near = reference[0] + OFFSET * np.eye(n)[0]
    distance = np.linalg.norm(taylor(module, params, near.tolist(), t, DIGITS) - reference, axis=1)
    start = [*reference[0], *(near - reference[0])]
    solve = partial(integrate, form="variational", rtol=1e-12, atol=1e-30, t_eval=t)
    with ignore_predictability():
        carried = solve(module, (0, t[-1]), start, params).y[n:]
    close = (distance < CLOSE) & (t > 0)
    rate = np.polyfit(t[close], np.log(distance[close]), 1)[0]
    return Separation(t, distance, np.linalg.norm(carried, axis=0), float(rate))


def horizon(
    module: GeneratedModule, t: Array, reference: Array, exponent: float, method: str, tol: float
) -> Horizon:
    """Horizon of a method with a tolerance, compared with a reference."""
    solve = partial(integrate, method=method, rtol=tol, atol=tol, t_eval=t, energy=True)
    with ignore_predictability():
        run = solve(module, (0, t[-1]), reference[0], module.DEFAULTS)
    assert run.energy is not None
    lost = np.abs(run.y.T - reference).max(axis=1) > LOST
    measured = float(t[np.argmax(lost)]) if lost.any() else inf
    error = float(np.abs(energy_error(module, module.DEFAULTS, run.energy)).max())
    return Horizon(method, tol, log(1 / tol) / exponent, measured, error)


def plot_separation(axes: Axes, apart: Separation, exponent: float) -> None:
    """Plot the growth of the difference over time."""
    expected = OFFSET * np.exp(exponent * apart.t)
    axes.semilogy(apart.t, apart.distance, color=COLOURS[0], label="two references")
    axes.semilogy(apart.t, apart.predicted, ":", color=COLOURS[1], label="variational equations")
    axes.semilogy(apart.t, expected, color="#888888", label=f"exp({exponent:.3f} t)")
    axes.set(xlabel="time / s", ylabel="distance of two motions", ylim=(1e-13, 100))
    axes.legend(frameon=False)


def plot_horizons(axes: Axes, rows: Sequence[Horizon]) -> None:
    """Plot measured and predicted horizons over the tolerance."""
    for method, colour in coloured(row.method for row in rows):
        lost = [row for row in rows if row.method == method and row.measured < inf]
        axes.semilogx(*columns(lost, "tolerance", "measured"), "o", color=colour, label=method)
    predicted = {row.tolerance: row.predicted for row in rows}
    axes.semilogx(
        [*predicted], [*predicted.values()], color="#888888", label="ln(1/tolerance)/exponent"
    )
    axes.set(xlabel="tolerance", ylabel="horizon / s")
    axes.legend(frameon=False)


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
    separation: Separation
    horizons: list[Horizon]
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
        reference = reference_motion(double, CHAOTIC, self.horizon_seconds)
        horizons = [
            horizon(double, *reference, exponent.value, method, tolerance)
            for method in self.methods
            for tolerance in TOLERANCES
        ]
        means = [statistics(double, self.statistics_seconds, run) for run in LONG_RUNS]
        return ChaosResults(exponent, separation(double, *reference), horizons, means)

    def summary(self, results: ChaosResults) -> Iterator[str]:
        apart = results.separation
        close = apart.distance < CLOSE
        linear = abs(apart.distance[close] / apart.predicted[close] - 1).max()
        yield f"Chaos, the report's motion: largest Lyapunov exponent {results.exponent} per s"
        yield (
            f"a difference of {OFFSET:g} grows as e^({apart.rate:.3f} t) while it is "
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
        plot_separation(growth, results.separation, results.exponent.value)
        plot_horizons(horizons, results.horizons)
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
