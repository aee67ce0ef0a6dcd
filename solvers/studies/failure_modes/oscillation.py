"""Growing oscillations: by Euler's method with any step, by other methods beyond a limit."""

from collections.abc import Iterator
from dataclasses import astuple, dataclass
from functools import partial
from math import log, pi

import numpy as np
from matplotlib.figure import Figure

from solvers.equations.module import GeneratedModule
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.io.figures import coloured, columns, panels
from solvers.io.terminal import text_table
from solvers.runge_kutta.method_catalogue import load as load_method
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.studies.failure_modes.study import Load, Study

#: Initial angle in rad: small enough for linear motion.
AMPLITUDE = 1e-6
#: Steps per period of the methods whose oscillations always grow.
STEPS_PER_PERIOD = (20.0, 100.0, 500.0, 2500.0)


@dataclass(frozen=True)
class Growth:
    """Growth of a small oscillation: logarithm of the amplitude's growth over a period."""

    method: str
    steps_per_period: float
    predicted: float
    measured: float


@ignore_predictability()
def growth(pendulum: GeneratedModule, method: str, steps_per_period: float) -> Growth:
    """Growth of a small oscillation of the single pendulum, predicted from R(z) and measured."""
    length, gravity = pendulum.DEFAULTS[1:]
    frequency = np.sqrt(gravity / length)
    function = StabilityFunction.of(load_method(method))
    factor = abs(complex(function(2j * pi / steps_per_period)))
    predicted = steps_per_period * log(factor)
    # until the oscillation has grown a hundredfold, but 1000 periods at most
    steps = int(min(max(log(100) / max(log(factor), 1e-9), 50), 1000 * steps_per_period))
    h = 2 * pi / frequency / steps_per_period
    y0, times = (AMPLITUDE, 0.0), [0.0, steps * h]
    solve = partial(integrate, method=method, form="lagrangian", h=h, max_steps=10**9)
    run = solve(pendulum, times, y0, pendulum.DEFAULTS, t_eval=times)
    sizes = np.hypot(frequency * run.y[0], run.y[1])
    measured = float(np.log(sizes[-1] / sizes[0])) / steps * steps_per_period
    return Growth(method, steps_per_period, predicted, measured)


@dataclass(frozen=True)
class Oscillation(Study[list[Growth]]):
    """Euler and RK2 with decreasing steps; RK3 and RK4 on both sides of their limit."""

    def run(self, load: Load) -> list[Growth]:
        cases = [(method, steps) for method in ("rk1", "midpoint") for steps in STEPS_PER_PERIOD]
        for method in ("rk3", "rk4"):
            function = StabilityFunction.of(load_method(method))
            limit = 2 * pi / function.imaginary_stability_interval
            cases += [(method, limit * factor) for factor in (1.02, 0.98)]
        return [growth(load("single_pendulum"), *case) for case in cases]

    def summary(self, results: list[Growth]) -> Iterator[str]:
        yield "Small oscillations of the single pendulum: logarithm of the growth per period"
        specs = {"method": "", "steps/period": ".4g", "predicted": ".4e", "measured": ".4e"}
        yield from text_table(specs, map(astuple, results))

    def plot(self, results: list[Growth]) -> Figure:
        title = "Small oscillations grow at any step size of Euler's method and of RK2"
        figure, (axes,) = panels(title, size=(7, 4.5))
        for method, colour in coloured(("rk1", "midpoint")):
            rows = [row for row in results if row.method == method]
            steps, predicted, measured = columns(rows, "steps_per_period", "predicted", "measured")
            axes.loglog(steps, predicted, color=colour, label=f"{method}, from R(z)")
            axes.loglog(steps, measured, "o", color=colour, label=f"{method}, run")
        axes.set(xlabel="steps per period", ylabel="logarithm of growth per period")
        axes.legend(frameon=False)
        return figure
