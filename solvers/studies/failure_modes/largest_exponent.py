"""The largest Lyapunov exponent of a motion."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import log

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.module import GeneratedModule
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.integrate import integrate
from solvers.integration.prepare import prepare

Array = NDArray[np.float64]

#: Time in s after which a perturbation is scaled back to length 1; intervals left out at first.
INTERVAL, TRANSIENT = 1.0, 100
TOLERANCE = 1e-9
#: Parts of a run of this duration in s count as independent; the least and largest number of parts.
INDEPENDENT, FEWEST, MOST = 150.0, 8, 40


@dataclass(frozen=True)
class Mean:
    """A mean over time, with its standard error."""

    value: float
    error: float

    def __str__(self) -> str:
        return f"{self.value:.4g} ± {self.error:.1g}"

    @classmethod
    def of(cls, values: Array, duration: float) -> "Mean":
        """The mean of correlated values, with the error from the means of blocks."""
        count = int(np.clip(duration / INDEPENDENT, FEWEST, MOST))
        blocks = np.array([part.mean() for part in np.array_split(values, count)])
        return cls(float(blocks.mean()), float(blocks.std(ddof=1) / np.sqrt(count)))


def lyapunov(
    module: GeneratedModule, params: Sequence[float], y0: Sequence[float], duration: float
) -> "Mean":
    """The largest Lyapunov exponent in 1/s, along the motion from `y0`.

    The variational equations carry a linear perturbation along, which is scaled back to length 1
    every second. The exponent is the mean of the logarithms of its growth (G. Benettin,
    L. Galgani, J.-M. Strelcyn, Physical Review A 14, 2338, 1976).

    Parameters
    ----------
    module : module
        A generated module.
    params : sequence of float
        In the order of ``module.PARAMETERS``.
    y0 : sequence of float
        Initial coordinates and velocities, in the order of ``module.STATE``.
    duration : float
        Length of the mean in s, `FEWEST` at least, rounded down to whole seconds. The first
        `TRANSIENT` seconds of the motion precede it.

    Returns
    -------
    Mean
        The exponent and its standard error, both in 1/s.

    Raises
    ------
    ValueError
        When an argument is invalid.
    solvers.integration.prepare.NotFinishedError
        When the motion does not last that long.
    """
    advance = _advance(module, params)
    n = len(module.STATE)
    state = np.array([*y0, *np.ones(n) / np.sqrt(n)])
    growth = []
    for _ in range(TRANSIENT + int(duration / INTERVAL)):
        state = np.array(advance(state.tolist()))
        length = float(np.linalg.norm(state[n:]))
        state[n:] /= length
        growth.append(log(length) / INTERVAL)
    return Mean.of(np.array(growth[TRANSIENT:]), duration)


def _advance(
    module: GeneratedModule, params: Sequence[float]
) -> Callable[[list[float]], ArrayLike]:
    """A function that advances a motion and a linear perturbation by one interval."""
    span, tol = (0.0, INTERVAL), TOLERANCE
    try:
        return partial(prepare(module, params, form="variational", rtol=tol, atol=tol), span)
    except NoCompilerError:
        solve = partial(integrate, form="variational", backend="python", t_eval=[INTERVAL])
        run = ignore_predictability()(solve)
        return lambda y: run(module, span, y, params, rtol=tol, atol=tol).y[:, -1]
