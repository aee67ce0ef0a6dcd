"""What can be kept of each motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.integration.events import Event, Extremum
from solvers.sweeps.map import Found, Map

Array: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class First(Map):
    """The time in s of the first of some events: a component of the state crosses a value.

    A motion that crosses a value and comes back within one step is not seen to do so.

    Parameters
    ----------
    of : mapping of str to tuple of float
        Values by component.
    barrier : tuple of mapping of str to float
        Places of which every motion must rise above the lowest before any of these events
        can occur, by coordinate; those that have less energy are not integrated, unless
        other maps ask for them. What is not named there is 0.
    """

    of: Mapping[str, tuple[float, ...]]
    barrier: tuple[Mapping[str, float], ...] = ()

    @property
    def components(self) -> tuple[str, ...]:
        """What is watched, and what places are told by."""
        return (*self.of, *(name for place in self.barrier for name in place))

    def unit(self, module: GeneratedModule) -> str:
        """Unit of a time."""
        return "s"

    def events(self, module: GeneratedModule) -> list[Event]:
        """A crossing for each value."""
        return [Event(module, name, value) for name, values in self.of.items() for value in values]

    def values(self, found: Found) -> Array:
        """The time of the first event, NaN where none occurred."""
        times = found.motions.t_events[:, found.events, 0]
        first = np.where(np.isnan(times), np.inf, times).min(axis=1, initial=np.inf)
        return np.where(np.isinf(first), np.nan, first)


@dataclass(frozen=True)
class Final(Map):
    """Where motions end: some components of the state."""

    of: tuple[str, ...]

    @property
    def components(self) -> tuple[str, ...]:
        """What is kept."""
        return self.of

    @property
    def shape(self) -> tuple[int, ...]:
        """One number a component."""
        return (len(self.of),)

    @property
    def labels(self) -> tuple[tuple[str, ...], ...]:
        """The components."""
        return (self.of,)

    def values(self, found: Found) -> Array:
        """States at the end."""
        return found.motions.y[:, _places(found.module, self.of)]


@dataclass(frozen=True)
class Extremes(Final):
    """The smallest and the largest value of some coordinates, between steps, too.

    Of each motion two numbers a coordinate are kept, in rad or m.

    Parameters
    ----------
    of : tuple of str
        Coordinates; a `solvers.sweeps.sweep.Sweep` raises `ValueError` for other names.

    Examples
    --------
    >>> Extremes(("theta1", "theta2")).shape
    (2, 2)
    """

    @property
    def occurrences(self) -> int:
        """The smallest and the largest."""
        return 2

    @property
    def shape(self) -> tuple[int, ...]:
        """Two numbers a coordinate."""
        return (len(self.of), 2)

    @property
    def labels(self) -> tuple[tuple[str, ...], ...]:
        """The coordinates, and which is which."""
        return (self.of, ("smallest", "largest"))

    def events(self, module: GeneratedModule) -> list[Event]:
        """The zeros of the velocities."""
        return [Extremum(module, f"{name}_dot") for name in self.of]

    def values(self, found: Found) -> Array:
        """The extremes; beginning and end are candidates, too."""
        places, motions = _places(found.module, self.of), found.motions
        inner = motions.y_events[:, found.events, :2]
        between = np.stack([inner[:, k, :, place] for k, place in enumerate(places)], axis=1)
        ends = np.stack([found.starts[:, places], motions.y[:, places]], axis=2)
        candidates = np.concatenate([between, ends], axis=2)
        return np.stack([np.fmin.reduce(candidates, 2), np.fmax.reduce(candidates, 2)], axis=2)


@dataclass(frozen=True)
class Samples(Final):
    """Some components of the state at `count` times, evenly from beginning to end."""

    count: int

    @property
    def shape(self) -> tuple[int, ...]:
        """A row of numbers a component."""
        return (len(self.of), self.count)

    @property
    def labels(self) -> tuple[tuple[str, ...], ...]:
        """The components."""
        return (self.of, ())

    def values(self, found: Found) -> Array:
        """The samples."""
        return found.motions.samples[:, _places(found.module, self.of)]


@dataclass(frozen=True)
class Section(Samples):
    """Poincaré's section: where motions are the first `count` times a component crosses a value.

    Parameters
    ----------
    of : tuple of str
        Which components of the state are kept there.
    count : int
        How many crossings, counted from the beginning.
    where : str
        Which component crosses.
    value : float
        In its unit.
    direction : {0, 1, -1}
        Both ways, only upwards, only downwards.
    """

    where: str
    value: float = 0.0
    direction: int = 0

    @property
    def occurrences(self) -> int:
        """As many as are kept."""
        return self.count

    @property
    def components(self) -> tuple[str, ...]:
        """What is kept."""
        return self.of

    def events(self, module: GeneratedModule) -> list[Event]:
        """The crossing."""
        return [Event(module, self.where, self.value, self.direction)]

    def values(self, found: Found) -> Array:
        """The states at the crossings."""
        states = found.motions.y_events[:, found.events.start, : self.count]
        return np.swapaxes(states[..., _places(found.module, self.of)], 1, 2)


@dataclass(frozen=True)
class Lyapunov(Map):
    """Lyapunov's exponent over the time of the motion, ln(|δ|/|δ₀|)/t.

    The small change δ of the state follows the variational equations from δ₀, whose components
    are all equal; it is measured in units of m, rad and s. The limit of long times is the
    largest exponent, for almost every δ₀ (G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn,
    Meccanica 15 (1980) 9-20).
    """

    def unit(self, module: GeneratedModule) -> str:
        """Unit of a rate."""
        return "1/s"

    def values(self, found: Found) -> Array:
        """The exponents."""
        return found.motions.growth / found.motions.t


@dataclass(frozen=True)
class EnergyError(Map):
    """By how much the energy at the end differs from that at the beginning, in J.

    Of each motion one number is kept, above 0 where energy has grown. Where forces or friction
    change the energy it is no error: a `solvers.sweeps.sweep.Sweep` of such a system raises
    `ValueError`.

    Examples
    --------
    >>> EnergyError().shape
    ()
    """

    def unit(self, module: GeneratedModule) -> str:
        """Unit of an energy."""
        return "J"

    def values(self, found: Found) -> Array:
        """Differences of the energy."""
        n, motions = len(found.module.STATE), found.motions
        before = found.energies(0.0, found.starts[:, :n])
        return found.energies(motions.t, motions.y[:, :n]) - before


def _places(module: GeneratedModule, names: tuple[str, ...]) -> list[int]:
    return [module.STATE.index(name) for name in names]
