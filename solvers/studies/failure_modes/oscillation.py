"""Oscillations that grow: by Euler's method with any step, by others beyond a limit."""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.integration.integrate import integrate
from solvers.runge_kutta.catalogue import load
from solvers.runge_kutta.stability_function import StabilityFunction

#: Amplitude in rad: small enough to be linear, as far as is looked at.
AMPLITUDE = 1e-6


@dataclass(frozen=True)
class Growth:
    """What a method does to an oscillation.

    Attributes
    ----------
    method : str
        Which.
    steps_per_period : float
        How long its steps are.
    predicted, measured : float
        Logarithm of the amplitude's growth over a period.
    """

    method: str
    steps_per_period: float
    predicted: float
    measured: float


def growth(pendulum: GeneratedModule, method: str, steps_per_period: float) -> Growth:
    """Growth of a small oscillation of the single pendulum, predicted from R(z), and run.

    So many periods are run as make it grow a hundredfold, if it grows, but at most 1000.

    Parameters
    ----------
    pendulum : module
        The generated single pendulum.
    method : str
        One of ``solvers.runge_kutta.catalogue.names()``.
    steps_per_period : float
        How long its steps are.

    Returns
    -------
    Growth
    """
    length, gravity = pendulum.DEFAULTS[1:]
    frequency = np.sqrt(gravity / length)
    function = StabilityFunction.of(load(method))
    factor = abs(complex(function(2j * pi / steps_per_period)))
    predicted = steps_per_period * log(factor)
    steps = int(min(max(log(100) / max(log(factor), 1e-9), 50), 1000 * steps_per_period))
    h = 2 * pi / frequency / steps_per_period
    run = integrate(
        pendulum, (0, steps * h), (AMPLITUDE, 0.0), pendulum.DEFAULTS, method=method, h=h,
        form="lagrangian", t_eval=[0.0, steps * h], max_steps=10**9,
    )  # fmt: skip
    sizes = np.hypot(frequency * run.y[0], run.y[1])
    return Growth(
        method, steps_per_period, predicted, float(np.log(sizes[-1] / sizes[0])) / steps
        * steps_per_period,
    )  # fmt: skip


def study(pendulum: GeneratedModule) -> list[Growth]:
    """Euler and RK2 with ever shorter steps; RK3 and RK4 on both sides of their limit."""
    always = (20.0, 100.0, 500.0, 2500.0)
    cases = [(method, steps) for method in ("rk1", "midpoint") for steps in always]
    for method in ("rk3", "rk4"):
        limit = 2 * pi / StabilityFunction.of(load(method)).imaginary_stability_interval
        cases += [(method, limit * factor) for factor in (1.02, 0.98)]
    return [growth(pendulum, *case) for case in cases]
