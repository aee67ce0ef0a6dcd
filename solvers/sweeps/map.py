"""What a map is: something small that is kept of each motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.integration.events import Event
from solvers.integration.solution import Ensemble

Array: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class Found:
    """Motions that have been integrated.

    Attributes
    ----------
    module : module
        The generated module.
    starts : ndarray of shape (n, state)
        Where they began.
    params : list of ndarray
        Each parameter's value in each motion.
    motions : Ensemble
        What became of them.
    events : slice
        Which of the ensemble's events are those of the map in question.
    """

    module: GeneratedModule
    starts: Array
    params: list[Array]
    motions: Ensemble
    events: slice

    def energies(self, t: Array | float, y: Array) -> Array:
        """Energies in J of states in rows."""
        return np.asarray(self.module.energy_many(t, y.T, self.params))


class Map:
    """What is kept of each motion; one number, of which nothing must be watched."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the numbers that are kept of one motion."""
        return ()

    @property
    def labels(self) -> tuple[tuple[str, ...], ...]:
        """What the numbers along each dimension are called; empty where they count."""
        return ()

    @property
    def components(self) -> tuple[str, ...]:
        """Parts of the state that it names."""
        return ()

    @property
    def occurrences(self) -> int:
        """How many occurrences of each event it needs."""
        return 1

    def unit(self, module: GeneratedModule) -> str:
        """Unit of the numbers; empty if they differ in it."""
        found = {module.UNITS[name] for name in self.components}
        return found.pop() if len(found) == 1 else ""

    def events(self, module: GeneratedModule) -> list[Event]:
        """What must be watched."""
        return []

    def values(self, found: Found) -> Array:
        """The numbers, shape (n, *shape); NaN where there are none."""
        raise NotImplementedError
