"""Take in the steps of an integration: samples, events, and where it is now."""

from __future__ import annotations

from collections.abc import Callable
from itertools import takewhile

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from solvers.integration.problem import EventFunction, Outcome, Problem

Array = NDArray[np.float64]


class Record:
    """Takes in steps; keeps the samples and events in them in an `Outcome`.

    Parameters
    ----------
    problem : Problem
        What is wanted.
    outcome : Outcome
        Where it is kept.

    Attributes
    ----------
    now, place : float and ndarray
        Time and ordinary state (q, q̇) where the last step ended.
    """

    def __init__(self, problem: Problem, outcome: Outcome) -> None:
        self.form, self.samples, self.events = problem.form, problem.samples, problem.events
        self.now, self.place = problem.span[0], problem.start
        self._outcome, self._taken = outcome, 0
        if self.samples is None or (len(self.samples) and self.samples[0] == self.now):
            self._keep(self.now, self.place)
            self._taken = 1
        self._values = [event(self.now, self.place.copy()) for event in self.events]

    def _keep(self, t: float, y: Array) -> None:
        self._outcome.t.append(np.array([t]))
        self._outcome.y.append(y.copy()[np.newaxis])

    def advance(self, end: float, inside: Callable[[float], Array]) -> bool:
        """Take in a step; tell whether an event ends the run.

        Parameters
        ----------
        end : float
            When the step ends.
        inside : callable
            The state within the step at a time, up to its end, in the form that runs.

        Returns
        -------
        bool
            Whether one does: then `now` and `place` are where it occurs.

        Raises
        ------
        ArithmeticError
            When a state within the step cannot be computed; then nothing is taken in.
        """
        t = self.now

        def between(time: float) -> Array:
            if time == t:
                return self.place.copy()
            return self.form.to_ordinary(time, inside(time), self.place, time - t)

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
            self._outcome.t_events[k].append(root)
            self._outcome.y_events[k].append(y)
        self._values, self._taken = values, self._taken + len(times)
        self.now, self.place = self._outcome.end = until, place
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


def _root(event: EventFunction, state: Callable[[float], Array], t: float, end: float) -> float:
    """Where `event` changes its sign, or the next time after it: a new start is past the event."""

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
