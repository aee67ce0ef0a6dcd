"""Noise, confidence intervals and correlations of fitted values."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from solvers.equations.number_checks import Array

#: Probability that an interval contains the true value.
LEVEL = 0.95


def leverages(jacobian: Array, triangle: Array) -> Array:
    """How much each value determines its own fit, shape (values,); they add up to the rank of R."""
    scale = np.linalg.norm(triangle, axis=0)
    scale[scale == 0] = 1.0
    R, J = triangle / scale, jacobian / scale
    own = np.linalg.pinv(R.T, rcond=1e-14) @ J.T  # some unknowns may change no value
    return np.asarray((own**2).sum(axis=0))


def covariance(triangle: Array) -> Array:
    """(JᵀJ)⁻¹ from the triangle R of J = QR; infinite where R is singular."""
    try:
        inverse = np.linalg.inv(triangle)
    except np.linalg.LinAlgError:
        return np.full(triangle.shape, np.inf)
    return np.asarray(inverse @ inverse.T)


def quantile(degrees: int, level: float = LEVEL) -> float:
    """Half the width of an interval in standard errors, by Student's distribution."""
    return float(scipy.special.stdtrit(degrees, (1 + level) / 2))


def autocorrelation(residuals: Sequence[Array], lags: int) -> Array:
    """Autocorrelations of residuals of several runs, gaps left out, at lags from 0 on."""
    sums, square = np.zeros(lags), 0.0
    for values in residuals:
        own = np.where(np.isfinite(values), values, 0.0)
        square += float(own @ own)
        for lag in range(min(lags, len(own))):
            sums[lag] += own[lag:] @ own[: len(own) - lag]
    return sums / square if square else sums


@dataclass(frozen=True)
class ConfidenceInterval:
    """A fitted value with its standard error and confidence interval."""

    value: float
    error: float
    low: float
    high: float

    @classmethod
    def of(cls, value: float, error: float, degrees: int) -> "ConfidenceInterval":
        """The interval for a number of degrees of freedom."""
        half = quantile(degrees) * error
        return cls(value, error, value - half, value + half)
