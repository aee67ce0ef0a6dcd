"""Properties of equations that hold for all states: compared at random states."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from solvers.equations.module import GeneratedModule, depends_on_time, function, has_function
from solvers.runge_kutta.stepper import Array

#: Number of states, and their spread relative to the size of components that exceed 1.
STATES, SPREAD = 8, 0.3


def states_near(y: Array) -> Iterator[tuple[float, Array]]:
    """Random times, and random states near one."""
    rng = np.random.default_rng(0)
    for _ in range(STATES):
        yield float(rng.normal()), y + SPREAD * rng.normal(size=len(y)) * np.maximum(1.0, np.abs(y))


@dataclass(frozen=True)
class Nature:
    """Whether equations do not depend on time, and whether they conserve the energy."""

    is_autonomous: bool
    is_conservative: bool

    @classmethod
    def of(
        cls, module: GeneratedModule, y: Array, params: Array, parameter: int | None = None
    ) -> "Nature":
        """Of the equations with these parameters, whatever the value of one of them, if given."""
        varied = np.zeros(len(params))
        if parameter is not None:
            varied[parameter] = max(1.0, abs(params[parameter]))
        samples = [
            (t, state.tolist(), (params + k / STATES * SPREAD * varied).tolist())
            for k, (t, state) in enumerate(states_near(y))
        ]
        is_autonomous = not depends_on_time(module) or all(
            module.rhs(t, state, values) == module.rhs(0.0, state, values)
            for t, state, values in samples
        )
        power = function(module, "power") if has_function(module, "power") else None
        keeps_energy = power is None or all(power(*sample) == 0 for sample in samples)
        return cls(is_autonomous, is_autonomous and keeps_energy)
