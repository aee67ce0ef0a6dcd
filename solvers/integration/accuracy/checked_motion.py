"""A motion, and the components of its state and the times whose errors matter."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, has_constraints, has_perturbation
from solvers.integration.problem.inputs import Controller, Held

Array = NDArray[np.float64]

#: Number of times at which errors are estimated, and the ratio that spaces them.
SAMPLES, GOLDEN = 128, (5**0.5 - 1) / 2


class OutsideDomainError(ValueError):
    """A model does not apply to a motion; the message states the reason."""


@dataclass(frozen=True)
class Motion:
    """A motion, and the components of its state that are requested."""

    module: GeneratedModule
    params: tuple[float, ...]
    y0: tuple[float, ...]
    duration: float  # in s, negative for a motion that ends before it begins
    requested: tuple[int, ...]  # indices of components of the state
    times: tuple[float, ...] = ()  # of the samples that are returned
    begin: float = 0.0  # in s
    inputs: Held | Controller | None = None  # those that vary

    @property
    def n_coordinates(self) -> int:
        """Number of coordinates."""
        return len(self.module.COORDINATES)

    @cached_property
    def inertial(self) -> tuple[int, ...]:
        """Coordinates with nonzero inertia; others have none where a mass or length is absent."""
        n = self.n_coordinates
        q = np.random.default_rng(0).uniform(0.1, 3.0, (n, 8))
        row = np.abs(self.module.mass_matrix_many(0.0, np.vstack([q, q]), self.params))
        return tuple(k for k in range(n) if row[k].max() > 0)

    def require_inertia(self) -> None:
        """Raise `OutsideDomainError` where a coordinate has neither inertia nor constraints."""
        absent = [q for k, q in enumerate(self.module.COORDINATES) if k not in self.inertial]
        if absent and not has_constraints(self.module):
            raise OutsideDomainError(f"{', '.join(absent)} has no inertia")

    @property
    def sample_times(self) -> Array:
        """Times at which errors are estimated: commensurate with no period, both ends included."""
        return self.begin + self.duration * np.unique([*golden_points(SAMPLES), 1.0])

    @property
    def forms(self) -> list[str]:
        """Forms of the equations that can integrate it: functions of inputs have Lagrange's."""
        if callable(self.inputs):
            return ["lagrangian"]
        return [form for form in self.module.FORMS if not has_perturbation(form)]

    @property
    def span(self) -> tuple[float, float]:
        """Start and end in s."""
        return self.begin, self.begin + self.duration

    def ordered(self, times: Sequence[float] | Array) -> Array:
        """These times, each of them once, from the start of the motion to its end."""
        ascending = np.unique(times)
        return ascending if self.duration >= 0 else ascending[::-1]

    def with_start(self, times: Array) -> Array:
        """These times, preceded by that of the start unless it is the first of them."""
        return times if len(times) and times[0] == self.begin else np.array([self.begin, *times])


def golden_points(count: int) -> Array:
    """Multiples of the golden ratio modulo 1, from 0 on: evenly spread, without a period."""
    return np.modf(GOLDEN * np.arange(count))[0]
