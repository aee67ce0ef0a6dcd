"""Labels of pictures: names as mathematics writes them, units, and angles as parts of π."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.ticker import FuncFormatter, LogLocator, MultipleLocator, NullFormatter

from solvers.io.notation import axis_label, symbol
from solvers.sweeps.checks import ENERGY
from solvers.sweeps.map import Map
from solvers.sweeps.maps import EnergyError, First, Lyapunov
from solvers.sweeps.results import Results

WORDS = {First: "time", Lyapunov: "Lyapunov's exponent", EnergyError: "energy error"}


def letter(name: str) -> str:
    """What stands for something in a formula."""
    return "$E$" if name == ENERGY else symbol(name)


def what(one: Map, name: str, part: str, unit: str) -> str:
    """What the numbers of a map are; `part` is the component they are of, if any."""
    return axis_label(WORDS.get(type(one), symbol(part) if part else name), unit)


def label(panel: Axes, axis: str, results: Results, name: str) -> None:
    """Label an axis of a panel along which something varies."""
    unit = results.unit(name)
    panel.set(**{f"{axis}label": axis_label(letter(name), unit)})
    if unit == "rad" and np.pi < np.ptp(results.axes[name]) < 5 * np.pi:
        ticks = getattr(panel, f"{axis}axis")
        ticks.set_major_locator(MultipleLocator(np.pi / 2))
        ticks.set_major_formatter(FuncFormatter(_halves_of_pi))


def bar(panel: Axes, drawn: ScalarMappable, words: str) -> None:
    """The scale of the colours, beside a panel; numbers are written out."""
    colourbar = panel.figure.colorbar(drawn, ax=panel, label=words)
    if isinstance(drawn.norm, LogNorm):
        low, high = drawn.norm.vmin or 1.0, drawn.norm.vmax or 1.0
        parts = (1.0,) if high > 1e3 * low else (1.0, 2.0, 5.0)
        colourbar.ax.yaxis.set_major_locator(LogLocator(subs=parts, numticks=12))
        colourbar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        colourbar.ax.yaxis.set_minor_formatter(NullFormatter())


def _halves_of_pi(value: float, _: int) -> str:
    n = round(value / (np.pi / 2))
    whole, sign = abs(n) // 2, "−" if n < 0 else ""
    if n % 2 == 0:
        return "0" if n == 0 else f"{sign}{whole if whole > 1 else ''}π"
    return f"{sign}{abs(n) if abs(n) > 1 else ''}π/2"
