"""Quantities in plots: values and colours of a map's number; axes with symbols and units."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, ListedColormap, LogNorm, Normalize, to_hex
from matplotlib.ticker import FuncFormatter, LogLocator, MultipleLocator, NullFormatter

from solvers.io import figures
from solvers.io.figure_names import axis_label, symbol
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.definition.sweep_checks import ENERGY
from solvers.sweeps.maps import Map
from solvers.sweeps.results import Results

#: Colours cover values between these percentiles; values beyond have the colours of the ends.
PERCENTILES = (0.5, 99.5)
#: Colour of motions in no class, and largest number of classes in a legend.
NO_CLASS, MAX_CLASSES = "#dddddd", 12


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

    @property
    def classes(self) -> list[tuple[str, str]]:
        """Colours and labels of the numbers 0, 1, … where these count records; else none."""
        records = self.results.records.get(self.name, [])
        shades = [*figures.COLOURS[:6], *map(to_hex, mpl.colormaps["tab20b"](range(20)))]
        counted = [
            (shades[k % len(shades)], f"{record['number']}: {brief(record)}")
            for k, record in enumerate(records)
        ]
        return [(NO_CLASS, "0: not settled"), *counted] if counted else []

    def colours(self, values: Array) -> tuple[str | Colormap, Normalize]:
        """A colour map and its range: cyclic for directions, else by the map's colour scale."""
        if classes := self.classes:
            discrete = ListedColormap([colour for colour, _ in classes])
            return discrete, Normalize(-0.5, len(classes) - 0.5)
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


def letter(name: str) -> str:
    """The mathematical symbol of a quantity."""
    return "$E$" if name == ENERGY else symbol(name)


def label_axis(panel: Axes, axis: str, results: Results, name: str) -> None:
    """Label an axis of a panel along which a quantity varies."""
    unit = results.unit(name)
    panel.set(**{f"{axis}label": axis_label(letter(name), unit)})
    if unit == "rad" and np.pi < np.ptp(results.axes[name]) < 5 * np.pi:
        ticks = {"x": panel.xaxis, "y": panel.yaxis}[axis]
        ticks.set_major_locator(MultipleLocator(np.pi / 2))
        ticks.set_major_formatter(FuncFormatter(_multiple_of_pi))


def brief(record: Mapping[str, Any]) -> str:
    """Kind of an attractor and its first state, in symbols."""
    state = ", ".join(f"{symbol(name)} = ${v:.3g}$" for name, v in record["states"][0].items())
    return f"{record['kind']}, {state}"


def add_legend(panel: Axes, mappable: ScalarMappable, quantity: Quantity) -> None:
    """Add a colour bar beside a panel, or a legend of the classes that occur."""
    if not quantity.classes:
        add_colour_bar(panel, mappable, quantity.label)
        return
    values = quantity.values()
    occurring = [k for k in range(len(quantity.classes)) if (values == k).any()]
    for colour, label in (quantity.classes[k] for k in occurring[:MAX_CLASSES]):
        panel.plot([], [], "s", color=colour, label=label)
    if hidden := len(occurring[MAX_CLASSES:]):
        panel.plot([], [], " ", label=f"and {hidden} more")
    panel.legend(
        loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=2, frameon=False, fontsize="small"
    )


def add_colour_bar(panel: Axes, mappable: ScalarMappable, label: str) -> None:
    """Add a colour bar beside a panel; its numbers are written without powers of ten."""
    bar = panel.figure.colorbar(mappable, ax=panel, label=label)
    if isinstance(mappable.norm, LogNorm):
        low, high = mappable.norm.vmin or 1.0, mappable.norm.vmax or 1.0
        parts = (1.0,) if high > 1e3 * low else (1.0, 2.0, 5.0)
        bar.ax.yaxis.set_major_locator(LogLocator(subs=parts, numticks=12))
        bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        bar.ax.yaxis.set_minor_formatter(NullFormatter())


def _multiple_of_pi(value: float, _: int) -> str:
    n = round(value / (np.pi / 2))
    whole, sign = abs(n) // 2, "−" if n < 0 else ""
    if n % 2 == 0:
        return "0" if n == 0 else f"{sign}{whole if whole > 1 else ''}π"
    return f"{sign}{abs(n) if abs(n) > 1 else ''}π/2"
