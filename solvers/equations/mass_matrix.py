"""The condition of the mass matrix: where it is large, accelerations lose their digits."""

import warnings
from collections.abc import Sequence

import numpy as np

from solvers.equations.module import GeneratedModule, has_function

#: Conditions of the mass matrix: above the first digits are lost, above the second all of them.
DOUBTFUL, SINGULAR = 1e12, 1e15


class MassMatrixWarning(UserWarning):
    """The mass matrix is nearly singular: digits are lost."""


def check_condition(
    module: GeneratedModule, params: Sequence[float], y0: Sequence[float], t: float = 0.0
) -> None:
    """Refuse a nearly singular mass matrix, or warn; coordinates without inertia are permitted.

    Besides the initial state, all coordinates are equal, as in aligned rods, unless the matrix is
    singular there whatever the masses, as at the pole of a sphere.
    """
    if not has_function(module, "mass_matrix"):
        return
    n = len(module.COORDINATES)
    aligned = [y0[0]] * n + [0.0] * n
    worst, weakest = _condition(module, t, y0, params)
    condition, coordinate = _condition(module, t, aligned, params)
    is_worse = condition > max(worst, DOUBTFUL)
    if is_worse and _condition(module, t, aligned, module.DEFAULTS)[0] < DOUBTFUL:
        worst, weakest = condition, coordinate
    text = f"the mass matrix has condition {worst:.0e}: {weakest} has hardly any inertia of its own"
    if worst >= SINGULAR:
        raise ValueError(f"{text}; leave that coordinate out, or make masses more similar")
    if worst >= DOUBTFUL:
        lost = f"about {np.log10(worst):.0f} digits are lost"
        warnings.warn(f"{text}; {lost}", MassMatrixWarning, stacklevel=3)


def _condition(
    module: GeneratedModule, t: float, y: Sequence[float], params: Sequence[float]
) -> tuple[float, str]:
    """The condition, whatever the units of coordinates, and the coordinate of least inertia."""
    try:
        M = np.array(module.mass_matrix(t, y[: len(module.STATE)], params))
    except ArithmeticError:
        return 0.0, ""
    inertial = np.flatnonzero(np.diag(M))
    if not inertial.size or not np.isfinite(M).all():
        return 0.0, ""
    size = np.sqrt(np.abs(np.diag(M)[inertial]))
    values, vectors = np.linalg.eigh(M[np.ix_(inertial, inertial)] / np.outer(size, size))
    condition = float(values[-1] / values[0]) if values[0] > 0 else float("inf")
    return condition, module.COORDINATES[inertial[np.argmax(np.abs(vectors[:, 0]))]]
