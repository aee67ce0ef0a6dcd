"""Module and parameters of a solution, with which its motion shows itself."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solvers.equations.energy import supplied_energy
from solvers.equations.module import GeneratedModule, has_function, title
from solvers.io.figure_names import plain_symbol
from solvers.io.units import with_unit
from solvers.player.sampled_motion import SampledMotion, sample_times
from solvers.runge_kutta.stepper import Array

#: Most coordinates in a label.
MOST_NAMES = 3


@dataclass(frozen=True)
class SolvedEquations:
    """The module of a motion, its parameters, and its states at any times.

    `states` takes times in s, in the direction of the motion, and returns rows (q, q̇); None where
    that would be another motion, as of longer numbers. `varies` is whether inputs do.
    """

    module: GeneratedModule
    params: tuple[float, ...]
    begin: float
    states: Callable[[Array], Array] | None
    varies: bool

    def sampled(self, t: Array, y: Array, end: float, note: str) -> SampledMotion:
        """The motion up to a time, at evenly spaced times if its states are known there."""
        module, size = self.module, len(self.module.STATE)
        if self.states is not None:
            t = sample_times(self.begin, end)
            y = self.states(t).T
        y = y[:size]
        energy = self._energy(t, y)
        if len(t) > 1 and t[-1] < t[0]:
            t, y, energy = t[::-1], y[:, ::-1], None if energy is None else energy[::-1]
        return SampledMotion(
            module, self.params, t, y, title(module), self._start(y[:, 0]), note, (), energy
        )

    def _start(self, y: Array) -> str:
        """The first coordinates at the start, in words."""
        units = self.module.UNITS
        names = self.module.COORDINATES[:MOST_NAMES]
        return ", ".join(
            f"{plain_symbol(name)} = {with_unit(x, units[name])}"
            for name, x in zip(names, y.tolist(), strict=False)
        )

    def _energy(self, t: Array, y: Array) -> Array | None:
        """Energy in J without that which forces have supplied; None where that is not known."""
        module = self.module
        if not has_function(module, "energy") or self.varies:
            return None
        energy = np.asarray(module.energy_many(t, y, self.params))
        if not has_function(module, "power"):
            return energy
        if self.states is None:
            return None
        return energy - supplied_energy(module, self.params, t, self.states)
