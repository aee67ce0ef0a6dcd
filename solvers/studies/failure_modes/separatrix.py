"""The single pendulum near its upright equilibrium, compared with its exact solution."""

from collections.abc import Iterator
from dataclasses import astuple, dataclass
from functools import partial
from math import log, pi, sqrt

import numpy as np
from matplotlib.figure import Figure

from solvers.equations.module import GeneratedModule
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.problem.events import Event
from solvers.io.figures import COLOURS, columns, panels
from solvers.io.terminal import text_table
from solvers.references.elliptic import pendulum as exact_solution
from solvers.studies.failure_modes.study import Load, Study

#: Initial distances from the upright equilibrium in rad, and the duration of the motion in s.
DISTANCES, DURATION = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7), 10.0
#: Method and tolerance of these motions.
METHOD, TOLERANCE = "verner853", 1e-10
#: Methods and tolerances of motions on the separatrix.
METHODS, TOLERANCES = ("dp54", "verner853", "verner98"), (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)


@dataclass(frozen=True)
class Sensitivity:
    """Growth of small errors near the upright equilibrium."""

    distance: float  # initial distance from upright in rad
    predicted: float  # growth of a linear perturbation of the start during one fall
    amplification: float  # largest growth, from the variational equations
    error: float  # largest error of a run, in rad and rad/s


@ignore_predictability()
def sensitivity(module: GeneratedModule) -> list[Sensitivity]:
    """Errors of runs, and the growth of small errors in the motion itself."""
    # the fall from a distance δ takes ln(const/δ)/ω, so that a change of δ shifts it by 1/(ωδ);
    # angle and velocity change by at most 2ω and ω² in a second
    _, length, gravity = params = module.DEFAULTS
    omega = sqrt(gravity / length)
    t = np.linspace(0, DURATION, 201)
    solve = partial(integrate, method=METHOD, rtol=TOLERANCE, atol=TOLERANCE, t_eval=t)
    results = []
    for distance in DISTANCES:
        y0 = (pi - distance, 0.0)
        run = solve(module, (0, DURATION), y0, params, form="rational")
        carried = solve(module, (0, DURATION), (*y0, 1.0, 0.0), params, form="variational")
        error = float(np.abs(run.y.T - exact_solution(length, gravity, y0, t)).max())
        growth = float(np.abs(carried.y[2:]).max())
        results.append(Sensitivity(distance, max(2.0, omega) / distance, growth, error))
    return results


@dataclass(frozen=True)
class Departure:
    """The end of a motion that would approach the upright equilibrium on the separatrix.

    The pendulum turns back or passes the top at a time in s.
    """

    method: str
    tolerance: float  # relative and absolute
    defect: float  # relative energy error at the end, k² - 1: negative if the pendulum turns back
    predicted: float  # from the exact solution with that energy
    measured: float


@ignore_predictability()
def departures(module: GeneratedModule) -> list[Departure]:
    """Motions from the bottom at the speed of the separatrix."""
    # with energy k² (1 on the separatrix) the quarter period is K(k²)/ω or K(1/k²)/(kω), and
    # K = ln(4/√|1 - k²|) for k close to 1 (NIST Digital Library of Mathematical Functions, 19.12.1)
    _, length, gravity = module.DEFAULTS
    omega = sqrt(gravity / length)
    ends = (("theta", pi), ("theta_dot", 0.0))
    events = [Event(module, name, value, terminal=True) for name, value in ends]
    solve = partial(ensemble, module, (0, 100), [[0.0], [2 * omega]], module.DEFAULTS)
    results = []
    for method in METHODS:
        for tol in TOLERANCES:
            run = solve(method=method, rtol=tol, atol=tol, form="lagrangian", events=events)
            t, (theta, rate) = run.t[0], run.y[:, 0]
            defect = float((rate / (2 * omega)) ** 2 - np.cos(theta / 2) ** 2)
            predicted = log(4 / sqrt(abs(defect))) / omega
            results.append(Departure(method, tol, defect, predicted, float(t)))
    return results


@dataclass(frozen=True)
class Upright:
    """Release at the floating-point number nearest to the upright equilibrium."""

    offset: float  # difference between π and this number, in rad
    predicted: float  # time in s at which the pendulum is horizontal
    measured: float


@ignore_predictability()
def upright(module: GeneratedModule) -> Upright:
    """Release from rest at the floating-point number nearest to π.

    At first the angle from upright is δ cosh ωt. When it is large compared with δ and still
    small, tan(angle/4) = (δ/8) e^(ωt), which remains valid: the pendulum is horizontal after
    ln(8 tan(π/8)/δ)/ω.

    Parameters
    ----------
    module : module
        The generated single pendulum.

    Returns
    -------
    Upright
        With the predicted time and that of a run by ``verner98``, in s.
    """
    _, length, gravity = params = module.DEFAULTS
    omega = sqrt(gravity / length)
    offset = 1.2246467991473532e-16  # sine of that number, which is π minus it
    solve = partial(ensemble, method="verner98", rtol=1e-13, atol=1e-30)
    events = [Event(module, "theta", angle, terminal=True) for angle in (pi / 2, 3 * pi / 2)]
    run = solve(module, (0, 100), [[pi], [0.0]], params, events=events)
    predicted = log(8 * np.tan(pi / 8) / offset) / omega
    return Upright(offset, float(predicted), float(run.t[0]))


@dataclass(frozen=True)
class SeparatrixResults:
    """Results of the three parts of the study."""

    sensitivity: list[Sensitivity]
    departures: list[Departure]
    upright: Upright


@dataclass(frozen=True)
class Separatrix(Study[SeparatrixResults]):
    """Release near upright and at upright, and motions on the separatrix."""

    def run(self, load: Load) -> SeparatrixResults:
        module = load("single_pendulum")
        return SeparatrixResults(sensitivity(module), departures(module), upright(module))

    def summary(self, results: SeparatrixResults) -> Iterator[str]:
        yield f"Single pendulum released near upright: growth of errors in {DURATION:g} s"
        specs = {"distance/rad": ".0e", "one fall": ".1e", "motion": ".1e"}
        specs[f"error of {METHOD}, rtol {TOLERANCE:g}"] = ".1e"
        yield from text_table(specs, map(astuple, results.sensitivity))
        yield "on the separatrix: the pendulum turns back (-) or passes the top (+) after a time"
        specs = {"method": "", "tolerance": ".0e", "energy defect": "+.1e"}
        specs |= {"predicted/s": ".3f", "measured/s": ".3f"}
        yield from text_table(specs, map(astuple, results.departures))
        fall = results.upright
        yield (
            f"released upright, {fall.offset:.1e} rad from pi: horizontal after "
            f"{fall.measured:.6f} s (predicted {fall.predicted:.6f} s)"
        )

    def plot(self, results: SeparatrixResults) -> Figure:
        figure, (axes,) = panels("Single pendulum released near upright", size=(7, 4.5))
        names, blue = ("distance", "amplification", "predicted"), COLOURS[0]
        distance, growth, predicted = columns(results.sensitivity, *names)
        axes.loglog(distance, growth, "o", color=blue, label="growth of small errors within 10 s")
        axes.loglog(distance, predicted, color=blue, label="frequency / distance: one fall")
        axes.set(xlabel="distance from upright / rad", ylabel="factor")
        axes.legend(frameon=False)
        return figure
