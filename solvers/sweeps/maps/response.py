"""Frequency responses."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.equations.signature_checks import checked
from solvers.integration.problem.events import Event
from solvers.sweeps.definition.axes import Array, Axes
from solvers.sweeps.definition.map_table import MapTable
from solvers.sweeps.definition.sampling import Sampling
from solvers.sweeps.maps import ComponentMap, Motions
from solvers.sweeps.maps.extremes import Extremes


@checked
@dataclass(frozen=True)
class Response(ComponentMap):
    """Response to a drive: half the range of coordinates, over `along` upwards and downwards.

    At each value of the parameter `along`, the last axis of a grid, the motion starts where that
    at the value before ended, so that jumps may occur at other values downwards than upwards. The
    period of the drive is `every`; the range is that of `count` periods after `skip` others.

    Parameters
    ----------
    of : tuple of str
        The coordinates.
    along : str
        The parameter.
    every : str or float
        Period of the drive in s, or a formula of parameters.
    skip : int
        Number of periods at each value before the range is measured.
    count : int
        Number of periods of the range.

    Examples
    --------
    >>> Response(("x",), "Omega", "2*pi/Omega", skip=100).shape
    (1, 2)
    """

    along: str
    every: str | float
    skip: int
    count: int = 1

    example = 'of = ["x"], along = "Omega", every = "2*pi/Omega", skip = 100, count = 1'
    dimensions: ClassVar[tuple[str, ...]] = ("component", "direction")
    plot = "response"
    occurrences = 2

    @classmethod
    def read(cls, table: MapTable) -> Self:
        along = table.choice("along", table.module.PARAMETERS)
        periods = table.period("every"), table.count("skip"), table.count("count", cls.count)
        return cls(table.components("of"), along, *periods)

    @property
    def labels(self) -> tuple[tuple[str, ...], ...]:
        return (self.of, ("up", "down"))

    @property
    def continued_along(self) -> str:
        return self.along

    @property
    def sampling(self) -> Sampling:
        return Sampling(self.every, self.count + 1, skip=self.skip)

    def events(self, module: GeneratedModule) -> list[Event]:
        return Extremes(self.of).events(module)

    def check(self, module: GeneratedModule, axes: Axes, values: Mapping[str, float | str]) -> None:
        super().check(module, axes, values)
        varied = [*axes.smallest]
        if self.along not in module.PARAMETERS or not axes.is_grid or varied[-1] != self.along:
            raise ValueError(
                f"along = {self.along!r} must be a parameter and the last axis of a grid, whose "
                f"axes are {', '.join(varied)}"
            )

    def values(self, motions: Motions) -> Array:
        low, high = np.moveaxis(Extremes(self.of).values(motions), 2, 0)
        return (high - low) / 2
