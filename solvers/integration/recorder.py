"""Record the samples and events of the steps of an integration."""

from __future__ import annotations

from collections.abc import Callable
from itertools import takewhile

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from solvers.integration.problem import EventFunction, Outcome, Problem

Array = NDArray[np.float64]


class Recorder:
    """Records the samples and events of successive steps in an `Outcome`.

    Attributes
    ----------
    t, y : float and ndarray
        Time in s and ordinary state at the end of the last step.
    """

    def __init__(self, problem: Problem, outcome: Outcome) -> None:
        self.form, self.samples, self.events = problem.form, problem.samples, problem.events
        self.t, self.y = problem.span[0], problem.start
        self._outcome, self._sampled = outcome, 0
        if self.samples is None or (len(self.samples) and self.samples[0] == self.t):
            self._sample(self.t, self.y)
            self._sampled = 1
        self._values = [event(self.t, self.y.copy()) for event in self.events]

    def _sample(self, t: float, y: Array) -> None:
        self._outcome.t.append(np.array([t]))
        self._outcome.y.append(y.copy()[np.newaxis])

    def advance(self, end: float, state: Callable[[float], Array]) -> bool:
        """Record the step that ends at `end`; return whether an event ends the run."""
        # `state` gives the state at a time within the step, in the form of the problem; where it
        # raises ArithmeticError, nothing is recorded
        t = self.t

        def ordinary(time: float) -> Array:
            if time == t:
                return self.y.copy()
            return self.form.to_ordinary(time, state(time), self.y, time - t)

        values = [event(end, ordinary(end)) for event in self.events]
        roots = self._roots(t, end, values, ordinary)
        stops = bool(roots) and getattr(self.events[roots[-1][0]], "terminal", False)
        until = roots[-1][1] if stops else end
        times = [until] if self.samples is None else self._due(t, until)
        samples = [(time, ordinary(time)) for time in times]
        occurrences = [(k, root, ordinary(root)) for k, root in roots]
        y = ordinary(until)
        for sample in samples:
            self._sample(*sample)
        for k, root, y_event in occurrences:
            self._outcome.t_events[k].append(root)
            self._outcome.y_events[k].append(y_event)
        self._values, self._sampled = values, self._sampled + len(times)
        self.t, self.y = self._outcome.end = until, y
        return stops

    def _due(self, t: float, until: float) -> list[float]:
        """The sample times up to `until` that are not yet recorded."""
        assert self.samples is not None
        waiting = self.samples[self._sampled :]
        reached = takewhile(lambda time: abs(time - t) <= abs(until - t), waiting)
        return [float(time) for time in reached]

    def _roots(
        self, t: float, end: float, values: list[float], ordinary: Callable[[float], Array]
    ) -> list[tuple[int, float]]:
        """The events of a step and their times, in order, up to the first that is terminal."""
        crossings = []
        for k, (event, before, after) in enumerate(
            zip(self.events, self._values, values, strict=True)
        ):
            crossed = before != 0 and np.sign(before) != np.sign(after)
            if crossed and np.sign(after - before) * getattr(event, "direction", 0) >= 0:
                root = _root(event, ordinary, t, end)
                crossings.append((abs(root - t), k, root))
        roots = []
        for _, k, root in sorted(crossings):
            roots.append((k, root))
            if getattr(self.events[k], "terminal", False):
                break
        return roots


def _root(event: EventFunction, state: Callable[[float], Array], t: float, end: float) -> float:
    """The time of the sign change of `event`, or just after it, so that a restart is past it."""

    def value(time: float) -> float:
        return event(time, state(time))

    resolution = 4 * float(np.spacing(max(abs(t), abs(end))))
    root = float(brentq(value, t, end, xtol=resolution, maxiter=1000))
    # rounding may leave the sign as it was for a little longer
    shift, before = 0.0, np.sign(value(t))
    while abs(root + shift - t) < abs(end - t):
        if np.sign(value(root + shift)) != before:
            return root + shift
        shift = 2 * shift or resolution * float(np.sign(end - t))
    return end
