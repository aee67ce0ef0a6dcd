"""What an integration has passed: samples, events, and where it is now."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import takewhile

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from solvers.forms import Form
from solvers.stepper import Stepper

Array = NDArray[np.float64]
Event = Callable[[float, Array], float]


@dataclass
class Record:
    """States outside, (q, q̇), that a run has passed.

    Attributes
    ----------
    form, stepper : Form and Stepper
        They give states within a step: the step itself, taken with a shorter h.
    place, now : ndarray and float
        The last state and its time.
    samples : ndarray or None
        Times to keep; every step's end if None.
    events : list of callable
        What to watch.
    t, y : list
        Times and states that were kept.
    t_events, y_events : list of lists
        Times and states of each event.
    """

    form: Form
    stepper: Stepper
    place: Array
    now: float
    samples: Array | None
    events: list[Event]
    t: list[float] = field(default_factory=list)
    y: list[Array] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.t_events: list[list[float]] = [[] for _ in self.events]
        self.y_events: list[list[Array]] = [[] for _ in self.events]
        self._taken = 0
        if self.samples is None or (len(self.samples) and self.samples[0] == self.now):
            self._keep(self.now, self.place)
            self._taken = 1
        self._values = [event(self.now, self.place.copy()) for event in self.events]

    def _keep(self, t: float, y: Array) -> None:
        self.t.append(t)
        self.y.append(y.copy())

    def advance(self, t: float, z: Array, first: Array, end: float, z_end: Array) -> bool:
        """Take in a step from (t, z) to (end, z_end); tell whether an event ends the run.

        Raises
        ------
        ArithmeticError
            When a state within the step cannot be computed; then nothing is taken in.
        """

        def between(time: float) -> Array:
            if time == end:
                return self.form.outside(z_end, self.place, end - t)
            if time == t:
                return self.place.copy()
            inner, _, _ = self.stepper.step(t, z, time - t, first)
            return self.form.outside(self.form.settled(inner), self.place, time - t)

        values = [event(end, between(end)) for event in self.events]
        happened = self._happened(t, end, values, between)
        stop = bool(happened) and getattr(self.events[happened[-1][0]], "terminal", False)
        until = happened[-1][1] if stop else end
        times = [until] if self.samples is None else self._due(t, until)
        kept = [(time, between(time)) for time in times]
        seen = [(k, root, between(root)) for k, root in happened]
        place = between(until)
        for time, y in kept:
            self._keep(time, y)
        for k, root, y in seen:
            self.t_events[k].append(root)
            self.y_events[k].append(y)
        self._values, self._taken = values, self._taken + len(times)
        self.now, self.place = until, place
        return stop

    def _due(self, t: float, until: float) -> list[float]:
        """The samples that are asked for up to `until` and not yet taken."""
        assert self.samples is not None
        waiting = self.samples[self._taken :]
        reached = takewhile(lambda time: abs(time - t) <= abs(until - t), waiting)
        return [float(time) for time in reached]

    def _happened(
        self, t: float, end: float, values: list[float], between: Callable[[float], Array]
    ) -> list[tuple[int, float]]:
        """The events of a step and their times, in order, up to the first that is terminal."""
        found = []
        for k, (event, before, after) in enumerate(
            zip(self.events, self._values, values, strict=True)
        ):
            crossed = before != 0 and np.sign(before) != np.sign(after)
            if crossed and np.sign(after - before) * getattr(event, "direction", 0) >= 0:
                root = _root(event, between, t, end)
                found.append((abs(root - t), k, root))
        happened = []
        for _, k, root in sorted(found):
            happened.append((k, root))
            if getattr(self.events[k], "terminal", False):
                break
        return happened


def _root(event: Event, state: Callable[[float], Array], t: float, end: float) -> float:
    """Where `event` changes its sign, or the next time after it: a new start is past the event."""

    def value(time: float) -> float:
        return event(time, state(time))

    resolution = 4 * float(np.spacing(max(abs(t), abs(end))))
    root = float(brentq(value, t, end, xtol=resolution, maxiter=1000))
    for shift in (0, 1, 2, 4):
        later = root + shift * resolution * np.sign(end - t)
        if abs(later - t) < abs(end - t) and np.sign(value(later)) != np.sign(value(t)):
            return float(later)
    return end
