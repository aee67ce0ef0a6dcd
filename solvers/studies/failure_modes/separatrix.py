"""The single pendulum near its upright place, beside its exact solution."""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.integration.ensemble import ensemble
from solvers.integration.events import Event
from solvers.integration.integrate import integrate
from solvers.references.elliptic import pendulum as exact

#: Distances from the upright place to begin with, in rad, and how long to look, in s.
DISTANCES, DURATION = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7), 10.0
#: Method and tolerance with which sensitivity is shown.
METHOD, TOLERANCE = "verner87", 1e-10
#: Those that try to arrive.
METHODS, TOLERANCES = ("dp54", "verner87", "verner98"), (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)


@dataclass(frozen=True)
class Sensitivity:
    """What becomes of small errors near the upright place.

    Attributes
    ----------
    distance : float
        Where the pendulum is released, in rad from upright.
    predicted : float
        By how much a small change of the start grows while the pendulum falls through once.
    amplification : float
        The most that it grows, by the variational equations.
    error : float
        The largest error of a run, in rad and rad/s.
    """

    distance: float
    predicted: float
    amplification: float
    error: float


def sensitivity(module: GeneratedModule) -> list[Sensitivity]:
    """Errors beside the exact solution, and how much the motion itself amplifies.

    The fall from a distance δ takes ln(const/δ)/ω, so that a change of δ shifts it by
    1/(ωδ) of time; angle and velocity change by at most 2ω and ω² in a second.

    Parameters
    ----------
    module : module
        The generated single pendulum.

    Returns
    -------
    list of Sensitivity
        One for each of `DISTANCES`.
    """
    _, length, gravity = module.DEFAULTS
    omega = sqrt(gravity / length)
    t = np.linspace(0, DURATION, 201)
    found = []
    for distance in DISTANCES:
        start = (pi - distance, 0.0)
        run, carried = (
            integrate(module, (0, DURATION), (*start, *change), module.DEFAULTS, method=METHOD,
                      rtol=TOLERANCE, atol=TOLERANCE, form=form, t_eval=t)
            for form, change in (("rational", ()), ("variational", (1.0, 0.0)))
        )  # fmt: skip
        truth = exact(length, gravity, start, t)
        found.append(Sensitivity(
            distance, max(2.0, omega) / distance, float(np.abs(carried.y[2:]).max()),
            float(np.abs(run.y.T - truth).max()),
        ))  # fmt: skip
    return found


@dataclass(frozen=True)
class Fall:
    """A pendulum that should stay or arrive upright, and does not.

    Attributes
    ----------
    method : str
        Which.
    tolerance : float
        Relative and absolute.
    defect : float
        By what its energy misses that of the separatrix, k² - 1 when it turns or passes.
    predicted, seen : float
        When it turns back or passes, in s: by the exact solution of that energy, and run.
    """

    method: str
    tolerance: float
    defect: float
    predicted: float
    seen: float


def falls(module: GeneratedModule) -> list[Fall]:
    """From the bottom with just the speed that leads to the top, never to arrive.

    With energy k² (1 on the separatrix) the quarter period is K(k²)/ω or K(1/k²)/(kω),
    and K = ln(4/√|1 - k²|) for k close to 1 (NIST Digital Library of Mathematical
    Functions, 19.12.1).

    Parameters
    ----------
    module : module
        The generated single pendulum.

    Returns
    -------
    list of Fall
        For each of `METHODS` one for each of `TOLERANCES`.
    """
    _, length, gravity = module.DEFAULTS
    omega = sqrt(gravity / length)
    events = [
        Event(module, "theta", pi, terminal=True),
        Event(module, "theta_dot", 0.0, terminal=True),
    ]
    found = []
    for method in METHODS:
        for tolerance in TOLERANCES:
            run = ensemble(
                module, (0, 100), [(0.0, 2 * omega)], module.DEFAULTS, method=method,
                rtol=tolerance, atol=tolerance, form="lagrangian", events=events,
            )  # fmt: skip
            t, (theta, rate) = run.t[0], run.y[0]
            defect = float((rate / (2 * omega)) ** 2 - np.cos(theta / 2) ** 2)
            predicted = log(4 / sqrt(abs(defect))) / omega
            found.append(Fall(method, tolerance, defect, predicted, float(t)))
    return found


@dataclass(frozen=True)
class Upright:
    """The upright equilibrium, as near as a number comes to it.

    Attributes
    ----------
    offset : float
        By what the float misses π, in rad.
    predicted, seen : float
        When the pendulum has fallen to the horizontal, in s.
    """

    offset: float
    predicted: float
    seen: float


def upright(module: GeneratedModule) -> Upright:
    """Released at rest at the float nearest to π.

    At first the angle from upright is δ cosh ωt; when that is large beside δ and still
    small, tan(angle/4) = (δ/8) e^(ωt), and it stays so: the horizontal is reached after
    ln(8 tan(π/8)/δ)/ω.

    Parameters
    ----------
    module : module
        The generated single pendulum.

    Returns
    -------
    Upright
        With the times in s that the formula predicts and that a run by ``verner98`` sees.
    """
    _, length, gravity = module.DEFAULTS
    omega = sqrt(gravity / length)
    offset = 1.2246467991473532e-16  # sin of that float, which is π minus it
    run = ensemble(
        module, (0, 100), [(pi, 0.0)], module.DEFAULTS, method="verner98", rtol=1e-13, atol=1e-30,
        events=[Event(module, "theta", angle, terminal=True) for angle in (pi / 2, 3 * pi / 2)],
    )  # fmt: skip
    predicted = log(8 * np.tan(pi / 8) / offset) / omega
    return Upright(offset, float(predicted), float(run.t[0]))
