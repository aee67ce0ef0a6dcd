"""Lyapunov spectra."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil
from typing import Self

import numpy as np

from solvers.equations.module import GeneratedModule, independent_perturbations
from solvers.equations.number_checks import positive
from solvers.equations.signature_checks import checked
from solvers.integration.variations.lyapunov_spectrum import Frames
from solvers.sweeps.definition.axes import Array, Axes
from solvers.sweeps.definition.map_table import MapTable
from solvers.sweeps.maps import Map, Motions


@checked
@dataclass(frozen=True)
class Spectrum(Map):
    """The `count` largest Lyapunov exponents in 1/s over the duration of the motion.

    Perturbations are made orthogonal again after every `interval`, in which the largest should not
    grow by more than a factor of 1e6 relative to the smallest; all of them, of a system without
    friction, add up to 0.

    Parameters
    ----------
    count : int
        Number of exponents.
    interval : float
        Time in s between orthogonalisations.

    Examples
    --------
    >>> Spectrum(4).shape
    (4,)
    """

    count: int
    interval: float = 2.0

    example = 'count = 4, interval = "2 s"'
    quantity = "Lyapunov exponent"
    own_unit = "1/s"
    dimensions = ("exponent",)

    @classmethod
    def read(cls, table: MapTable) -> Self:
        return cls(table.count("count"), table.number("interval", "s", 2.0))

    @property
    def labels(self) -> tuple[tuple[str, ...], ...]:
        return (tuple(str(k + 1) for k in range(self.count)),)

    def check(self, module: GeneratedModule, axes: Axes, values: Mapping[str, float | str]) -> None:
        super().check(module, axes, values)
        positive("interval", self.interval)
        most = independent_perturbations(module)
        if not 1 <= self.count <= most:
            raise ValueError(
                f"count = {self.count} must be from 1 to {most}, the exponents of {module.SYSTEM}"
            )

    def values(self, motions: Motions) -> Array:
        duration = np.asarray(motions.ensemble.t) - motions.begin
        options = {"rtol": motions.rtol, "atol": motions.rtol}
        frames = Frames(
            motions.module, motions.starts, motions.params, self.count, motions.begin, **options
        )
        intervals = max(1, ceil(np.abs(duration).max() / self.interval - 1e-9))
        growth = frames.growth(duration, intervals).sum(axis=0) / duration[:, np.newaxis]
        return np.asarray(-np.sort(-growth, axis=1))
