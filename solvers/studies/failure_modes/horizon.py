"""Growth of a small difference of two motions, and the predictability horizon."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import inf, log

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from solvers.equations.energy import energy_error
from solvers.equations.module import GeneratedModule
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.io.figures import COLOURS, coloured, columns
from solvers.references.taylor import taylor

Array = NDArray[np.float64]

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
