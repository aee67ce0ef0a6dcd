"""Poincaré sections."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.equations.signature_checks import checked
from solvers.integration.problem.events import Event
from solvers.io.figure_names import symbol
from solvers.io.quantity import with_unit
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.definition.map_table import MapTable
from solvers.sweeps.maps import CountedMap, Motions

#: Directions of a crossing in a sweep file.
DIRECTIONS = {"up": 1, "down": -1, "both": 0}


@checked
@dataclass(frozen=True)
class Section(CountedMap):
    """Poincaré section: components at `count` crossings of `where` = `value`, after `skip` others.

    Crossings are those upwards unless another direction is given: those of both directions lie on
    two different curves. The start of a motion does not count as a crossing.

    Parameters
    ----------
    of : tuple of str
        Components of the state that are stored.
    count : int
        Number of crossings.
    where : str
        The component that crosses the value.
    value : float
        The value, in the component's unit.
    direction : {1, -1, 0}
        Upwards only, downwards only, both directions.
    skip : int
        Number of crossings before the first that is stored.

    Examples
    --------
    >>> Section(("y", "y_dot"), 50, "x").shape
    (2, 50)
    """

    where: str
    value: float = 0.0
    direction: int = 1
    skip: int = 0

    example = 'of = ["theta2"], count = 50, where = "theta1", value = 0, direction = "up", skip = 0'
    plot = "section"
    wraps_angles = True

    @classmethod
    def read(cls, table: MapTable) -> Self:
        where = table.choice("where", table.module.STATE)
        direction = DIRECTIONS[table.choice("direction", tuple(DIRECTIONS), "up")]
        value = table.number("value", table.module.UNITS[where], 0.0)
        events = where, value, direction, table.count("skip", 0)
        return cls(table.components("of"), table.count("count"), *events)

    def remark(self, module: GeneratedModule) -> str:
        way = {1: "upwards", -1: "downwards", 0: "in both directions"}[self.direction]
        unit = module.UNITS[self.where]
        return f"crossings of {symbol(self.where)} = {with_unit(self.value, unit)} {way}"

    @property
    def occurrences(self) -> int:
        return self.count

    def events(self, module: GeneratedModule) -> list[Event]:
        return [Event(module, self.where, self.value, self.direction)]

    def values(self, motions: Motions) -> Array:
        states = motions.ensemble.y_events[:, :, motions.events.start, : self.count]
        return np.swapaxes(states[motions.indices(self.of)], 0, 1)
