"""Integrals of periodic functions by their Fourier series."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solvers.scenes.models.model import Array


@dataclass(frozen=True)
class Series:
    """The integral of a periodic function: mean · φ and its Fourier series without the mean."""

    mean: float
    terms: NDArray[np.complex128]

    @classmethod
    def of(cls, values: Array) -> Series:
        """From values at φ = 2π (k + ½)/n."""
        n = len(values)
        order = np.arange(n // 2)
        terms = np.fft.rfft(values)[: n // 2] * np.exp(-1j * np.pi * order / n) * 2 / n
        return cls(float(values.mean()), terms[1:])

    @property
    def tail(self) -> float:
        """The largest of the last quarter of its terms."""
        return float(np.abs(self.terms[-len(self.terms) // 4 :]).max())

    def value(self, phi: Array) -> Array:
        """The function itself."""
        return self.mean + self._sum(phi, self.terms)

    def integral(self, phi: Array) -> Array:
        """Its integral, up to a constant."""
        order = np.arange(1, len(self.terms) + 1)
        return self.mean * phi + self._sum(phi, self.terms / (1j * order))

    @staticmethod
    def _sum(phi: Array, terms: NDArray[np.complex128]) -> Array:
        order = np.arange(1, len(terms) + 1)
        return (np.exp(1j * np.multiply.outer(phi, order)) @ terms).real
