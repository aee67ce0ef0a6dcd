"""What an integration has passed: samples, events, and where it is now."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

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
        self._values = [event(self.now, self.place) for event in self.events]

    def _keep(self, t: float, y: Array) -> None:
        self.t.append(t)
        self.y.append(y.copy())

    def advance(self, t: float, z: Array, first: Array, end: float, z_end: Array) -> bool:
        """Take in a step from (t, z) to (end, z_end); tell whether an event ends the run."""

        def between(time: float) -> Array:
            if time == end:
                return self.form.outside(z_end, self.place)
            if time == t:
                return self.place
            inner, _, _ = self.stepper.step(t, z, time - t, first)
            return self.form.outside(self.form.settled(inner), self.place)

        stop = self._happened(t, end, between)
        until = end if stop is None else stop
        if self.samples is None:
            self._keep(until, between(until))
        else:
            while self._taken < len(self.samples) and (
                abs(self.samples[self._taken] - t) <= abs(until - t)
            ):
                time = float(self.samples[self._taken])
                self._keep(time, between(time))
                self._taken += 1
        self.now, self.place = until, between(until)
        return stop is not None

    def _happened(self, t: float, end: float, between: Callable[[float], Array]) -> float | None:
        """Note the events of a step; the time of the first one that is terminal."""
        found = []
        for k, event in enumerate(self.events):
            before, after = self._values[k], event(end, between(end))
            self._values[k] = after
            if before * after < 0 or (after == 0 and before != 0):
                if (after - before) * getattr(event, "direction", 0) < 0:
                    continue
                root = float(brentq(lambda s, e=event: e(s, between(s)), t, end, xtol=1e-300))
                found.append((abs(root - t), k, root))
        for _, k, root in sorted(found):
            self.t_events[k].append(root)
            self.y_events[k].append(between(root))
            if getattr(self.events[k], "terminal", False):
                return root
        return None
