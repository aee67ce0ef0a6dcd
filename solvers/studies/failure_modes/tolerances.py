"""Tolerances that lie: the error that is found, beside the one that was asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.integration.ensemble import ensemble
from solvers.references.taylor import taylor
from solvers.runge_kutta.catalogue import SCIPY

Array = NDArray[np.float64]

METHODS = ("bs32", "dp54", "tsit54", "dop853", "verner87", "verner98", *SCIPY)
TOLERANCES = (1e-4, 1e-7, 1e-10)
#: Motions from rest at random angles with random parameters, and how long they are, in s.
SCENES, DURATION = 24, 3.0


@dataclass(frozen=True)
class Honesty:
    """Achieved over asked error of a method with one tolerance, over many scenes.

    Attributes
    ----------
    method : str
        Which; in capitals those of SciPy's.
    tolerance : float
        Relative and absolute.
    median, worst : float
        Of global error over tolerance.
    beside_motion : float
        Median of the same over the growth of small errors in the motion itself.
    """

    method: str
    tolerance: float
    median: float
    worst: float
    beside_motion: float


def study(
    pendulum: GeneratedModule, methods: Sequence[str], scenes: int
) -> list[Honesty]:  # fmt: skip
    """Global errors of double pendulums at the end, against Taylor series."""
    generator = np.random.default_rng(3)
    n = len(pendulum.STATE)
    starts = np.zeros((scenes, n))
    starts[:, : n // 2] = generator.uniform(-pi, pi, (scenes, n // 2))
    params = np.array(pendulum.DEFAULTS) * generator.uniform(0.5, 1.5, (scenes, 5))
    span = (0.0, DURATION)
    truth = np.array([
        taylor(pendulum, p, start, span, digits=18)[-1]
        for start, p in zip(starts.tolist(), params.tolist(), strict=True)
    ])  # fmt: skip
    growth = np.max([
        np.linalg.norm(ensemble(
            pendulum, span, np.hstack([starts, np.tile(unit, (scenes, 1))]), params,
            form="variational",
        ).y[:, n:], axis=1)
        for unit in np.eye(n)
    ], axis=0)  # fmt: skip
    found = []
    for method in methods:
        for tolerance in TOLERANCES:
            ends = ensemble(pendulum, span, starts, params, method=method, rtol=tolerance,
                            atol=tolerance).y  # fmt: skip
            ratio = np.abs(ends - truth).max(axis=1) / tolerance
            found.append(Honesty(method, tolerance, float(np.median(ratio)), float(ratio.max()),
                                 float(np.median(ratio / growth))))  # fmt: skip
    return found
