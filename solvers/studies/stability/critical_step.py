"""The longest step with which no oscillation grows: predicted from R(z), and measured.

The measurement uses the method only to make steps. A single mode of small motion is integrated
with a fixed step, and its growth is recorded. The step is increased until the mode grows, and the
limit is found by bisection.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf

import numpy as np
from numpy.typing import NDArray

from solvers.equations.energy import equilibrium_state
from solvers.equations.linearisation.normal_modes import Modes
from solvers.equations.module import GeneratedModule
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.runge_kutta.method_catalogue import load
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.runge_kutta.stepper import NoConvergenceError, NotFiniteError, Stepper

Array = NDArray[np.float64]
#: Takes a step in s; returns the logarithm of an oscillation's growth per step.
Growth = Callable[[float], float]

#: Amplitude in units of the coordinates: nonlinear terms are below rounding.
AMPLITUDE = 1e-7
#: Growth per step below this is rounding.
NO_GROWTH = 1e-15
#: Range and ratio of steps times frequency, and the relative resolution of the bisection.
SHORTEST, LONGEST, RATIO, RESOLUTION = 0.25, 40.0, 1.25, 1e-4
#: Number of steps; growth is measured over the second half.
STEPS = 100
#: Sizes relative to the initial size that count as zero and as no longer small.
LOST, LARGE = 1e-6, 1e4
#: Largest number of rounding errors of a state that add up.
ROUNDINGS = 100
#: Growth is reported for a step longer than the limit by this factor, or for 1/frequency.
BEYOND = 1.05


@dataclass(frozen=True)
class CriticalStep:
    """The step in s at which a method becomes unstable for the fastest small oscillation.

    0: oscillations grow even with the shortest step; inf: with none.
    """

    method: str
    title: str  # common name of the method
    order: int
    stages: int
    function: StabilityFunction
    predicted: float  # imaginary stability interval over the frequency
    linear: float  # limit for runs of the linear equations
    measured: float  # limit for runs of the system's equations in small motion
    probe: float  # a step in s; the linear equations grow by these logarithms per step
    growth_predicted: float
    growth_measured: float


def critical_step(method: str, module: GeneratedModule, params: Sequence[float]) -> CriticalStep:
    """The longest stable step of a method for small motions about the equilibrium.

    Parameters
    ----------
    method : str
        One of ``solvers.runge_kutta.method_catalogue.names()``.
    module : module
        A generated module.
    params : sequence of float
        In the order of ``module.PARAMETERS``.

    Returns
    -------
    CriticalStep
        The limit in s, predicted from R(z) and measured.

    Raises
    ------
    solvers.runge_kutta.method_catalogue.UnknownMethodError
        When no method has this name.
    ValueError
        When no stable equilibrium of the system is known, or a mode has no mass.
    """
    modes = Modes.at_rest(module, params)
    fastest = float(modes.frequencies[-1])
    tableau = load(method)
    function = StabilityFunction.of(tableau)
    linear, running = _linear(method, modes), _small_motion(method, module, params, modes)
    # rounding of M and K makes motion grow in proportion to the ratio of frequencies
    no_growth = NO_GROWTH * fastest / float(modes.frequencies[0])
    measured = limit(running, fastest, no_growth)
    probe = BEYOND * measured if 0 < measured < inf else 1 / fastest
    names = method, tableau.title, tableau.order, tableau.stages, function
    predicted = function.imaginary_stability_interval / fastest
    limits = predicted, limit(linear, fastest, no_growth), measured
    growth = float(np.log(np.abs(function(1j * probe * fastest)))), linear(probe)
    return CriticalStep(*names, *limits, probe, *growth)


def limit(growth: Growth, frequency: float, no_growth: float = NO_GROWTH) -> float:
    """The longest step without growth: 0 if all steps in the range have growth, inf if none."""
    stable, h = 0.0, SHORTEST / frequency
    while growth(h) <= no_growth:
        stable, h = h, h * RATIO
        if h * frequency > LONGEST:
            return inf
    if stable == 0:
        return 0.0
    while h - stable > RESOLUTION * stable:
        middle = (stable + h) / 2
        stable, h = (middle, h) if growth(middle) <= no_growth else (stable, middle)
    return stable


def _linear(method: str, modes: Modes) -> Growth:
    """Growth per step of M₀ ẍ + K x = 0, by the stepper in Python."""
    matrix = modes.matrix
    start = AMPLITUDE * np.concatenate([modes.shapes[:, -1], np.zeros(len(modes.frequencies))])

    def growth(h: float) -> float:
        stepper = Stepper(load(method), lambda _, y: matrix @ y, lambda _, y: matrix)
        y, sizes, last = start, [], None
        with np.errstate(over="ignore", invalid="ignore"):
            try:
                for _ in range(2):
                    for _ in range(STEPS // 2):
                        step = stepper.step(0.0, y, h, stepper.derivative(0.0, y), last)
                        y, last = step.y, step.last
                    sizes.append(modes.size(y))
            except (NotFiniteError, NoConvergenceError):
                return inf
        return _rate(sizes, LOST * modes.size(start))

    return growth


def _small_motion(
    method: str, module: GeneratedModule, params: Sequence[float], modes: Modes
) -> Growth:
    """Growth per step of the system itself, by `integrate`."""
    n = len(modes.frequencies)
    rest = equilibrium_state(module, params)
    assert rest is not None  # the modes are those of the equilibrium
    start = rest + AMPLITUDE * np.concatenate([modes.shapes[:, -1], np.zeros(n)])
    # rounding is relative to the coordinates of the equilibrium
    rounding = ROUNDINGS * modes.size(np.finfo(float).eps * rest)
    size = modes.size(start - rest)

    @ignore_predictability()
    def growth(h: float) -> float:
        half = STEPS // 2 * h
        solve = partial(integrate, method=method, form="lagrangian", h=h)
        run = solve(module, (0, 2 * half), start, params, t_eval=(half, 2 * half))
        with np.errstate(over="ignore", invalid="ignore"):
            sizes = [modes.size(y - rest) for y in run.y.T]
        if len(sizes) < 2 or not max(sizes) < LARGE * size:
            return inf  # motion that is no longer small has grown
        return _rate(sizes, LOST * size + 10 * rounding) - rounding / size / STEPS

    return growth


def _rate(sizes: Sequence[float], lost: float) -> float:
    """Logarithm of the growth per step over the second half; -inf for a size of zero."""
    halfway, end = sizes
    if not np.isfinite(halfway + end):
        return inf
    if min(halfway, end) < lost:
        return -inf
    return float(np.log(end / halfway) / (STEPS - STEPS // 2))
