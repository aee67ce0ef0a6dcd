"""A nearly singular mass matrix: the double pendulum with m1 → 0 and aligned rods.

The condition number of M is about 4 m2/m1. Hamilton's form solves M q̇ = p for the velocities and
amplifies the rounding of p. Lagrange's form solves M q̈ = f: the weight of m2 appears twice in
the equation that remains for m1, and cancels.
"""

from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass
from decimal import Decimal, localcontext
from functools import partial
from math import nan

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, function
from solvers.io.figures import COLOURS, panels
from solvers.io.terminal import text_table
from solvers.references.decimal_numbers import sine_and_cosine
from solvers.references.power_series import PowerSeries
from solvers.references.taylor import taylor
from solvers.studies.failure_modes.study import Load, Study
from solvers.studies.work_precision.measured_curves import timed_run

Array = NDArray[np.float64]

EPSILON = float(np.finfo(float).eps)
#: Values of m1 in kg.
MASSES = (1.0, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10)
#: Motions: start, duration in s, the least m1 in kg, and the tolerances.
START, DURATION, LIGHTEST = (1.0, 1.0, 0.3, 0.3), 0.5, 1e-6
TOLERANCES = (1e-8, 1e-10, 1e-11, 1e-12, 1e-13)
#: Number of random states, and the largest angle between the rods in rad.
STATES, ALIGNED = 100, 1e-9


@dataclass(frozen=True)
class AccuracyLoss:
    """Accuracy of both forms for one mass m1."""

    m1: float  # in kg
    condition: float  # median condition number of M
    acceleration: float  # median relative error of Lagrange's accelerations
    velocity: float  # the same of Hamilton's velocities
    lagrangian: float  # least error of a final state, in rad and rad/s; NaN below `LIGHTEST`
    hamiltonian: float  # the same in Hamilton's form


def accuracy_loss(pendulum: GeneratedModule, m1: float) -> AccuracyLoss:
    """Accuracy of both forms of the double pendulum, for one evaluation and for a motion."""
    generator = np.random.default_rng(7)
    params = (m1, 1.0, 1.0, 1.0, 9.81)
    rows = []
    for _ in range(STATES):
        theta, gap = generator.uniform(-3, 3), generator.uniform(-ALIGNED, ALIGNED)
        y = np.array([theta, theta + gap, *generator.uniform(-2, 2, 2)])
        condition = np.linalg.cond(np.array(pendulum.mass_matrix(0.0, y, params)))
        acceleration = np.array(pendulum.rhs(0.0, y, params))[2:]
        z = pendulum.hamiltonian_state(0.0, y, params)
        velocity = np.array(pendulum.rhs_hamiltonian(0.0, z, params))[:2]
        exact = exact_accelerations(pendulum, y, params)
        errors = _relative_error(acceleration, exact), _relative_error(velocity, y[2:])
        rows.append((condition, *errors))
    medians = (float(np.median(values)) for values in zip(*rows, strict=True))
    ends = [nan, nan]
    if m1 >= LIGHTEST:
        ends = [least_error(pendulum, params, form) for form in ("lagrangian", "hamiltonian")]
    return AccuracyLoss(m1, *medians, *ends)


def _relative_error(values: Array, exact: Array) -> float:
    return float(np.abs(values - exact).max() / np.abs(exact).max())


def exact_accelerations(module: GeneratedModule, y: Array, params: Sequence[float]) -> Array:
    """Accelerations from the rational form in decimal arithmetic with 50 digits."""
    with localcontext() as context:
        context.prec = 50
        half = len(y) // 2
        pairs = [sine_and_cosine(Decimal(float(x))) for x in y[:half]]
        state = [*(x for pair in pairs for x in pair), *map(Decimal, map(float, y[half:]))]
        arguments = ([PowerSeries.number([], x) for x in values] for values in (state, params))
        rates = function(module, "rhs_rational")(0.0, *arguments)
        return np.array([float(rate.at(0)) for rate in rates[-half:]])


def least_error(pendulum: GeneratedModule, params: Sequence[float], form: str) -> float:
    """The least error with any tolerance at the end of a motion from aligned rods."""
    exact = taylor(pendulum, params, START, [0, DURATION], digits=18)[-1]
    solve = partial(timed_run, method="verner98", form=form, backend="compiled")
    runs = (solve(pendulum, params, START, DURATION, rtol=tol) for tol in TOLERANCES)
    return min(float(np.abs(run.end - exact).max()) for run in runs if run)


@dataclass(frozen=True)
class SingularMassMatrix(Study[list[AccuracyLoss]]):
    """Accuracy of both forms as m1 decreases, in kg."""

    SMALL = ((1.0, 1e-4),)

    masses: tuple[float, ...] = MASSES

    def run(self, load: Load) -> list[AccuracyLoss]:
        return [accuracy_loss(load("double_pendulum"), m1) for m1 in self.masses]

    def summary(self, results: list[AccuracyLoss]) -> Iterator[str]:
        yield "Aligned rods, m1 -> 0, m2 = 1 kg: errors of one evaluation and of a motion"
        columns = {"m1/kg": ".0e", "condition": ".1e", "Lagrange qdd": ".1e", "Hamilton qd": ".1e"}
        columns |= {"Lagrange end": ".1e", "Hamilton end": ".1e"}
        yield from text_table(columns, map(astuple, results))

    def plot(self, results: list[AccuracyLoss]) -> Figure:
        title = "Aligned rods, light first mass: loss of accuracy in both forms"
        figure, (axes,) = panels(title, size=(7, 4.5))
        m1 = [row.m1 for row in results]
        for name, label, style, colour in (
            ("acceleration", "Lagrange: accelerations", "o-", COLOURS[0]),
            ("velocity", "Hamilton: velocities", "s-", COLOURS[1]),
            ("lagrangian", "Lagrange: end of a motion", "o:", COLOURS[0]),
            ("hamiltonian", "Hamilton: end of a motion", "s:", COLOURS[1]),
        ):
            errors = [getattr(row, name) or np.nan for row in results]
            axes.loglog(m1, errors, style, color=colour, label=label)
        bound = [EPSILON * row.condition for row in results]
        axes.loglog(m1, bound, color="#888888", label="rounding × condition of M")
        axes.set(xlabel="m1 / kg (m2 = 1 kg)", ylabel="error")
        axes.legend(frameon=False)
        return figure
