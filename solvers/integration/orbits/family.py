"""A family of periodic orbits, and its special points."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, title
from solvers.integration.orbits.orbit import ENERGY, PeriodicOrbit
from solvers.io.figure_names import axis_label, symbol
from solvers.io.suggestion import did_you_mean
from solvers.runge_kutta.stepper import Array

if TYPE_CHECKING:  # a run does not load matplotlib
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Markers of special orbits, by their kinds.
MARKERS = {"turning point": "^", "branch point": "s", "period doubling": "o", "Neimark-Sacker": "D"}
#: Line styles of orbits that are not unstable, and of those that are, with their labels.
STYLES = {False: ("-", "stable"), True: ("--", "unstable")}


@dataclass(frozen=True)
class SpecialOrbit:
    """An orbit at which the stability or the course of a family changes.

    Attributes
    ----------
    kind : str
        ``turning point``: the parameter, or the energy, is extreme; ``branch point``: another
        family crosses; ``period doubling``: a family of twice the period branches off;
        ``Neimark-Sacker``: a torus does.
    orbit : PeriodicOrbit
        The orbit.
    index : int
        Position in the family: it lies between the orbits ``index`` and ``index + 1``.
    direction : ndarray of shape (state + 2,) or None
        Estimated direction of the family that branches off, if any: changes of the start, of the
        period and of the parameter in proportion.
    """

    kind: str
    orbit: PeriodicOrbit
    index: int
    direction: Array | None = field(repr=False)


@dataclass(frozen=True, repr=False)
class OrbitFamily:
    """Periodic orbits along a curve.

    Attributes
    ----------
    module : module
        The generated module.
    parameter : str
        Name of the parameter that varies, or ``energy``.
    orbits : list of PeriodicOrbit
        In their order along the curve.
    special : list of SpecialOrbit
        Special points, in the same order.
    ends : pair of str
        Why the family ends at its first and its last orbit: ``start``, ``bound``, ``longest
        period``, ``equilibrium``, ``closed``, ``number of orbits``, ``no orbit in the shortest
        step``, or that perturbations grow too much for their multipliers to be known.
    """

    module: GeneratedModule
    parameter: str
    orbits: list[PeriodicOrbit]
    special: list[SpecialOrbit]
    ends: tuple[str, str]

    @property
    def values(self) -> Array:
        """The parameter, or the energy in J, shape (orbits,)."""
        return np.array([self.value(orbit) for orbit in self.orbits])

    @property
    def y(self) -> Array:
        """States at t = 0, shape (state, orbits)."""
        return np.array([orbit.y for orbit in self.orbits]).T

    @property
    def period(self) -> Array:
        """Periods in s, shape (orbits,)."""
        return np.array([orbit.period for orbit in self.orbits])

    @property
    def energy(self) -> Array:
        """Energies in J at t = 0, shape (orbits,)."""
        return np.array([orbit.energy for orbit in self.orbits])

    @property
    def multipliers(self) -> NDArray[np.complex128]:
        """Floquet multipliers, shape (state, orbits)."""
        return np.array([orbit.multipliers for orbit in self.orbits]).T

    @property
    def stability(self) -> list[str]:
        """The stability of each orbit."""
        return [orbit.stability for orbit in self.orbits]

    def to_table(self) -> dict[str, Sequence[object]]:
        """Columns by name, as ``pandas.DataFrame`` takes them."""
        states = dict(zip(self.module.STATE, self.y, strict=True))
        varies = {} if self.parameter == ENERGY else {self.parameter: self.values}
        multipliers = {f"multiplier_{k + 1}": row for k, row in enumerate(self.multipliers)}
        numbers = {"period": self.period, "energy": self.energy, **varies}
        return {**states, **numbers, **multipliers, "stability": self.stability}

    def __repr__(self) -> str:
        names = [f"{point.kind} at {self.value(point.orbit):.12g}" for point in self.special]
        first, last = (self.value(orbit) for orbit in (self.orbits[0], self.orbits[-1]))
        lines = [
            f"{len(self.orbits)} periodic orbits of {self.module.SYSTEM}, {self.parameter} from "
            f"{first:.12g} ({self.ends[0]}) to {last:.12g} ({self.ends[1]})",
            *names,
        ]
        return "\n  ".join(lines)

    def value(self, orbit: PeriodicOrbit) -> float:
        """The parameter of an orbit, or its energy in J."""
        if self.parameter == ENERGY:
            return orbit.energy
        return orbit.params[self.module.PARAMETERS.index(self.parameter)]

    def figure(self, quantity: str = "period", others: "Sequence[OrbitFamily]" = ()) -> "Figure":
        """A figure of this family, over its parameter or the energy.

        Unstable orbits are dashed, and special ones marked. Dashes change at special orbits.

        Parameters
        ----------
        quantity : str, optional
            ``period``, ``energy``, or a component of the state at t = 0.
        others : sequence of OrbitFamily, optional
            Families with the same parameter, such as those that branch off.

        Returns
        -------
        matplotlib.figure.Figure
            A figure, which `solvers.save` writes.

        Raises
        ------
        ValueError
            When there is no such quantity, or the families have different parameters.
        """
        return _figure([self, *others], quantity)


def _figure(families: Sequence[OrbitFamily], quantity: str) -> "Figure":
    """A quantity of orbits over the parameter of their families, or over the energy."""
    from solvers.io import figures

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


def _label(family: OrbitFamily, name: str) -> str:
    words = {"period": ("period", "s"), ENERGY: ("energy", "J")}
    return axis_label(*words.get(name, (symbol(name), family.module.UNITS.get(name, "1"))))


def _point(family: OrbitFamily, quantity: str, orbit: PeriodicOrbit) -> tuple[float, float]:
    if quantity in family.module.STATE:
        return family.value(orbit), float(orbit.y[family.module.STATE.index(quantity)])
    return family.value(orbit), orbit.period if quantity == "period" else orbit.energy


def _draw_curve(axes: "Axes", family: OrbitFamily, quantity: str) -> None:
    """Lines of stable and of unstable orbits, which end at special orbits."""
    from solvers.io import figures

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


def _draw_special(axes: "Axes", family: OrbitFamily, quantity: str) -> None:
    from solvers.io import figures

    for colour, (kind, marker) in zip(figures.COLOURS[1:], MARKERS.items(), strict=False):
        own: list[SpecialOrbit] = [point for point in family.special if point.kind == kind]
        if own:
            points = np.array([_point(family, quantity, point.orbit) for point in own])
            axes.plot(*points.T, marker, color=colour, label=kind, zorder=3)
