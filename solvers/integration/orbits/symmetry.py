"""Properties of equations at all states, compared at random states.

With a symmetry under reversal of time, half a period of an orbit suffices.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from solvers.equations.module import (
    GeneratedModule,
    depends_on_time,
    function,
    has_constraints,
    has_function,
)
from solvers.io.argument_types import check_texts
from solvers.io.suggestion import did_you_mean, shortened
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


#: Largest relative difference of equations that are the same.
CLOSE = 1e-10


def angles(module: GeneratedModule) -> Array:
    """1 for components of the state that are angles, which whole turns do not change, else 0."""
    return np.array([float(module.UNITS[name] == "rad") for name in module.STATE])


@dataclass(frozen=True)
class Reversal:
    """A reversal of time that changes the signs of some components of the state.

    An orbit at which these components are 0 at two times, half a period apart, is its own image,
    so that half a period determines it (J. S. W. Lamb, J. A. G. Roberts, Physica D 112 (1998)
    1-39). An angle counts as 0 at every half turn.
    """

    names: tuple[str, ...]
    changed: Array  # indices of the components whose signs change
    half_turns: Array  # π for those that are angles, else 0

    @classmethod
    def of(
        cls, module: GeneratedModule, names: Sequence[str], y: Array, params: Array
    ) -> "Reversal":
        """The reversal that changes the components `names`.

        `ValueError` if there is no such component, the equations differ after the reversal, or the
        system has constraints.
        """
        check_texts("symmetry", names)
        for name in names:
            if name not in module.STATE:
                hint, known = did_you_mean(name, module.STATE), ", ".join(module.STATE)
                raise ValueError(f"symmetry has {name[:50]!r}{hint}; components are {known}")
        if has_constraints(module):
            raise ValueError(
                f"symmetry = {shortened(names)}: perturbations of {module.SYSTEM}, which has "
                "constraints, do not follow from half a period; leave it out"
            )
        changed = np.array([module.STATE.index(name) for name in names], dtype=int)
        reversal = cls(tuple(names), changed, np.pi * angles(module)[changed])
        if 2 * len(changed) != len(module.STATE) or not reversal.keeps_equations(module, y, params):
            raise ValueError(
                f"the equations of {module.SYSTEM} change if time is reversed together with "
                f"{', '.join(names) or 'nothing'}: its orbits have no such symmetry"
            )
        return reversal

    @classmethod
    def of_velocities(cls, module: GeneratedModule, y: Array, params: Array) -> "Reversal | None":
        """The reversal of all velocities, if it leaves the equations unchanged."""
        names = module.STATE[len(module.COORDINATES) :]
        try:
            return cls.of(module, names, y, params)
        except ValueError:
            return None

    def keeps_equations(self, module: GeneratedModule, y: Array, params: Array) -> bool:
        """Whether f(-t, R y) = -R f(t, y), for states near `y`."""
        signs = self.signs(len(y))
        for t, state in states_near(y):
            image = state.copy()
            image[self.changed] = 2 * self.nearest(y) - state[self.changed]
            try:
                rate = np.array(module.rhs(t, state.tolist(), params.tolist()))
                of_image = np.array(module.rhs(-t, image.tolist(), params.tolist()))
            except (ArithmeticError, ValueError):
                continue
            if np.abs(of_image + signs * rate).max() > CLOSE * (1 + np.abs(rate).max()):
                return False
        return True

    def signs(self, size: int) -> Array:
        """The diagonal of R."""
        signs = np.ones(size)
        signs[self.changed] = -1.0
        return signs

    def nearest(self, y: Array) -> Array:
        """The values nearest to those of `y` at which its changed components are unchanged."""
        spacing = np.where(self.half_turns > 0, self.half_turns, np.inf)
        return np.asarray(self.half_turns * np.round(y[self.changed] / spacing))

    def monodromy(self, half: Array) -> Array:
        """The transition matrix over a period from that over half of it."""
        signs = self.signs(len(half))
        return np.asarray(signs[:, np.newaxis] * np.linalg.solve(half, signs[:, np.newaxis] * half))

    def by_parameter(self, half: Array, change: Array) -> Array:
        """The derivative of the state after a period from that after half of it."""
        signs = self.signs(len(half))
        return np.asarray(signs * np.linalg.solve(half, (signs - 1) * change))
