"""A family of periodic orbits, and its special points."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, title
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.given_tolerances import single_motion
from solvers.integration.orbits.periodic_orbit import ENERGY, PeriodicOrbit
from solvers.integration.problem.events import Event
from solvers.integration.problem.problem import Options
from solvers.integration.results.solution import Solution
from solvers.io.figure_names import axis_label, symbol
from solvers.io.suggestion import did_you_mean
from solvers.player.playable import Playable
from solvers.player.sampled_motion import SampledMotion, sample_times
from solvers.runge_kutta.stepper import Array

if TYPE_CHECKING:  # a run does not load matplotlib
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Markers of special orbits, by their kinds.
MARKERS = {"turning point": "^", "branch point": "s", "period doubling": "o", "Neimark-Sacker": "D"}
#: Colours and line styles of orbits that are not unstable, and of those that are, with labels.
STYLES = {False: ("#0072B2", "-", "stable"), True: ("#D55E00", "--", "unstable")}
#: Quantities of figures: the amplitude of the coordinate that moves most, and of a given one.
AMPLITUDE, AMPLITUDE_OF = "amplitude", "amplitude of {}"
#: Times of an orbit at which its coordinates are compared, besides those of their extrema.
SAMPLES = 65
#: Orbits of a family that pages and films show.
SHOWN = 5


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
class OrbitFamily(Playable):
    """Periodic orbits along a curve; pages, films and plots show some of them.

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

    @cached_property
    def amplitudes(self) -> Array:
        """Half the range of each coordinate over each orbit, shape (coordinates, orbits)."""
        return np.array([orbit_amplitudes(self.module, orbit) for orbit in self.orbits]).T

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

    def figure(self, quantity: str = "amplitude", others: "Sequence[OrbitFamily]" = ()) -> "Figure":
        """A figure of this family, over its parameter or the energy.

        Stable orbits are blue, unstable ones red and dashed, and special ones marked. Colours
        change at special orbits.

        Parameters
        ----------
        quantity : str, optional
            ``amplitude``, half the range of the coordinate that moves most in the first family, or
            of another one, such as ``amplitude of theta2``; ``period``, ``energy``, or a component
            of the state at t = 0, which depends on the point of the orbit that is the start.
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

    def sampled_motions(self) -> list[SampledMotion]:
        """Orbits evenly along the family, from the first to the last, each over its period."""
        chosen = {*np.linspace(0, len(self.orbits) - 1, SHOWN).round().astype(int).tolist()}
        motions = []
        for k in sorted(chosen):
            orbit = self.orbits[k]
            with ignore_predictability():
                times = sample_times(0.0, orbit.period)
                motion = _motion(self.module, orbit, Options(t_eval=times))
            label = f"{self.parameter} = {self.value(orbit):.6g}, {orbit.stability}"
            motions += [replace(one, label=label) for one in motion.sampled_motions()]
        return motions


def _figure(families: Sequence[OrbitFamily], quantity: str) -> "Figure":
    """A quantity of orbits over the parameter of their families, or over the energy."""
    from solvers.io import figures

    module, parameter = families[0].module, families[0].parameter
    of_coordinates = [AMPLITUDE_OF.format(name) for name in module.COORDINATES]
    known = (AMPLITUDE, *of_coordinates, "period", ENERGY, *module.STATE)
    if quantity not in known:
        hint = did_you_mean(str(quantity), known)
        raise ValueError(f"quantity = {quantity!r}{hint} must be one of {', '.join(known)}")
    if len({family.parameter for family in families}) > 1:
        raise ValueError("families in one figure must have the same parameter")
    if quantity == AMPLITUDE:
        quantity = of_coordinates[int(np.argmax(families[0].amplitudes.max(axis=1)))]
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


def orbit_amplitudes(module: GeneratedModule, orbit: PeriodicOrbit) -> Array:
    """Half the range of each coordinate over an orbit: extremes are where its velocity is 0."""
    n, times = len(module.COORDINATES), np.linspace(0, orbit.period, SAMPLES)
    extrema = [Event(module, name, 0.0) for name in module.STATE[n:]]
    with ignore_predictability():
        motion = _motion(module, orbit, Options(t_eval=times, events=extrema))
    states = np.hstack([motion.y, *(rows.T for rows in motion.y_events)])[:n]
    return np.asarray(np.ptp(states, axis=1) / 2)


def _motion(module: GeneratedModule, orbit: PeriodicOrbit, options: Options) -> Solution:
    """The motion over one period."""
    options = replace(options, rtol=1e-10, atol=1e-12)
    return single_motion(module, (0.0, orbit.period), orbit.y, orbit.params, options)


def _label(family: OrbitFamily, name: str) -> str:
    units = family.module.UNITS
    if name.startswith(AMPLITUDE):
        coordinate = name.rpartition(" ")[2]
        return axis_label(AMPLITUDE_OF.format(symbol(coordinate)), units[coordinate])
    words = {"period": ("period", "s"), ENERGY: ("energy", "J")}
    return axis_label(*words.get(name, (symbol(name), units.get(name, "1"))))


def _values(family: OrbitFamily, quantity: str, orbits: Sequence[PeriodicOrbit]) -> Array:
    """The parameter, or energy, of orbits, and the quantity, in rows."""
    state = family.module.STATE
    if quantity.startswith(AMPLITUDE):
        index = state.index(quantity.rpartition(" ")[2])
        own = {
            id(orbit): row for orbit, row in zip(family.orbits, family.amplitudes.T, strict=True)
        }
        rows = (own.get(id(orbit)) for orbit in orbits)
        values = [
            float((orbit_amplitudes(family.module, orbit) if row is None else row)[index])
            for orbit, row in zip(orbits, rows, strict=True)
        ]
    elif quantity in state:
        values = [float(orbit.y[state.index(quantity)]) for orbit in orbits]
    else:
        values = [orbit.period if quantity == "period" else orbit.energy for orbit in orbits]
    return np.array([[family.value(orbit) for orbit in orbits], values])


def _draw_curve(axes: "Axes", family: OrbitFamily, quantity: str) -> None:
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
        colour, style, label = STYLES[is_unstable]
        axes.plot(*_values(family, quantity, orbits), style, color=colour, label=label)


def _draw_special(axes: "Axes", family: OrbitFamily, quantity: str) -> None:
    for kind, marker in MARKERS.items():
        own = [point.orbit for point in family.special if point.kind == kind]
        if own:
            values = _values(family, quantity, own)
            axes.plot(*values, marker, color="black", markerfacecolor="white", label=kind, zorder=3)
