"""States within an accepted step, in the form that is integrated and as ordinary states."""

from collections.abc import Callable, Iterable
from typing import Protocol

import numpy as np

from solvers.equations.forms import Form
from solvers.runge_kutta.stepper import Array

#: States at several times, in columns.
Curve = Callable[[Array], Array]
Event = Callable[[float, Array], float]


class StepStates(Protocol):
    """States within a step; they raise `ArithmeticError` where they cannot be computed."""

    def state(self, t: float, /) -> Array:
        """The state at a time."""

    def states(self, times: Array, /) -> Array:
        """The states at several times, in columns."""

    def between(self, begin: float, y0: Array, end: float, y1: Array, /) -> Curve:
        """States between those at two near times."""

    def curves(self) -> Iterable[Curve]:
        """Approximations of the states, each better than the one before."""


class OrdinaryStates:
    """Ordinary states within a step from time `t` and state `y`; states are computed once."""

    def __init__(self, form: Form, t: float, y: Array, step: StepStates) -> None:
        self._form, self._t, self._y, self._step = form, t, y, step
        self._known: dict[float, Array] = {}

    def _state(self, time: float) -> Array:
        if time not in self._known:
            self._known[time] = self._step.state(time)
        return self._known[time]

    def at(self, time: float) -> Array:
        """The state at a time."""
        if time == self._t:
            return self._y.copy()
        return self._form.to_ordinary(time, self._state(time), self._y, time - self._t)

    def between(self, begin: float, end: float) -> Callable[[float], Array]:
        """The state at a time between two near times."""
        curve = self._step.between(begin, self._state(begin), end, self._state(end))

        def at(time: float) -> Array:
            if time not in self._known:
                self._known[time] = curve(np.array([time]))[:, 0]
            return self.at(time)

        return at

    def along(self, curve: Curve, times: Array) -> Array:
        """The states at several times of a curve, in columns."""
        return self._form.to_ordinary(times, curve(times), self._y, times - self._t)


class EventCourse:
    """Values of an event within a step."""

    def __init__(self, event: Event, states: OrdinaryStates) -> None:
        self._event, self._states = event, states

    def at(self, time: float) -> float:
        """The value at a time."""
        return self._event(time, self._states.at(time))

    def between(self, begin: float, end: float) -> Callable[[float], float]:
        """The value at a time between two near times."""
        state = self._states.between(begin, end)
        return lambda time: self._event(time, state(time))
