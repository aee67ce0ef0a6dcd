"""Poincaré sections."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.integration.events import Event
from solvers.sweeps.map_table import MapTable
from solvers.sweeps.maps import Array, CountedMap, Motions, Panels

if TYPE_CHECKING:
    from solvers.sweeps.results import Results

#: Directions of a crossing in a sweep file.
DIRECTIONS = {"both": 0, "up": 1, "down": -1}


@dataclass(frozen=True)
class Section(CountedMap):
    """Poincaré section: components at the first `count` crossings of `where` = `value`.

    The start of a motion is no crossing.

    Parameters
    ----------
    of : tuple of str
        Components of the state that are stored.
    count : int
        Number of crossings, counted from the start.
    where : str
        The component that crosses the value.
    value : float
        The value, in the component's unit.
    direction : {0, 1, -1}
        Both directions, upwards only, downwards only.

    Examples
    --------
    >>> Section(("y", "y_dot"), 50, "x", direction=1).shape
    (2, 50)
    """

    where: str
    value: float = 0.0
    direction: int = 0

    example = 'of = ["theta2"], count = 50, where = "theta1", value = 0, direction = "up"'
    wraps_angles = True

    @classmethod
    def read(cls, table: MapTable) -> Section:
        """The map that a table of a sweep file specifies."""
        where = table.choice("where", table.module.STATE)
        direction = DIRECTIONS[table.choice("direction", tuple(DIRECTIONS), "both")]
        value = table.number("value", table.module.UNITS[where], 0.0)
        return cls(table.components("of"), table.count("count"), where, value, direction)

    @property
    def occurrences(self) -> int:
        """Number of crossings."""
        return self.count

    def events(self, module: GeneratedModule) -> list[Event]:
        """The crossing."""
        return [Event(module, self.where, self.value, self.direction)]

    def values(self, motions: Motions) -> Array:
        """The states at the crossings."""
        states = motions.ensemble.y_events[:, :, motions.events.start, : self.count]
        return np.swapaxes(states[motions.indices(self.of)], 0, 1)

    def panels(self, name: str, results: Results) -> Panels:
        """A panel for each energy and set of parameters."""
        from solvers.sweeps.plots.panels import section_panels

        return section_panels(name, results)
