"""Lagrange polynomials of the nodes of a method."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def lagrange_factors(c: Array) -> Array:
    """Reciprocal denominators of the Lagrange polynomials; 0 if nodes coincide."""
    differences = c[:, np.newaxis] - c + np.eye(len(c))
    if not differences.all():
        return np.zeros(len(c))
    return np.asarray(1 / differences.prod(axis=1))


def lagrange(c: Array, x: Array) -> Array:
    """Values of the Lagrange polynomials of the nodes c at each of `x`, in rows."""
    differences = np.tile(x[:, np.newaxis, np.newaxis] - c, (1, len(c), 1))
    differences[:, range(len(c)), range(len(c))] = 1
    return np.asarray(lagrange_factors(c) * differences.prod(axis=2))
