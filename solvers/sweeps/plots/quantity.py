"""One number of a map's: values, label and colours."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm, Normalize

from solvers.io.notation import axis_label, symbol
from solvers.sweeps.axes import Array
from solvers.sweeps.maps import Map
from solvers.sweeps.results import Results

#: Where nothing happened or nothing is known, and where it is proved that nothing can happen.
NOTHING, NEVER = "#c8c8c8", "#ffffff"
#: Colours cover values between these percentiles; values beyond have the colours of the ends.
PERCENTILES = (0.5, 99.5)


@dataclass(frozen=True)
class Quantity:
    """One number for each motion, at an index of a map's numbers."""

    results: Results
    name: str
    index: tuple[int, ...] = ()

    @property
    def map(self) -> Map:
        """The map."""
        return self.results.definition.maps[self.name]

    @property
    def component(self) -> str:
        """The component of the state, if the map has components."""
        labels = self.map.labels
        return labels[0][self.index[0]] if labels else ""

    @property
    def unit(self) -> str:
        """Unit of the number."""
        return self.map.unit(self.results.definition.module, self.component)

    @property
    def label(self) -> str:
        """Label of an axis or a colour bar."""
        component = symbol(self.component) if self.component else self.name
        return axis_label(self.map.quantity or component, self.unit)

    @property
    def is_direction(self) -> bool:
        """Whether the number is an angle modulo 2π."""
        return self.map.wraps_angles and self.unit == "rad"

    def values(self, motions: tuple[Any, ...] = (...,)) -> Array:
        """Values of some motions, as shown: directions between -π and π, errors without sign."""
        values = self.results.maps[self.name][(*motions, *self.index)]
        if self.is_direction:
            return wrapped(values)
        return np.abs(values) if self.map.is_logarithmic else np.asarray(values)

    def colours(self, values: Array) -> tuple[str, Normalize]:
        """A colour map and its range: cyclic for directions, else by the map's colour scale."""
        palette, finite = self.map.colour_map, values[np.isfinite(values)]
        if not finite.size:
            return "viridis", Normalize(0, 1)
        if self.map.is_logarithmic:
            sizes = np.abs(finite[finite != 0])
            low, high = np.percentile(sizes, PERCENTILES) if sizes.size else (1e-17, 1e-16)
            return palette or "viridis", LogNorm(low, max(high, low))
        if self.is_direction:
            return "twilight", Normalize(-np.pi, np.pi)
        low, high = np.percentile(finite, PERCENTILES)
        if palette:
            return palette, Normalize(min(low, 0.0), high)
        if low < 0 < high:
            return "RdBu_r", Normalize(-max(-low, high), max(-low, high))
        return "viridis", Normalize(low, high)


def wrapped(angles: Array) -> Array:
    """Angles between -π and π."""
    return np.asarray(np.remainder(angles + np.pi, 2 * np.pi) - np.pi)
