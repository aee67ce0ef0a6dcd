"""Figures of families of periodic orbits."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solvers.equations.module import title
from solvers.integration.orbits.orbit import ENERGY, PeriodicOrbit
from solvers.io import figures
from solvers.io.notation import axis_label, symbol
from solvers.io.suggestion import did_you_mean

if TYPE_CHECKING:
    from solvers.integration.orbits.family import OrbitFamily, SpecialOrbit

#: Markers of special orbits, by their kinds.
MARKERS = {"turning point": "^", "branch point": "s", "period doubling": "o", "Neimark-Sacker": "D"}
#: Line styles of orbits that are not unstable, and of those that are, with their labels.
STYLES = {False: ("-", "stable"), True: ("--", "unstable")}


def figure(families: "Sequence[OrbitFamily]", quantity: str) -> Figure:
    """A quantity of orbits over the parameter of their families, or over the energy."""
    module, parameter = families[0].module, families[0].parameter
    known = ("period", ENERGY, *module.STATE)
    if quantity not in known:
        hint = did_you_mean(str(quantity), known)
        raise ValueError(f"quantity = {quantity!r}{hint} must be one of {', '.join(known)}")
    if len({family.parameter for family in families}) > 1:
        raise ValueError("families in one figure must have the same parameter")
    result, (axes,) = figures.panels(title(module), size=(8.4, 5.2))
    for family in families:
        _draw_curve(axes, family, quantity)
    for family in families:
        _draw_special(axes, family, quantity)
    axes.set_xlabel(_label(families[0], parameter))
    axes.set_ylabel(_label(families[0], quantity))
    handles, labels = axes.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    figures.legend_beside(axes, handles=unique.values(), labels=unique.keys())
    return result


def _label(family: "OrbitFamily", name: str) -> str:
    words = {"period": ("period", "s"), ENERGY: ("energy", "J")}
    return axis_label(*words.get(name, (symbol(name), family.module.UNITS.get(name, "1"))))


def _point(family: "OrbitFamily", quantity: str, orbit: PeriodicOrbit) -> tuple[float, float]:
    if quantity in family.module.STATE:
        return family.value(orbit), float(orbit.y[family.module.STATE.index(quantity)])
    return family.value(orbit), orbit.period if quantity == "period" else orbit.energy


def _draw_curve(axes: Axes, family: "OrbitFamily", quantity: str) -> None:
    """Lines of stable and of unstable orbits, which end at special orbits."""
    runs: list[tuple[bool, list[PeriodicOrbit]]] = []
    for k, orbit in enumerate(family.orbits):
        is_unstable = orbit.stability == "unstable"
        if not runs or runs[-1][0] != is_unstable:
            before = [point.orbit for point in family.special if point.index == k - 1]
            if runs:
                before = before or [family.orbits[k - 1]]
                runs[-1][1].extend(before)
            runs.append((is_unstable, before[-1:]))
        runs[-1][1].append(orbit)
    for is_unstable, orbits in runs:
        style, label = STYLES[is_unstable]
        points = np.array([_point(family, quantity, orbit) for orbit in orbits])
        axes.plot(*points.T, style, color=figures.COLOURS[0], label=label)


def _draw_special(axes: Axes, family: "OrbitFamily", quantity: str) -> None:
    for colour, (kind, marker) in zip(figures.COLOURS[1:], MARKERS.items(), strict=False):
        own: list[SpecialOrbit] = [point for point in family.special if point.kind == kind]
        if own:
            points = np.array([_point(family, quantity, point.orbit) for point in own])
            axes.plot(*points.T, marker, color=colour, label=kind, zorder=3)
