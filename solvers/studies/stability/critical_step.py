"""The longest step that lets no oscillation grow: predicted from R(z), and measured.

Measuring knows nothing of the method but how to make steps. A mode of small motion is started
alone; steps of one length are made; growth is what its size gains. From short steps to long
ones the first that grows is sought, and the limit between bisected.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, function
from solvers.equations.normal_modes import Modes
from solvers.integration.integrate import integrate
from solvers.runge_kutta.catalogue import load
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.runge_kutta.stepper import NoConvergenceError, NotFiniteError, Stepper

Array = NDArray[np.float64]

#: Amplitude of small motion in units of the coordinates: nonlinear parts are below rounding.
AMPLITUDE = 1e-7
#: Growth a step below this is rounding.
NOTHING = 1e-15
#: Steps times frequency that are tried, and how closely the limit is then found.
SHORTEST, LONGEST, RATIO, RESOLUTION = 0.25, 40.0, 1.25, 1e-4
#: Steps that are made: growth is measured over the second half of them.
STEPS = 400
#: Sizes of motion, in parts of that at the beginning, that count as none and as no longer small.
LOST, LARGE = 1e-6, 1e4
#: So many rounding errors of a place at most add up.
ROUNDINGS = 100
#: Growth is stated for a step so much longer than the limit, or for 1/frequency.
BEYOND = 1.05


@dataclass(frozen=True)
class CriticalStep:
    """Where a method becomes unstable for a system's fastest small oscillation.

    Attributes
    ----------
    method, title : str
        Its name in the catalogue, and what people call it.
    order, stages : int
        Its order and number of stages.
    function : StabilityFunction
        What follows from its coefficients.
    predicted : float
        The imaginary stability interval over the frequency, in s.
    linear, measured : float
        The same as found by running the linear equations, and those of the system in
        small motion. 0: growth even with the shortest step tried; inf: with none.
    probe : float
        A step in s for which growth is stated, and
    growth_predicted, growth_measured : float
        growth of the amplitude on the linear equations, as a logarithm a step.
    """

    method: str
    title: str
    order: int
    stages: int
    function: StabilityFunction
    predicted: float
    linear: float
    measured: float
    probe: float
    growth_predicted: float
    growth_measured: float


def critical_step(method: str, module: GeneratedModule, params: Sequence[float]) -> CriticalStep:
    """Find the longest stable step of a method for small motions of a system about rest.

    Parameters
    ----------
    method : str
        One of ``solvers.runge_kutta.catalogue.names()``.
    module : module
        A generated module.
    params : sequence of float
        In the order of ``module.PARAMETERS``.

    Returns
    -------
    CriticalStep
        The limit in s, as R(z) predicts it and as runs show it.

    Raises
    ------
    solvers.runge_kutta.catalogue.UnknownMethodError
        When no method has this name.
    ValueError
        When the system has no stable equilibrium that is known, or a mode without mass.
    """
    modes = Modes.at_rest(module, params)
    fastest = float(modes.frequencies[-1])
    tableau = load(method)
    function = StabilityFunction.of(tableau)
    linear, running = _linear(method, modes), _small_motion(method, module, params, modes)
    # rounding of M and K, too, lets motion grow: the more, the farther modes are apart
    nothing = NOTHING * fastest / float(modes.frequencies[0])
    measured = limit(running, fastest, nothing)
    probe = BEYOND * measured if 0 < measured < inf else 1 / fastest
    return CriticalStep(
        method, tableau.title, tableau.order, tableau.stages, function,
        predicted=function.imaginary_stability_interval / fastest,
        linear=limit(linear, fastest, nothing),
        measured=measured,
        probe=probe,
        growth_predicted=float(np.log(np.abs(function(1j * probe * fastest)))),
        growth_measured=linear(probe),
    )  # fmt: skip


def limit(
    growth: Callable[[float], float], frequency: float, nothing: float = NOTHING
) -> float:  # fmt: skip
    """The longest step that does not grow: 0 if all that are tried do, inf if none does."""
    stable, h = 0.0, SHORTEST / frequency
    while growth(h) <= nothing:
        stable, h = h, h * RATIO
        if h * frequency > LONGEST:
            return inf
    if stable == 0:
        return 0.0
    while h - stable > RESOLUTION * stable:
        middle = (stable + h) / 2
        stable, h = (middle, h) if growth(middle) <= nothing else (stable, middle)
    return stable


def _linear(method: str, modes: Modes) -> Callable[[float], float]:
    """Growth a step on M₀ ẍ + K x = 0, by the stepper in Python."""
    matrix = modes.matrix
    start = AMPLITUDE * np.concatenate([modes.shapes[:, -1], np.zeros(len(modes.frequencies))])

    def growth(h: float) -> float:
        stepper = Stepper(load(method), lambda _, y: matrix @ y, lambda _, y: matrix)
        y, sizes = start, []
        with np.errstate(over="ignore", invalid="ignore"):
            try:
                for _ in range(2):
                    for _ in range(STEPS // 2):
                        y, _, _ = stepper.step(0.0, y, h, stepper.derivative(0.0, y))
                    sizes.append(modes.size(y))
            except (NotFiniteError, NoConvergenceError):
                return inf
        return _rate(sizes, LOST * modes.size(start))

    return growth


def _small_motion(
    method: str, module: GeneratedModule, params: Sequence[float], modes: Modes
) -> Callable[[float], float]:
    """Growth a step of the system itself, by the integrator that people use."""
    n = len(modes.frequencies)
    rest = np.concatenate([function(module, "equilibrium")(params), np.zeros(n)])
    start = rest + AMPLITUDE * np.concatenate([modes.shapes[:, -1], np.zeros(n)])
    # about a place that is not 0, motion has fewer digits
    rounding = ROUNDINGS * modes.size(np.finfo(float).eps * rest)
    size = modes.size(start - rest)

    def growth(h: float) -> float:
        half = STEPS // 2 * h
        run = integrate(
            module, (0, 2 * half), start, params, method=method, form="lagrangian", h=h,
            t_eval=(half, 2 * half),
        )  # fmt: skip
        with np.errstate(over="ignore", invalid="ignore"):
            sizes = [modes.size(y - rest) for y in run.y.T]
        if len(sizes) < 2 or not max(sizes) < LARGE * size:
            return inf  # what has left small motion grew, whatever it does out there
        return _rate(sizes, LOST * size + 10 * rounding) - rounding / size / STEPS

    return growth


def _rate(sizes: Sequence[float], lost: float) -> float:
    """Logarithm of the growth a step over the second half; -inf for a size that counts as none."""
    halfway, end = sizes
    if not np.isfinite(halfway + end):
        return inf
    if min(halfway, end) < lost:
        return -inf
    return float(np.log(end / halfway) / (STEPS - STEPS // 2))
