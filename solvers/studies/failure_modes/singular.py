"""A mass matrix that is nearly singular: the double pendulum with m1 → 0 and aligned rods.

There M has the condition number 4 m2/m1, about. Hamilton's form solves M q̇ = p for velocities:
p is rounded, and the solution multiplies that. Lagrange's form solves M q̈ = f: the weight of
m2 stands twice in what is left over for m1, and cancels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, function
from solvers.integration.timing import timed_run
from solvers.references.series import Series
from solvers.references.taylor import sine_and_cosine, taylor

Array = NDArray[np.float64]

MASSES = (1.0, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10)
#: Trajectories: start, duration in s, the lightest mass, and tolerances of which the best counts.
START, DURATION, LIGHTEST = (1.0, 1.0, 0.3, 0.3), 0.5, 1e-6
TOLERANCES = (1e-8, 1e-10, 1e-11, 1e-12, 1e-13)
#: Random states, with rods aligned within this angle in rad.
STATES, ALIGNED = 100, 1e-9


@dataclass(frozen=True)
class Loss:
    """Accuracy that is lost with one mass m1.

    Attributes
    ----------
    m1, condition : float
        The mass in kg, and the condition number of M between unit rods, median.
    acceleration : float
        Relative error of Lagrange's accelerations, median.
    velocity : float
        Relative error of Hamilton's velocities, median.
    lagrangian, hamiltonian : float
        Least error of a motion's end that the form can reach, in rad and rad/s; NaN where
        it was not tried.
    """

    m1: float
    condition: float
    acceleration: float
    velocity: float
    lagrangian: float
    hamiltonian: float


def study(pendulum: GeneratedModule, masses: Sequence[float] = MASSES) -> list[Loss]:
    """Accuracy of both forms, for one evaluation and for a motion."""
    return [_loss(pendulum, m1) for m1 in masses]


def _loss(pendulum: GeneratedModule, m1: float) -> Loss:
    generator = np.random.default_rng(7)
    params = (m1, 1.0, 1.0, 1.0, 9.81)
    conditions, accelerations, velocities = [], [], []
    for _ in range(STATES):
        theta, gap = generator.uniform(-3, 3), generator.uniform(-ALIGNED, ALIGNED)
        y = np.array([theta, theta + gap, *generator.uniform(-2, 2, 2)])
        conditions.append(np.linalg.cond(np.array(pendulum.mass_matrix(0.0, y, params))))
        exact = exact_accelerations(pendulum, y, params)
        found = np.array(pendulum.rhs(0.0, y, params))[2:]
        accelerations.append(np.abs(found - exact).max() / np.abs(exact).max())
        there = pendulum.hamiltonian_state(0.0, y, params)
        back = np.array(pendulum.rhs_hamiltonian(0.0, there, params))[:2]
        velocities.append(np.abs(back - y[2:]).max() / np.abs(y[2:]).max())
    floors = (
        [floor(pendulum, params, form) for form in ("lagrangian", "hamiltonian")]
        if m1 >= LIGHTEST
        else [float("nan")] * 2
    )
    medians = (float(np.median(v)) for v in (conditions, accelerations, velocities))
    return Loss(m1, *medians, *floors)


def exact_accelerations(module: GeneratedModule, y: Array, params: Sequence[float]) -> Array:
    """Accelerations by the rational form in decimal numbers with 50 digits."""
    with localcontext() as context:
        context.prec = 50
        half = len(y) // 2
        pairs = [sine_and_cosine(Decimal(float(x))) for x in y[:half]]
        state = [*(x for pair in pairs for x in pair), *map(Decimal, map(float, y[half:]))]
        numbers = ([Series.number([], x) for x in values] for values in (state, params))
        rates = function(module, "rhs_rational")(0.0, *numbers)
        return np.array([float(rate.at(0)) for rate in rates[-half:]])


def floor(pendulum: GeneratedModule, params: Sequence[float], form: str) -> float:
    """The least error of the end of a motion that begins with aligned rods."""
    truth = taylor(pendulum, params, START, [0, DURATION], digits=18)[-1]
    runs = (
        timed_run(pendulum, params, START, DURATION, method="verner98", form=form,
                 backend="compiled", rtol=tolerance)
        for tolerance in TOLERANCES
    )  # fmt: skip
    return min(float(np.abs(run.end - truth).max()) for run in runs if run)
