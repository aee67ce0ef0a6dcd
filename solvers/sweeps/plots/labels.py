"""Axes and colour bars: symbols, units, and angles as multiples of π."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.ticker import FuncFormatter, LogLocator, MultipleLocator, NullFormatter

from solvers.io.notation import axis_label, symbol
from solvers.sweeps.checks import ENERGY
from solvers.sweeps.results import Results


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
