"""Basins of attraction."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.equations.number_checks import positive
from solvers.equations.signature_checks import checked
from solvers.sweeps.attractors import classify
from solvers.sweeps.definition.axes import Array, Axes
from solvers.sweeps.definition.map_table import MapTable
from solvers.sweeps.definition.sampling import Sampling
from solvers.sweeps.maps import Map, Motions


@checked
@dataclass(frozen=True)
class Basins(Map):
    """Basins of attraction: the number of the attractor that a motion approaches, 0 if none.

    Attractors are equilibria and periodic orbits: the state recurs after 1, 2, … times the period
    `every`, up to half of `count` times, after `skip` periods. Without a drive any time is a period
    of equilibria. States that differ by less than `tolerance` in each component, in SI units and
    radians modulo 2π, are the same. The file `NAME_attractors.json` lists the attractors.

    Parameters
    ----------
    every : str or float
        Period in s, or a formula of parameters.
    skip : int
        Number of periods before the states that are compared.
    count : int
        Number of these states.
    tolerance : float
        Largest difference of equal states.

    Examples
    --------
    >>> Basins("2*pi/Omega", skip=200).shape
    ()
    """

    every: str | float
    skip: int = 0
    count: int = 16
    tolerance: float = 1e-3

    example = 'every = "2*pi/Omega", skip = 200, count = 16, tolerance = 1e-3'
    quantity = "attractor"
    records = "attractors"

    @classmethod
    def read(cls, table: MapTable) -> Self:
        tolerance = table.number("tolerance", "1", cls.tolerance)
        return cls(
            table.period("every"), table.count("skip"), table.count("count", cls.count), tolerance
        )

    @property
    def sample_count(self) -> int:
        return self.count

    @property
    def sampling(self) -> Sampling:
        return Sampling(self.every, self.count, skip=self.skip)

    def stored_shape(self, module: GeneratedModule) -> tuple[int, ...]:
        return len(module.STATE), self.count

    def check(self, module: GeneratedModule, axes: Axes, values: Mapping[str, float | str]) -> None:
        super().check(module, axes, values)
        positive("tolerance", self.tolerance)
        if self.count < 2:
            raise ValueError(f"count = {self.count} must be 2 or more, to compare states")

    def values(self, motions: Motions) -> Array:
        return np.swapaxes(motions.ensemble.samples, 0, 1)

    def finish(self, module: GeneratedModule, stored: Array) -> tuple[Array, list[dict[str, Any]]]:
        numbers, attractors = classify(module, stored, self.tolerance)
        return numbers, [one.record(k, module) for k, one in enumerate(attractors, 1)]
